// Numbers in ascending order, and the middle of them.
#pragma once

#include <stdlib.h>

static inline int sorted_compare(const void *a, const void *b)
{
    const double x = *(const double *)a;
    const double y = *(const double *)b;
    return (x > y) - (x < y);
}

// Puts the values, none of them NaN, in ascending order.
static inline void sorted_make(double *values, size_t count)
{
    qsort(values, count, sizeof *values, sorted_compare);
}

// The median of one or more values in ascending order: the middle one, or the mean of the two.
static inline double sorted_median(const double *values, size_t count)
{
    return 0.5 * (values[(count - 1) / 2] + values[count / 2]);
}
