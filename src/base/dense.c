// Solves the few linear equations of a linkage, and says how many of them are independent.
#include "base/dense.h"

#include <math.h>

static const double SINGULAR = 1e-14; // a hundred roundings below the largest entry of the column

static void swap_rows(double *a, size_t columns, size_t first, size_t second)
{
    for (size_t j = 0; j < columns && first != second; j++) {
        const double kept = a[first * columns + j];
        a[first * columns + j] = a[second * columns + j];
        a[second * columns + j] = kept;
    }
}

// Cancellation in a column leaves a large entry in the rows above, for no factor exceeds 1: what is
// left is judged by its own column, so that the units of the unknowns may differ. Returns whether
// enough is left in the column for a pivot, its largest entry.
static bool find_pivot(size_t n, const double *a, size_t column, size_t *pivot)
{
    double largest = 0.0;
    for (size_t i = 0; i < column; i++) {
        const double size = fabs(a[i * n + column]);
        largest = size > largest ? size : largest;
    }
    double left = fabs(a[column * n + column]);
    *pivot = column;
    for (size_t i = column + 1; i < n; i++) {
        const double size = fabs(a[i * n + column]);
        *pivot = size > left ? i : *pivot;
        left = size > left ? size : left;
    }
    return left > SINGULAR * (left > largest ? left : largest);
}

static inline void subtract_row(size_t count, double factor, const double *restrict from,
                                double *restrict row)
{
    for (size_t j = 0; j < count; j++) {
        row[j] -= factor * from[j];
    }
}

// Makes A triangular, with the factors of its rows in the places of the zeros, and does to b, where
// it is not NULL, what is done to the rows. Row k is exchanged with row pivots[k], where that is
// not NULL.
static bool eliminate(size_t n, double *a, size_t *pivots, double *b)
{
    for (size_t k = 0; k < n; k++) {
        size_t pivot;
        if (!find_pivot(n, a, k, &pivot)) {
            return false;
        }
        swap_rows(a, n, k, pivot);
        if (pivots != NULL) {
            pivots[k] = pivot;
        }
        if (b != NULL) {
            swap_rows(b, 1, k, pivot);
        }
        for (size_t i = k + 1; i < n; i++) {
            // bodies that have nothing to do with one another leave zeros
            if (a[i * n + k] == 0.0) {
                continue;
            }
            const double factor = a[i * n + k] / a[k * n + k];
            a[i * n + k] = factor;
            subtract_row(n - k - 1, factor, &a[k * n + k + 1], &a[i * n + k + 1]);
            if (b != NULL) {
                b[i] -= factor * b[k];
            }
        }
    }
    return true;
}

// Overwrites b by the solution of the triangle.
static void solve_triangle(size_t n, const double *a, double *b)
{
    for (size_t k = n; k-- > 0;) {
        double left = b[k];
        for (size_t j = k + 1; j < n; j++) {
            if (a[k * n + j] != 0.0) {
                left -= a[k * n + j] * b[j];
            }
        }
        b[k] = left / a[k * n + k];
    }
}

bool dense_solve(size_t n, double *a, double *b)
{
    const bool is_regular = eliminate(n, a, NULL, b);
    if (is_regular) {
        solve_triangle(n, a, b);
    }
    return is_regular;
}

bool dense_split(size_t n, double *a, size_t *pivots)
{
    return eliminate(n, a, pivots, NULL);
}

void dense_solve_split(size_t n, const double *split, const size_t *pivots, double *b)
{
    for (size_t k = 0; k < n; k++) {
        swap_rows(b, 1, k, pivots[k]);
    }
    for (size_t k = 0; k < n; k++) {
        for (size_t i = k + 1; i < n; i++) {
            if (split[i * n + k] != 0.0) {
                b[i] -= split[i * n + k] * b[k];
            }
        }
    }
    solve_triangle(n, split, b);
}

bool dense_factor(size_t n, double *a, size_t *pivots)
{
    for (size_t k = 0; k < n; k++) {
        size_t pivot = k;
        for (size_t i = k + 1; i < n; i++) {
            pivot = fabs(a[i * n + k]) > fabs(a[pivot * n + k]) ? i : pivot;
        }
        pivots[k] = pivot;
        if (!(fabs(a[pivot * n + k]) > 0.0)) {
            return false;
        }
        // the factors of rows that are exchanged go with them
        swap_rows(a, n, k, pivot);
        for (size_t i = k + 1; i < n; i++) {
            const double factor = a[i * n + k] / a[k * n + k];
            a[i * n + k] = factor;
            for (size_t j = k + 1; j < n && factor != 0.0; j++) {
                a[i * n + j] -= factor * a[k * n + j];
            }
        }
    }
    return true;
}

void dense_substitute(size_t n, const double *factored, const size_t *pivots, double *b)
{
    for (size_t k = 0; k < n; k++) {
        swap_rows(b, 1, k, pivots[k]);
    }
    // a right side of few bodies is zero before and behind them, and so is what comes of it
    size_t first = 0;
    while (first < n && b[first] == 0.0) {
        first++;
    }
    for (size_t j = first; j < n; j++) {
        for (size_t k = j + 1; k < n && b[j] != 0.0; k++) {
            b[k] -= factored[k * n + j] * b[j];
        }
    }
    size_t end = n;
    while (end > first && b[end - 1] == 0.0) {
        end--;
    }
    for (size_t k = end; k-- > 0;) {
        for (size_t j = k + 1; j < end; j++) {
            b[k] -= factored[k * n + j] * b[j];
        }
        b[k] /= factored[k * n + k];
    }
}

// Brings the largest entry of the rows and columns from `step` on to place (step, step).
static double pivot_completely(size_t rows, size_t columns, double *a, size_t step)
{
    size_t row = step;
    size_t column = step;
    for (size_t i = step; i < rows; i++) {
        for (size_t j = step; j < columns; j++) {
            if (fabs(a[i * columns + j]) > fabs(a[row * columns + column])) {
                row = i;
                column = j;
            }
        }
    }
    swap_rows(a, columns, step, row);
    for (size_t i = 0; i < rows; i++) {
        const double kept = a[i * columns + step];
        a[i * columns + step] = a[i * columns + column];
        a[i * columns + column] = kept;
    }
    return fabs(a[step * columns + step]);
}

size_t dense_rank(size_t rows, size_t columns, double *a, double tolerance)
{
    const size_t most = rows < columns ? rows : columns;
    double first = 0.0;
    for (size_t k = 0; k < most; k++) {
        const double pivot = pivot_completely(rows, columns, a, k);
        first = k == 0 ? pivot : first;
        if (!(pivot > tolerance * first)) {
            return k;
        }
        for (size_t i = k + 1; i < rows; i++) {
            const double factor = a[i * columns + k] / a[k * columns + k];
            for (size_t j = k; j < columns; j++) {
                a[i * columns + j] -= factor * a[k * columns + j];
            }
        }
    }
    return most;
}
