// Numbers in ascending order, their quantiles, and lists that are kept in an order.
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

// Where the quantile of a share, from 0 to 1, stands among one or more values in ascending order:
// so far beyond one of them on the way to the next. Definition 7 of Hyndman and Fan (Am. Stat. 50,
// 1996), that of R, NumPy and spreadsheets: at share (count - 1), counted from 0.
typedef struct SortedPlace {
    size_t below;  // number of that value, from 0
    double beyond; // from 0, below 1
} SortedPlace;

static inline SortedPlace sorted_place(size_t count, double share)
{
    const double at = share * (double)(count - 1);
    const size_t below = (size_t)at;
    return (SortedPlace){below, at - (double)below};
}

// The value that far between two, which may be infinite.
static inline double sorted_between(double below, double above, double beyond)
{
    return beyond > 0.0 && above != below ? below + beyond * (above - below) : below;
}

static inline double sorted_quantile(const double *values, size_t count, double share)
{
    const SortedPlace place = sorted_place(count, share);
    const size_t above = place.below + 1 < count ? place.below + 1 : place.below;
    return sorted_between(values[place.below], values[above], place.beyond);
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
