// Which of many points are worth their time?
#pragma once

#include <stdbool.h>
#include <stddef.h>

// Marks the points that are more accurate than every faster one, by more than a hundredth of its
// error: a smaller difference distinguishes no schemes. A point whose time, s, or error is not
// finite is no point.
void frontier_mark(size_t count, const double *times, const double *errors, bool *is_on_frontier);

// The fastest point whose error, the uncertainty of that error included, meets the target; of two
// as fast the more accurate. Returns `count` where none does.
size_t frontier_cheapest(size_t count, const double *times, const double *errors,
                         double uncertainty, double target);
