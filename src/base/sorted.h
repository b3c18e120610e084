// Numbers in ascending order, the middle of them, and lists that are kept in an order.
#pragma once

#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

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

// Puts an item of so many bytes into a list in order that has room for `most`, behind those that do
// not come after it; what no longer fits falls off the end.
static inline void sorted_insert(void *list, size_t *count, size_t most, const void *item,
                                 size_t size, bool (*is_before)(const void *a, const void *b))
{
    char *items = list;
    size_t at = *count;
    while (at > 0 && is_before(item, items + (at - 1) * size)) {
        at--;
    }
    if (at < most) {
        *count += *count < most ? 1 : 0;
        memmove(items + (at + 1) * size, items + at * size, (*count - 1 - at) * size);
        memcpy(items + at * size, item, size);
    }
}
