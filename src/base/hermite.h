// The polynomial through given values and slopes at a few nodes: of 2 n - 1st degree for n nodes.
#pragma once

#include <stddef.h>

enum { HERMITE_NODE_MAX = 6, HERMITE_TERM_MAX = 2 * HERMITE_NODE_MAX };

typedef struct Hermite {
    size_t term_count;
    double origin;                         // the first node
    double width;                          // mean distance of two nodes, the unit of what follows
    double nodes[HERMITE_TERM_MAX];        // of the nodes, each twice, from the origin
    double coefficients[HERMITE_TERM_MAX]; // of Newton's form
} Hermite;

// A polynomial at one point.
typedef struct HermitePoint {
    double value;
    double slope;     // first derivative
    double curvature; // second derivative
} HermitePoint;

// Fits the polynomial to two up to HERMITE_NODE_MAX nodes, which must ascend, and the value and the
// slope at each.
Hermite hermite_fit(size_t node_count, const double *nodes, const double *values,
                    const double *slopes);

HermitePoint hermite_at(const Hermite *hermite, double at);
