// A weight that sinks into a wall of next to no restitution, whose closed form inertia has no part
// in.
#pragma once

#include <math.h>

// How long a weight takes from the wall to a depth d against K d^1.5 (1 + d' / u):
// u t = d_s (x^2.5 / 2.5 + x^4 / 4 + x^5.5 / 5.5 + ...), x = d / d_s, d_s the static depth.
static inline double sinking_time(double depth, double at_rest, double rate)
{
    double sum = 0.0;
    for (int i = 1; i < 40; i++) {
        const double order = 1.5 * i + 1.0;
        sum += pow(depth / at_rest, order) / order;
    }
    return at_rest * sum / rate;
}
