// Solves linear equations whose unknowns only meet their neighbours.
//
// By Gaussian elimination with row pivoting. A row that is exchanged has entries up to twice as far
// behind the diagonal, for which there is room; factors stay where they were worked out, and the
// right side is exchanged as they come. The work is in proportion to rows times reach^2.
#include "base/banded.h"

#include "base/memory.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static bool is_dense(size_t count, size_t reach)
{
    return 2 * reach + 1 >= count;
}

size_t banded_size(size_t count, size_t reach)
{
    return count * (is_dense(count, reach) ? count : 3 * reach + 1);
}

static void set_shape(Banded *banded, size_t count, size_t reach)
{
    const bool is_whole = is_dense(count, reach);
    banded->count = count;
    banded->reach = is_whole ? count : reach;
    banded->pitch = is_whole ? count : 3 * reach;
    banded->origin = is_whole ? 0 : reach;
}

void banded_shape_in(Banded *banded, size_t count, size_t reach, double *values, size_t *pivots)
{
    *banded = (Banded){.values = values, .pivots = pivots};
    set_shape(banded, count, reach);
    memset(values, 0, banded_size(count, reach) * sizeof *values);
}

void banded_shape(Banded *banded, size_t count, size_t reach)
{
    const size_t size = banded_size(count, reach);
    set_shape(banded, count, reach);
    if (size > banded->room || banded->values == NULL) {
        free(banded->values);
        banded->values = NULL;
        banded->values = memory_plain(size + 1, sizeof *banded->values);
        banded->room = size;
    }
    if (count > banded->pivot_room || banded->pivots == NULL) {
        free(banded->pivots);
        banded->pivots = NULL;
        banded->pivots = memory_plain(count + 1, sizeof *banded->pivots);
        banded->pivot_room = count;
    }
    memset(banded->values, 0, size * sizeof *banded->values);
}

void banded_finish(Banded *banded)
{
    free(banded->values);
    free(banded->pivots);
    *banded = (Banded){.count = 0};
}

// The end of a row's entries once rows below have been exchanged with it.
static size_t filled_end(const Banded *banded, size_t row)
{
    const size_t end = row + 2 * banded->reach + 1;
    return end < banded->count ? end : banded->count;
}

static void swap_entries(double *a, double *b)
{
    const double kept = *a;
    *a = *b;
    *b = kept;
}

bool banded_factor(Banded *banded)
{
    for (size_t k = 0; k < banded->count; k++) {
        const size_t below = banded_end(banded, k);
        const size_t end = filled_end(banded, k);
        size_t pivot = k;
        for (size_t i = k + 1; i < below; i++) {
            pivot = fabs(*banded_entry(banded, i, k)) > fabs(*banded_entry(banded, pivot, k))
                        ? i
                        : pivot;
        }
        banded->pivots[k] = pivot;
        if (!(fabs(*banded_entry(banded, pivot, k)) > 0.0)) {
            return false;
        }
        for (size_t j = k; j < end && pivot != k; j++) {
            swap_entries(banded_entry(banded, k, j), banded_entry(banded, pivot, j));
        }
        const double *row = banded_entry(banded, k, 0);
        for (size_t i = k + 1; i < below; i++) {
            double *changed = banded_entry(banded, i, 0);
            const double factor = changed[k] / row[k];
            changed[k] = factor;
            for (size_t j = k + 1; j < end && factor != 0.0; j++) {
                changed[j] -= factor * row[j];
            }
        }
    }
    return true;
}

void banded_substitute(const Banded *banded, double *b)
{
    for (size_t k = 0; k < banded->count; k++) {
        swap_entries(&b[k], &b[banded->pivots[k]]);
        const size_t below = banded_end(banded, k);
        for (size_t i = k + 1; i < below && b[k] != 0.0; i++) {
            b[i] -= *banded_entry(banded, i, k) * b[k];
        }
    }
    for (size_t k = banded->count; k-- > 0;) {
        const double *row = banded_entry(banded, k, 0);
        const size_t end = filled_end(banded, k);
        for (size_t j = k + 1; j < end; j++) {
            b[k] -= row[j] * b[j];
        }
        b[k] /= row[k];
    }
}
