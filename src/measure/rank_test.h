// Are two samples from one distribution, or has one of them moved?
#pragma once

#include <stddef.h>

enum { RANK_TEST_MAX = 64 }; // values of one sample

// The exact two-sided p-value of Wilcoxon's rank-sum test (Mann and Whitney's), ties included: the
// share of all ways to deal the values into two samples of these sizes whose rank sum is as far
// from its mean as that seen, or farther. Sizes from 1 to RANK_TEST_MAX; the values are finite.
double rank_test_p(const double *first, size_t first_count, const double *second,
                   size_t second_count);

// The smallest shift of a sample that the test tells from the sample itself, at a false-alarm rate;
// INFINITY where it tells none. The values are in ascending order.
double rank_test_shift(const double *sorted, size_t count, double rate);
