// Symmetric positive definite matrices in blocks of which most are zero, and their factors.
//
// The rows and columns of a matrix belong to nodes: each node has a few of both, and a block may be
// other than zero only where two nodes are linked. The first nodes are eliminated, in an order that
// leaves few further blocks other than zero (minimum degree); the others are kept, behind them and
// in their own order. What is left of the kept nodes' blocks is the Schur complement. With no node
// kept the factor is Cholesky's. For chains, trees and loops of nodes time and memory are
// proportional to the number of nodes.
//
// Rows are numbered node by node, in the caller's order.
#pragma once

#include "base/sparse_order.h"

#include <stdbool.h>
#include <stddef.h>

typedef struct Sparse {
    size_t count;      // nodes
    size_t eliminated; // of them, the first
    size_t row_count;
    size_t *first_row; // of a node; behind the last one the number of rows
    size_t *order;     // of a node: when it is eliminated
    size_t *node_at;   // the node that is eliminated then
    // by the order of elimination: the blocks of a node's column, its own first, then those of
    // nodes that come later, in order
    size_t *first_block; // and behind the last one the number of blocks
    size_t *block_node;  // of a block: its row, as an order of elimination
    size_t *block_value; // of a block: where its numbers begin, row by row
    size_t *block_row;   // of a block: the first row of its node
    size_t *first_kept;  // of an eliminated column: its first block in the row of a kept node
    size_t *first_target;
    size_t *targets;   // blocks that are changed where a column is taken out, in order
    double *values;    // the matrix, then its factor and the Schur complement
    double *diagonals; // by row: of the matrix, then the inverse of the factor's
} Sparse;

// The number of rows of the node that is eliminated then.
static inline size_t sparse_rows_at(const Sparse *sparse, size_t order)
{
    const size_t node = sparse->node_at[order];
    return sparse->first_row[node + 1] - sparse->first_row[node];
}

// Prepares a matrix: nodes with their numbers of rows, of which the first `eliminated` are taken
// out, and the links between different nodes, in any order, maybe more than once. It owns its
// memory.
void sparse_init(size_t count, const size_t *sizes, size_t eliminated, size_t link_count,
                 const SparseLink *links, Sparse *sparse);
void sparse_finish(Sparse *sparse);

// The block in the rows of a node and the columns of another, row by row, and whether it is stored
// the other way round, as the columns' rows. NULL where it is always zero. The place stays.
double *sparse_block(const Sparse *sparse, size_t row_node, size_t column_node,
                     bool *is_transposed);

// Sets all numbers to zero.
void sparse_clear(Sparse *sparse);

// Takes out the nodes that are to be. Fails where less than a share of a row of theirs is left
// once the rows before it are taken out: the matrix is then not positive definite but for rounding.
bool sparse_factor(Sparse *sparse, double share);

// The same for some eliminated nodes, in the order of their elimination: with each, all eliminated
// ones that it has a block with. Their columns are first set to zero by sparse_clear_some; what is
// left in the kept rows and columns is not for use.
void sparse_clear_some(Sparse *sparse, size_t count, const size_t *nodes);
bool sparse_factor_some(Sparse *sparse, double share, size_t count, const size_t *nodes);

// Takes the eliminated rows out of a right side: L^-1 b in their place, and what is left in the
// kept rows.
void sparse_forward(const Sparse *sparse, double *rows);

// Finds the unknowns of the eliminated rows from what sparse_forward left there and the unknowns of
// the kept rows.
void sparse_back(const Sparse *sparse, double *rows);

// The same for some eliminated nodes, in the order of their elimination: with each, all eliminated
// ones that it has a block with.
void sparse_back_some(const Sparse *sparse, size_t count, const size_t *nodes, double *rows);

// Solves A x = b for the eliminated rows in place, the unknowns of the kept rows being zero; those
// rows are left alone.
void sparse_solve(const Sparse *sparse, double *rows);

// The number of numbers that a factor holds.
size_t sparse_size(const Sparse *sparse);
