// Tests whether a distribution has moved.
//
// Ranks R of the n + m values together, ties sharing the mean of theirs; W = sum of R over the
// first sample. Under the hypothesis that the two are of one distribution each of the C(n+m, n)
// choices of n ranks is as likely as any other, so that with N(j, w) ways to have j ranks of sum w
//
//     p = sum over |w - mean| >= |W - mean| of N(n, w) / C(n+m, n),   mean = n (n + m + 1) / 2,
//
// which is exact, whatever the distribution (F. Wilcoxon 1945; H. B. Mann, D. R. Whitney 1947).
// Twice the ranks are whole numbers, and of these the ways are counted. They depend on the ties
// alone: samples without any share them.
#include "measure/rank_test.h"
#include "base/sorted.h"
#include "base/zeroed.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

// Twice the rank of a value among all.
static size_t double_rank(const double *all, size_t count, double value)
{
    size_t below = 0;
    size_t equal = 0;
    for (size_t i = 0; i < count; i++) {
        below += all[i] < value ? 1 : 0;
        equal += all[i] == value ? 1 : 0;
    }
    return 2 * below + equal + 1;
}

// The ways to choose so many of some ranks with each sum, as shares of all choices: each rank is
// taken in with the chance that keeps every choice equally likely. The ranks ascend, so that the
// sums of j of the first i lie between those of the first j and of the last j of them.
static double *count_ways(const size_t *ranks, size_t count, size_t chosen)
{
    size_t sums[RANK_TEST_BOTH + 1] = {0}; // of the first ranks
    for (size_t i = 0; i < count; i++) {
        sums[i + 1] = sums[i] + ranks[i];
    }
    const size_t width = sums[count] + 1;
    double *ways = zeroed((chosen + 1) * width, sizeof *ways);
    ways[0] = 1.0;
    for (size_t i = 0; i < count; i++) {
        const double left = (double)(count - i);
        for (size_t j = (i < chosen ? i : chosen) + 1; j-- > 0;) {
            const double chance = (double)(chosen - j) / left;
            double *here = ways + j * width;
            double *next = here + width;
            for (size_t w = sums[j]; w <= sums[i] - sums[i - j]; w++) {
                if (j < chosen) {
                    next[w + ranks[i]] += here[w] * chance;
                }
                here[w] *= 1.0 - chance;
            }
        }
    }
    memmove(ways, ways + chosen * width, width * sizeof *ways);
    return ways;
}

static int rank_test_by_size(const void *a, const void *b)
{
    const size_t first = *(const size_t *)a;
    const size_t second = *(const size_t *)b;
    return (first > second) - (first < second);
}

// The ways of these ranks, kept from the last time where they were the same.
static void rank_test_settle(RankTest *test, const size_t *ranks, size_t count, size_t chosen)
{
    size_t sorted[RANK_TEST_BOTH];
    memcpy(sorted, ranks, count * sizeof *ranks);
    qsort(sorted, count, sizeof *sorted, rank_test_by_size);
    if (test->count == count && test->chosen == chosen &&
        memcmp(test->ranks, sorted, count * sizeof *sorted) == 0) {
        return;
    }
    free(test->ways);
    test->ways = count_ways(sorted, count, chosen);
    test->count = count;
    test->chosen = chosen;
    test->sum = 0;
    memcpy(test->ranks, sorted, count * sizeof *sorted);
    for (size_t i = 0; i < count; i++) {
        test->sum += sorted[i];
    }
}

// Share of the choices whose doubled sum is so far from the mean, or farther.
static double tail(const RankTest *test, double distance)
{
    const double mean = (double)test->chosen * (double)(test->count + 1);
    double share = 0.0;
    for (size_t w = 0; w <= test->sum; w++) {
        // half a unit: sums are whole, so that rounding decides nothing
        share += fabs((double)w - mean) >= distance - 0.5 ? test->ways[w] : 0.0;
    }
    return fmin(share, 1.0);
}

void rank_test_finish(RankTest *test)
{
    free(test->ways);
    *test = (RankTest){.count = 0};
}

double rank_test_p(RankTest *test, const double *first, size_t first_count, const double *second,
                   size_t second_count)
{
    assert(first_count > 0 && first_count <= RANK_TEST_MAX);
    assert(second_count > 0 && second_count <= RANK_TEST_MAX);
    const size_t count = first_count + second_count;
    double all[RANK_TEST_BOTH];
    memcpy(all, first, first_count * sizeof *first);
    memcpy(all + first_count, second, second_count * sizeof *second);
    size_t ranks[RANK_TEST_BOTH];
    size_t sum = 0;
    for (size_t i = 0; i < count; i++) {
        ranks[i] = double_rank(all, count, all[i]);
        sum += i < first_count ? ranks[i] : 0;
    }
    rank_test_settle(test, ranks, count, first_count);
    const double mean = (double)first_count * (double)(count + 1);
    return tail(test, fabs((double)sum - mean));
}

// Whether the test detects a shift. W grows with the shift alone, so that this is found once.
static bool is_seen(RankTest *test, const double *sorted, size_t count, double shift, double rate)
{
    double moved[RANK_TEST_MAX];
    for (size_t i = 0; i < count; i++) {
        moved[i] = sorted[i] + shift;
    }
    return rank_test_p(test, sorted, count, moved, count) <= rate;
}

double rank_test_shift(RankTest *test, const double *sorted, size_t count, double rate)
{
    // more than the range lies all of one sample beyond all of the other
    const double range = sorted[count - 1] - sorted[0];
    double seen = 1.001 * range;
    if (!(range > 0.0) || !is_seen(test, sorted, count, seen, rate)) {
        return INFINITY;
    }
    double unseen = 0.0;
    // to a hundredth of the range: it is for people to read
    while (seen - unseen > 0.01 * range) {
        const double middle = 0.5 * (seen + unseen);
        if (is_seen(test, sorted, count, middle, rate)) {
            seen = middle;
        } else {
            unseen = middle;
        }
    }
    return seen;
}
