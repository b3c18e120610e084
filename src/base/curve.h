// A smooth function over an interval, as the polynomial through its values at Chebyshev's nodes.
#pragma once

#include <stddef.h>

enum { CURVE_NODES = 12 };

// Where a node is in the interval: 0 for the first, 1 for the last, ascending.
double curve_node(size_t node);

// The polynomial through so many values, at a share of the interval from 0 to 1.
double curve_at(const double values[CURVE_NODES], double share);

// The largest value of the polynomial, and where it is.
double curve_top(const double values[CURVE_NODES], double *share);
