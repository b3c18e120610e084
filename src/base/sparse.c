// Factors a symmetric positive definite matrix whose blocks are mostly zero.
//
// Cholesky's elimination, column by column, on the blocks that are not zero. Which blocks those are
// and which of them a column changes is found once (base/sparse_order.c); each factorisation then
// runs down that list. With p a column, i >= j > p nodes of blocks in it:
//     L_pp L_pp' = A_pp,   L_ip = A_ip L_pp'^-1,   A_ij := A_ij - L_ip L_jp'
#include "base/sparse.h"

#include "base/zeroed.h"

#include <assert.h>
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

void sparse_finish(Sparse *sparse)
{
    free(sparse->first_row);
    free(sparse->order);
    free(sparse->node_at);
    free(sparse->first_block);
    free(sparse->block_node);
    free(sparse->block_value);
    free(sparse->block_row);
    free(sparse->first_kept);
    free(sparse->first_target);
    free(sparse->targets);
    free(sparse->values);
    free(sparse->diagonals);
    *sparse = (Sparse){.count = 0};
}

static int compare_orders(const void *a, const void *b)
{
    const size_t first = *(const size_t *)a;
    const size_t second = *(const size_t *)b;
    return first < second ? -1 : first > second;
}

// Lists the blocks column by column, and where their numbers are.
static void list_blocks(Sparse *sparse, const SparseList *later)
{
    size_t blocks = sparse->count;
    for (size_t i = 0; i < sparse->count; i++) {
        blocks += later[i].count;
    }
    sparse->block_node = zeroed(blocks, sizeof *sparse->block_node);
    sparse->block_value = zeroed(blocks + 1, sizeof *sparse->block_value);
    size_t next = 0;
    size_t value = 0;
    for (size_t p = 0; p < sparse->count; p++) {
        const SparseList *column = &later[sparse->node_at[p]];
        sparse->first_block[p] = next;
        sparse->block_node[next++] = p;
        for (size_t i = 0; i < column->count; i++) {
            sparse->block_node[next++] = sparse->order[column->nodes[i]];
        }
        size_t *below = sparse->block_node + sparse->first_block[p] + 1;
        qsort(below, column->count, sizeof *below, compare_orders);
        for (size_t b = sparse->first_block[p]; b < next; b++) {
            sparse->block_value[b] = value;
            value += sparse_rows_at(sparse, sparse->block_node[b]) * sparse_rows_at(sparse, p);
        }
    }
    sparse->first_block[sparse->count] = next;
    sparse->block_value[next] = value;
    sparse->values = zeroed(value, sizeof *sparse->values);
}

// Notes where the rows of blocks begin, and the first block of each column that stays.
static void note_rows(Sparse *sparse)
{
    const size_t blocks = sparse->first_block[sparse->count];
    sparse->block_row = zeroed(blocks, sizeof *sparse->block_row);
    for (size_t b = 0; b < blocks; b++) {
        sparse->block_row[b] = sparse->first_row[sparse->node_at[sparse->block_node[b]]];
    }
    for (size_t p = 0; p < sparse->eliminated; p++) {
        size_t kept = sparse->first_block[p + 1];
        while (kept > sparse->first_block[p] + 1 &&
               sparse->block_node[kept - 1] >= sparse->eliminated) {
            kept--;
        }
        sparse->first_kept[p] = kept;
    }
}

// The block of a column in the row of a later node, by their orders.
static size_t find_block(const Sparse *sparse, size_t row, size_t column)
{
    size_t low = sparse->first_block[column];
    size_t high = sparse->first_block[column + 1];
    while (high - low > 1) {
        const size_t middle = (low + high) / 2;
        if (sparse->block_node[middle] <= row) {
            low = middle;
        } else {
            high = middle;
        }
    }
    return sparse->block_node[low] == row ? low : SIZE_MAX;
}

// Lists the blocks that each eliminated column changes.
static void list_targets(Sparse *sparse)
{
    size_t targets = 0;
    for (size_t p = 0; p < sparse->eliminated; p++) {
        const size_t below = sparse->first_block[p + 1] - sparse->first_block[p] - 1;
        sparse->first_target[p] = targets;
        targets += below * (below + 1) / 2;
    }
    sparse->first_target[sparse->eliminated] = targets;
    sparse->targets = zeroed(targets, sizeof *sparse->targets);
    for (size_t p = 0; p < sparse->eliminated; p++) {
        size_t *target = sparse->targets + sparse->first_target[p];
        for (size_t j = sparse->first_block[p] + 1; j < sparse->first_block[p + 1]; j++) {
            for (size_t i = j; i < sparse->first_block[p + 1]; i++) {
                *target = find_block(sparse, sparse->block_node[i], sparse->block_node[j]);
                assert(*target != SIZE_MAX);
                target++;
            }
        }
    }
}

void sparse_init(size_t count, const size_t *sizes, size_t eliminated, size_t link_count,
                 const SparseLink *links, Sparse *sparse)
{
    assert(eliminated <= count);
    *sparse = (Sparse){.count = count, .eliminated = eliminated};
    sparse->first_row = zeroed(count + 1, sizeof *sparse->first_row);
    sparse->order = zeroed(count, sizeof *sparse->order);
    sparse->node_at = zeroed(count, sizeof *sparse->node_at);
    sparse->first_block = zeroed(count + 1, sizeof *sparse->first_block);
    sparse->first_kept = zeroed(eliminated, sizeof *sparse->first_kept);
    sparse->first_target = zeroed(eliminated + 1, sizeof *sparse->first_target);
    for (size_t i = 0; i < count; i++) {
        sparse->first_row[i + 1] = sparse->first_row[i] + sizes[i];
    }
    sparse->row_count = sparse->first_row[count];
    sparse->diagonals = zeroed(sparse->row_count, sizeof *sparse->diagonals);
    SparseList *later = zeroed(count, sizeof *later);
    sparse_order_find(count, eliminated, link_count, links, sparse->node_at, later);
    for (size_t p = 0; p < count; p++) {
        sparse->order[sparse->node_at[p]] = p;
    }
    list_blocks(sparse, later);
    note_rows(sparse);
    list_targets(sparse);
    for (size_t i = 0; i < count; i++) {
        free(later[i].nodes);
    }
    free(later);
}

double *sparse_block(const Sparse *sparse, size_t row_node, size_t column_node, bool *is_transposed)
{
    const size_t row = sparse->order[row_node];
    const size_t column = sparse->order[column_node];
    *is_transposed = row < column;
    const size_t block =
        row < column ? find_block(sparse, column, row) : find_block(sparse, row, column);
    return block == SIZE_MAX ? NULL : sparse->values + sparse->block_value[block];
}

size_t sparse_size(const Sparse *sparse)
{
    return sparse->block_value[sparse->first_block[sparse->count]];
}

void sparse_clear(Sparse *sparse)
{
    memset(sparse->values, 0, sparse_size(sparse) * sizeof *sparse->values);
}

// Cholesky's factor of a node's own block, in its lower triangle. By row: the matrix' diagonal,
// then the inverse of the factor's.
static bool factor_own(double *own, size_t n, double *diagonal, double share)
{
    for (size_t k = 0; k < n; k++) {
        const double square = own[k * n + k];
        if (!(square > share * diagonal[k])) {
            return false;
        }
        diagonal[k] = 1.0 / sqrt(square);
        for (size_t i = k; i < n; i++) {
            own[i * n + k] *= diagonal[k];
        }
        for (size_t i = k + 1; i < n; i++) {
            for (size_t j = k + 1; j <= i; j++) {
                own[i * n + j] -= own[i * n + k] * own[j * n + k];
            }
        }
    }
    return true;
}

// Divides a block below by the transposed factor of the node's own.
static inline void divide_block(double *block, size_t rows, const double *own,
                                const double *inverses, size_t n)
{
    for (size_t i = 0; i < rows; i++) {
        double *row = block + i * n;
        for (size_t k = 0; k < n; k++) {
            double left = row[k];
            for (size_t j = 0; j < k; j++) {
                left -= own[k * n + j] * row[j];
            }
            row[k] = left * inverses[k];
        }
    }
}

// target -= a b', of `rows` and `columns` rows with `n` columns each.
static inline void subtract_product(double *target, const double *a, size_t rows, const double *b,
                                    size_t columns, size_t n)
{
    for (size_t i = 0; i < rows; i++) {
        for (size_t k = 0; k < columns; k++) {
            double left = target[i * columns + k];
            for (size_t j = 0; j < n; j++) {
                left -= a[i * n + j] * b[k * n + j];
            }
            target[i * columns + k] = left;
        }
    }
}

// Takes a column out of those behind it, up to before one of its blocks.
static void take_column_out(Sparse *sparse, size_t p, size_t behind)
{
    const size_t n = sparse_rows_at(sparse, p);
    const size_t *target = sparse->targets + sparse->first_target[p];
    const size_t end = sparse->first_block[p + 1];
    for (size_t j = sparse->first_block[p] + 1; j < behind; j++) {
        const double *b = sparse->values + sparse->block_value[j];
        const size_t columns = (sparse->block_value[j + 1] - sparse->block_value[j]) / n;
        for (size_t i = j; i < end; i++) {
            const double *a = sparse->values + sparse->block_value[i];
            const size_t rows = (sparse->block_value[i + 1] - sparse->block_value[i]) / n;
            double *changed = sparse->values + sparse->block_value[*target++];
            // most joints have two rows
            if (n == 2 && rows == 2 && columns == 2) {
                subtract_product(changed, a, 2, b, 2, 2);
            } else {
                subtract_product(changed, a, rows, b, columns, n);
            }
        }
    }
}

static void keep_diagonal(Sparse *sparse, size_t node)
{
    const size_t first = sparse->first_row[node];
    const size_t n = sparse->first_row[node + 1] - first;
    const size_t block = sparse->first_block[sparse->order[node]];
    const double *own = sparse->values + sparse->block_value[block];
    for (size_t k = 0; k < n; k++) {
        sparse->diagonals[first + k] = own[k * n + k];
    }
}

// The factor's blocks of a column.
static bool factor_column(Sparse *sparse, size_t p, double share)
{
    const size_t n = sparse_rows_at(sparse, p);
    const size_t first = sparse->first_block[p];
    double *own = sparse->values + sparse->block_value[first];
    double *diagonal = sparse->diagonals + sparse->first_row[sparse->node_at[p]];
    if (!factor_own(own, n, diagonal, share)) {
        return false;
    }
    for (size_t b = first + 1; b < sparse->first_block[p + 1]; b++) {
        const size_t rows = (sparse->block_value[b + 1] - sparse->block_value[b]) / n;
        divide_block(sparse->values + sparse->block_value[b], rows, own, diagonal, n);
    }
    return true;
}

bool sparse_factor(Sparse *sparse, double share)
{
    for (size_t node = 0; node < sparse->count; node++) {
        keep_diagonal(sparse, node);
    }
    for (size_t p = 0; p < sparse->eliminated; p++) {
        if (!factor_column(sparse, p, share)) {
            return false;
        }
        take_column_out(sparse, p, sparse->first_block[p + 1]);
    }
    return true;
}

void sparse_clear_some(Sparse *sparse, size_t count, const size_t *nodes)
{
    for (size_t i = 0; i < count; i++) {
        const size_t p = sparse->order[nodes[i]];
        const size_t first = sparse->block_value[sparse->first_block[p]];
        const size_t behind = sparse->block_value[sparse->first_block[p + 1]];
        memset(sparse->values + first, 0, (behind - first) * sizeof *sparse->values);
    }
}

bool sparse_factor_some(Sparse *sparse, double share, size_t count, const size_t *nodes)
{
    for (size_t i = 0; i < count; i++) {
        keep_diagonal(sparse, nodes[i]);
    }
    for (size_t i = 0; i < count; i++) {
        const size_t p = sparse->order[nodes[i]];
        if (!factor_column(sparse, p, share)) {
            return false;
        }
        take_column_out(sparse, p, sparse->first_kept[p]);
    }
    return true;
}
