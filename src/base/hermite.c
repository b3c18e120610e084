// Finds the polynomial of given values and slopes.
//
// Newton's form with every node taken twice, z = (x0, x0, x1, x1, ...):
//     p(x) = c0 + (x - z0) (c1 + (x - z1) (c2 + ...)),   c_k = f[z0 .. zk]
//     f[zi .. zk] = (f[zi+1 .. zk] - f[zi .. zk-1]) / (zk - zi),  and f'(zi) where zk = zi
// x is measured in mean distances of two nodes from the first one: then neither the differences nor
// the products grow or vanish with the unit of x.
// Source: J. Stoer, R. Bulirsch, Introduction to Numerical Analysis, 3rd ed., 2.1.5.
#include "base/hermite.h"

#include <assert.h>

Hermite hermite_fit(size_t node_count, const double *nodes, const double *values,
                    const double *slopes)
{
    assert(node_count >= 2 && node_count <= HERMITE_NODE_MAX);
    Hermite hermite = {
        .term_count = 2 * node_count,
        .origin = nodes[0],
        .width = (nodes[node_count - 1] - nodes[0]) / (double)(node_count - 1),
    };
    double *z = hermite.nodes;
    double *c = hermite.coefficients;
    for (size_t i = 0; i < hermite.term_count; i++) {
        z[i] = (nodes[i / 2] - hermite.origin) / hermite.width;
        c[i] = values[i / 2];
    }
    // the first differences: a slope where a node follows itself
    for (size_t i = hermite.term_count; i-- > 1;) {
        c[i] = i % 2 == 1 ? slopes[i / 2] * hermite.width : (c[i] - c[i - 1]) / (z[i] - z[i - 1]);
    }
    for (size_t order = 2; order < hermite.term_count; order++) {
        for (size_t i = hermite.term_count; i-- > order;) {
            c[i] = (c[i] - c[i - 1]) / (z[i] - z[i - order]);
        }
    }
    return hermite;
}

HermitePoint hermite_at(const Hermite *hermite, double at)
{
    const double x = (at - hermite->origin) / hermite->width;
    double value = 0.0;
    double slope = 0.0;
    double curvature = 0.0;
    // Horner's rule from the innermost bracket outwards, with its own two derivatives
    for (size_t i = hermite->term_count; i-- > 0;) {
        const double away = x - hermite->nodes[i];
        curvature = curvature * away + 2.0 * slope;
        slope = slope * away + value;
        value = value * away + hermite->coefficients[i];
    }
    return (HermitePoint){
        .value = value,
        .slope = slope / hermite->width,
        .curvature = curvature / (hermite->width * hermite->width),
    };
}
