// Puts a curve through a few values of a function.
//
// The nodes are the extremes of Chebyshev's polynomial, at which interpolation of a function that
// is smooth loses a constant factor with each one more; the barycentric formula keeps rounding.
// Source: J.-P. Berrut, L. N. Trefethen, Barycentric Lagrange interpolation, SIAM Review 46, 2004,
// equations (4.2) and (5.4).
#include "base/curve.h"

#include "base/root.h"

#include <math.h>
#include <stdbool.h>

// of the interval: a maximum nearer to an end is too low by the square of it
static const double NEXT_TO_END = 1e-3;

enum { LAST = CURVE_NODES - 1 };

// sin^2(pi k / 22)
static const double NODES[CURVE_NODES] = {0,
                                          0.020253513192751305,
                                          0.079373233584409397,
                                          0.17256963302735742,
                                          0.29229249349905678,
                                          0.42884258086335747,
                                          0.57115741913664253,
                                          0.70770750650094305,
                                          0.82743036697264249,
                                          0.92062676641559049,
                                          0.97974648680724863,
                                          1};

double curve_node(size_t node)
{
    return NODES[node];
}

double curve_at(const double values[CURVE_NODES], double share)
{
    double above = 0.0;
    double below = 0.0;
    for (size_t k = 0; k < CURVE_NODES; k++) {
        const double ahead = share - NODES[k];
        if (ahead == 0.0) {
            return values[k];
        }
        const bool is_end = k == 0 || k == LAST;
        const double weight = (k % 2 == 0 ? 1.0 : -1.0) * (is_end ? 0.5 : 1.0) / ahead;
        above += weight * values[k];
        below += weight;
    }
    return above / below;
}

static double lowered(double share, void *context)
{
    return -curve_at(context, share);
}

// A place between the neighbours of the largest node, where the polynomial is higher than at both,
// if it is anywhere.
static double inside(const double *values, size_t top)
{
    if (top == 0) {
        return NEXT_TO_END;
    }
    if (top == LAST) {
        return 1.0 - NEXT_TO_END;
    }
    // of two that are alike the first is taken for the largest
    return values[top + 1] == values[top] ? 0.5 * (NODES[top] + NODES[top + 1]) : NODES[top];
}

double curve_top(const double values[CURVE_NODES], double *share)
{
    size_t top = 0;
    for (size_t k = 1; k < CURVE_NODES; k++) {
        top = values[k] > values[top] ? k : top;
    }
    *share = NODES[top];
    double found = 0.0;
    if (root_minimum(lowered, (void *)values, NODES[top > 0 ? top - 1 : 0], inside(values, top),
                     NODES[top < LAST ? top + 1 : LAST], &found)) {
        *share = found;
    }
    return curve_at(values, *share);
}
