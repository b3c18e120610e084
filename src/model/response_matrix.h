// The matrix D = J M^-1 J' of a linkage's rows (model/response.h): which of its blocks are not
// zero, in the plane and in space. Its nodes are ideal joints, then places at which joints with
// play touch; two have a block where their joints share a body that can give way.
#pragma once

#include "base/sparse.h"
#include "model/linkage.h"

// A block of D: the rows of two joints or places that share a body, the second eliminated first.
typedef struct ResponseBlock {
    size_t rows;    // its first row, and how many
    size_t columns; // likewise
    size_t row_count;
    size_t column_count;
    double *values; // in the sparse matrix, row by row
} ResponseBlock;

// Prepares D for nodes of some joints with some rows each, of which the first `ideal` are
// eliminated. Returns its blocks, which free() gives back.
ResponseBlock *response_matrix_init(const Linkage *linkage, const int *joints, const size_t *sizes,
                                    size_t count, size_t ideal, Sparse *matrix,
                                    size_t *block_count);

// How pushes at one place move another, row by row; NULL where they do not. After elimination.
const double *response_matrix_block(const Sparse *matrix, size_t place, size_t other);

// The same of all places as one matrix, dense, of as many rows as they have together.
void response_matrix_mobility(const Sparse *matrix, double *mobility);

// Lists which places move each other, those whose mobility is not zero: of place i those from
// (*first)[i] to (*first)[i + 1] of *partners, itself among them, in order. The caller frees both.
void response_matrix_partners(const Sparse *matrix, size_t **first, size_t **partners);

// The most rows of ideal joints that hold one another.
size_t response_matrix_largest(const Sparse *matrix);
