// Square matrices that are zero beyond a distance from their diagonal, and their factors. One that
// is as wide as long is a dense one.
#pragma once

#include <stdbool.h>
#include <stddef.h>

typedef struct Banded {
    size_t count; // rows
    size_t reach; // how far from the diagonal entries may be other than zero, at most `count`
    size_t pitch; // between what two neighbouring rows have in one column
    size_t origin;
    size_t room;
    double *values; // owned, like the pivots
    size_t pivot_room;
    size_t *pivots;
} Banded;

// Gives a matrix its shape, all entries zero; a zeroed one becomes a matrix so. What it had is
// gone, its memory serves again.
void banded_shape(Banded *banded, size_t count, size_t reach);
void banded_finish(Banded *banded);

// The number of values that a matrix of a shape holds.
size_t banded_size(size_t count, size_t reach);

// Gives a matrix its shape in memory that the caller owns, for so many values and as many pivots as
// rows, all entries zero. Not to be finished.
void banded_shape_in(Banded *banded, size_t count, size_t reach, double *values, size_t *pivots);

// An entry in reach of the diagonal.
static inline double *banded_entry(const Banded *banded, size_t row, size_t column)
{
    return banded->values + banded->origin + row * banded->pitch + column;
}

// The first column of a row in reach, and the one behind the last.
static inline size_t banded_first(const Banded *banded, size_t row)
{
    return row > banded->reach ? row - banded->reach : 0;
}

static inline size_t banded_end(const Banded *banded, size_t row)
{
    const size_t end = row + banded->reach + 1;
    return end < banded->count ? end : banded->count;
}

// Factors a matrix in place by row pivoting; false where a column has no pivot that is not zero.
bool banded_factor(Banded *banded);

// Overwrites a right side by the solution.
void banded_substitute(const Banded *banded, double *b);
