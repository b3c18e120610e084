// Quantiles of numbers that came one after the other, and shares of a few, with what is sure of
// them. Nothing is assumed of how the numbers are distributed.
#pragma once

#include <stddef.h>

// A value with its 95 % confidence interval.
typedef struct Quantile {
    double value;
    double low;  // the smallest number where too few are known to bound it
    double high; // INFINITY there
} Quantile;

// Numbers in the order of time: several series, one behind the other.
typedef struct QuantileSeries {
    const double *values; // none of them NaN; one or more
    size_t count;         // of all series together
    const size_t *lengths;
    size_t series_count;
} QuantileSeries;

// The smallest number that a share, above 0 and below 1, of all are not above. The interval is that
// of order statistics of as many independent numbers as tell as much as these do, which depend on
// one another within a series.
Quantile quantile_of(const QuantileSeries *series, double share);

// The share of which `count` of `total`, one or more, are a sample, by Clopper and Pearson
// (Biometrika 26, 1934).
Quantile quantile_share(size_t count, size_t total);
