// Has a distribution moved?
//
// Ranks R of the n + m values together, ties sharing the mean of theirs; W = sum of R over the
// first sample. Under the hypothesis that the two are of one distribution each of the C(n+m, n)
// choices of n ranks is as likely as any other, so that with N(j, w) ways to have j ranks of sum w
//
//     p = sum over |w - mean| >= |W - mean| of N(n, w) / C(n+m, n),   mean = n (n + m + 1) / 2,
//
// which is exact, whatever the distribution (F. Wilcoxon 1945; H. B. Mann, D. R. Whitney 1947).
// Twice the ranks are whole numbers, and of these the ways are counted.
#include "measure/rank_test.h"

#include "base/sorted.h"

#include <assert.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

enum { BOTH_MAX = 2 * RANK_TEST_MAX, SUM_MAX = RANK_TEST_MAX * (2 * BOTH_MAX + 1) + 1 };

// Twice the rank of a value among all, ascending.
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

// Share of the choices whose doubled sum is so far from the mean, or farther.
static double tail(const size_t *ranks, size_t count, size_t chosen, double distance)
{
    // ways[j][w] to choose j of the ranks taken in so far with the sum w, as shares of all choices:
    // each rank is chosen with the chance that keeps every choice of `chosen` equally likely
    double(*ways)[SUM_MAX] = calloc(RANK_TEST_MAX + 1, sizeof *ways);
    assert(ways != NULL);
    ways[0][0] = 1.0;
    size_t most = 0;
    for (size_t i = 0; i < count; i++) {
        const double left = (double)(count - i);
        most += ranks[i];
        const size_t top = most < SUM_MAX - 1 ? most : SUM_MAX - 1;
        for (size_t j = (i < chosen ? i : chosen) + 1; j-- > 0;) {
            const double chance = (double)(chosen - j) / left;
            for (size_t w = top + 1; w-- > 0;) {
                const double here = ways[j][w];
                if (here == 0.0) {
                    continue;
                }
                if (j < chosen && w + ranks[i] < SUM_MAX) {
                    ways[j + 1][w + ranks[i]] += here * chance;
                }
                ways[j][w] = here * (1.0 - chance);
            }
        }
    }
    const double mean = (double)chosen * (double)(count + 1);
    double share = 0.0;
    for (size_t w = 0; w < SUM_MAX; w++) {
        // half a unit: sums are whole, so that rounding decides nothing
        share += fabs((double)w - mean) >= distance - 0.5 ? ways[chosen][w] : 0.0;
    }
    free(ways);
    return fmin(share, 1.0);
}

double rank_test_p(const double *first, size_t first_count, const double *second,
                   size_t second_count)
{
    assert(first_count > 0 && first_count <= RANK_TEST_MAX);
    assert(second_count > 0 && second_count <= RANK_TEST_MAX);
    const size_t count = first_count + second_count;
    double all[BOTH_MAX];
    memcpy(all, first, first_count * sizeof *first);
    memcpy(all + first_count, second, second_count * sizeof *second);
    size_t ranks[BOTH_MAX];
    size_t sum = 0;
    for (size_t i = 0; i < count; i++) {
        ranks[i] = double_rank(all, count, all[i]);
        sum += i < first_count ? ranks[i] : 0;
    }
    const double mean = (double)first_count * (double)(count + 1);
    return tail(ranks, count, first_count, fabs((double)sum - mean));
}

// Whether the test detects a shift. W grows with the shift alone, so that this is found once.
static bool is_seen(const double *sorted, size_t count, double shift, double rate)
{
    double moved[RANK_TEST_MAX];
    for (size_t i = 0; i < count; i++) {
        moved[i] = sorted[i] + shift;
    }
    return rank_test_p(sorted, count, moved, count) <= rate;
}

double rank_test_shift(const double *sorted, size_t count, double rate)
{
    // more than the range lies all of one sample beyond all of the other
    const double range = sorted[count - 1] - sorted[0];
    double seen = 1.001 * range;
    if (!(range > 0.0) || !is_seen(sorted, count, seen, rate)) {
        return INFINITY;
    }
    double unseen = 0.0;
    // to a hundredth of the range: it is for people to read
    while (seen - unseen > 0.01 * range) {
        const double middle = 0.5 * (seen + unseen);
        if (is_seen(sorted, count, middle, rate)) {
            seen = middle;
        } else {
            unseen = middle;
        }
    }
    return seen;
}
