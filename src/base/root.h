// Roots and minima of functions of one variable by Brent's methods.
#pragma once

#include <stdbool.h>

typedef double (*RootFunction)(double x, void *context);

// Finds x between low and high with f(x) = 0 to within x_tolerance, or to the last bit where that
// is 0. Returns false, x untouched, where f has the same sign at both ends or is not finite.
bool root_find(RootFunction f, void *context, double low, double high, double x_tolerance,
               double *x);

// Moves x, which lies between low and high with f(x) below both f(low) and f(high), to the minimum
// of f there; its position is right to about 1e-8 of the interval, its value to rounding. Returns
// false, x untouched, where the three do not enclose a minimum.
bool root_minimum(RootFunction f, void *context, double low, double middle, double high, double *x);
