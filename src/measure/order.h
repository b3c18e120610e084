// At which power of the step does an error fall?
#pragma once

#include <stdbool.h>
#include <stddef.h>

typedef struct Order {
    bool is_known; // false: no three steps in a row fall alike
    double order;  // 1: error ~ step^order
    size_t first;  // of the steps the fit is over, in the order given
    size_t last;   //
    size_t points; // of the fit
    double from_s; // its coarsest and its finest step
    double to_s;   //
    double spread; // 1: largest less smallest of the orders from one step to the next in there
} Order;

// Fits the order by least squares of log error on log step, over the asymptotic range: the longest
// run of consecutive steps, at least three, from each to the next of which the error falls at
// orders no further apart than ORDER_AGREEMENT and not below ORDER_LEAST. Of two as long, the
// finer one. Steps, s, come coarse to fine. An error that is not above the floor, or is not
// finite, belongs to no range and divides those on its two sides.
Order order_fit(size_t count, const double *steps, const double *errors, double floor);
