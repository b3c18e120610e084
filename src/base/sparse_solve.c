// Solves equations whose matrix has been factored (base/sparse.c).
//
// With L the factor, forward L y = b column by column, and back L' x = y from the last one on.
#include "base/sparse.h"

// Takes a block's share of the unknowns of its column, n of them, out of its own rows.
static inline void subtract_before(const double *block, size_t count, size_t n, const double *x,
                                   double *y)
{
    for (size_t i = 0; i < count; i++) {
        double left = y[i];
        for (size_t k = 0; k < n; k++) {
            left -= block[i * n + k] * x[k];
        }
        y[i] = left;
    }
}

// Takes a column, whose node has n rows, and its blocks up to one of them out of a right side.
static inline void take_out(const Sparse *sparse, size_t p, size_t n, size_t end, double *rows)
{
    const size_t first = sparse->first_block[p];
    const double *own = sparse->values + sparse->block_value[first];
    double *x = rows + sparse->block_row[first];
    for (size_t k = 0; k < n; k++) {
        double left = x[k];
        for (size_t j = 0; j < k; j++) {
            left -= own[k * n + j] * x[j];
        }
        x[k] = left / own[k * n + k];
    }
    for (size_t b = first + 1; b < end; b++) {
        const double *block = sparse->values + sparse->block_value[b];
        const size_t size = sparse->block_value[b + 1] - sparse->block_value[b];
        double *y = rows + sparse->block_row[b];
        if (size == 4 && n == 2) {
            subtract_before(block, 2, 2, x, y);
        } else {
            subtract_before(block, size / n, n, x, y);
        }
    }
}

static void go_forward(const Sparse *sparse, bool with_kept, double *rows)
{
    for (size_t p = 0; p < sparse->eliminated; p++) {
        const size_t n = sparse_rows_at(sparse, p);
        const size_t end = with_kept ? sparse->first_block[p + 1] : sparse->first_kept[p];
        // most joints have two rows
        if (n == 2) {
            take_out(sparse, p, 2, end, rows);
        } else {
            take_out(sparse, p, n, end, rows);
        }
    }
}

// Takes the share of the unknowns below, in some blocks of a column, out of one row of its node.
static inline double subtract_below(const Sparse *sparse, const double *rows, size_t first,
                                    size_t end, size_t n, size_t k, double left)
{
    for (size_t b = first; b < end; b++) {
        const double *values = sparse->values + sparse->block_value[b] + k;
        const double *y = rows + sparse->block_row[b];
        const size_t size = sparse->block_value[b + 1] - sparse->block_value[b];
        if (n == 2 && size == 4) {
            left = left - values[0] * y[0] - values[2] * y[1];
            continue;
        }
        for (size_t i = 0; i < size / n; i++) {
            left -= values[i * n] * y[i];
        }
    }
    return left;
}

// Finds the unknowns of one column, whose node has n rows, from those behind it.
static inline void find_column(const Sparse *sparse, size_t p, size_t n, bool with_kept,
                               double *rows)
{
    const size_t first = sparse->first_block[p];
    const size_t kept = sparse->first_kept[p];
    const size_t end = with_kept ? sparse->first_block[p + 1] : kept;
    const double *own = sparse->values + sparse->block_value[first];
    double *x = rows + sparse->block_row[first];
    for (size_t k = n; k-- > 0;) {
        double left = subtract_below(sparse, rows, kept, end, n, k, x[k]);
        for (size_t j = k + 1; j < n; j++) {
            left -= own[j * n + k] * x[j];
        }
        x[k] = subtract_below(sparse, rows, first + 1, kept, n, k, left) / own[k * n + k];
    }
}

static inline void go_back_to(const Sparse *sparse, size_t p, bool with_kept, double *rows)
{
    const size_t n = sparse_rows_at(sparse, p);
    if (n == 2) {
        find_column(sparse, p, 2, with_kept, rows);
    } else {
        find_column(sparse, p, n, with_kept, rows);
    }
}

static void go_back(const Sparse *sparse, bool with_kept, double *rows)
{
    for (size_t p = sparse->eliminated; p-- > 0;) {
        go_back_to(sparse, p, with_kept, rows);
    }
}

void sparse_forward(const Sparse *sparse, double *rows)
{
    go_forward(sparse, true, rows);
}

void sparse_back(const Sparse *sparse, double *rows)
{
    go_back(sparse, true, rows);
}

void sparse_back_some(const Sparse *sparse, size_t count, const size_t *nodes, double *rows)
{
    for (size_t i = count; i-- > 0;) {
        go_back_to(sparse, sparse->order[nodes[i]], true, rows);
    }
}

void sparse_solve(const Sparse *sparse, double *rows)
{
    go_forward(sparse, false, rows);
    go_back(sparse, false, rows);
}
