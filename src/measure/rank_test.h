// Tests whether two samples are from one distribution.
#pragma once

#include <stddef.h>

enum { RANK_TEST_MAX = 64, RANK_TEST_BOTH = 2 * RANK_TEST_MAX }; // values of one sample, of two

// What was worked out for the last two samples, and holds for the next with the same ties. Begins
// as all zeroes; for rank_test_finish.
typedef struct RankTest {
    size_t count;                 // of both samples
    size_t chosen;                // of the first
    size_t ranks[RANK_TEST_BOTH]; // doubled, ascending
    size_t sum;                   // of them
    double *ways;                 // by doubled sum of the first sample's; owned
} RankTest;

void rank_test_finish(RankTest *test);

// The exact two-sided p-value of Wilcoxon's rank-sum test (Mann and Whitney's), ties included: the
// share of all ways to deal the values into two samples of these sizes whose rank sum is as far
// from its mean as that seen, or farther. Sizes from 1 to RANK_TEST_MAX; the values are finite.
double rank_test_p(RankTest *test, const double *first, size_t first_count, const double *second,
                   size_t second_count);

// The smallest shift of a sample that the test tells from the sample itself, at a false-alarm rate;
// INFINITY where it tells none. The values are in ascending order.
double rank_test_shift(RankTest *test, const double *sorted, size_t count, double rate);
