// Finds quantiles with their confidence intervals.
//
// Of n independent numbers k are below the quantile of a share s with the binomial probability
//     P(K <= k) = sum over i <= k of C(n, i) s^i (1 - s)^(n - i)
// so that the numbers whose ranks that leaves 2.5 % beyond, below and above, bound the quantile
// whatever the distribution (order statistics; David and Nagaraja, Order Statistics, 2003, 7.1).
// Numbers that depend on their predecessors count for fewer: with I whether one is above the
// quantile, means of I over blocks of b numbers in a row would have the variance s (1 - s) / b. By
// how many times theirs is larger, for the block length of which that is largest, so many times
// fewer independent numbers there are (batch means; Flegal and Jones, Ann. Stat. 38, 2010).
#include "base/quantile.h"

#include "base/sorted.h"
#include "base/zeroed.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

// of an interval of 95 %, to each side
static const double BEYOND = 0.025;

// Blocks at least, so that their variance is known to a third.
enum { BLOCKS_LEAST = 16 };

enum { BISECTIONS = 60 }; // halve an interval of 1 to rounding

// The logarithm of P(K = k + 1) / P(K = k), of n; sums of logarithms do not underflow.
static double log_step(size_t k, size_t n, double share)
{
    return log((double)(n - k) / (double)(k + 1)) + log(share) - log1p(-share);
}

// P(K <= k), of n.
static double binomial_up_to(size_t k, size_t n, double share)
{
    double sum = 0.0;
    double log_term = (double)n * log1p(-share);
    for (size_t i = 0; i <= k && i <= n; i++) {
        sum += exp(log_term);
        log_term += log_step(i, n, share);
    }
    return fmin(sum, 1.0);
}

// The ranks, from 1, of the order statistics of n numbers that bound a quantile: 0 where none is
// low enough, n + 1 where none is high enough.
typedef struct Ranks {
    size_t low;
    size_t high;
} Ranks;

static Ranks bounding_ranks(size_t n, double share)
{
    Ranks ranks = {0, n + 1};
    double up_to = 0.0; // P(K <= k - 1)
    double log_term = (double)n * log1p(-share);
    for (size_t k = 1; k <= n && ranks.high > n; k++) {
        up_to += exp(log_term);
        log_term += log_step(k - 1, n, share);
        ranks.low = up_to <= BEYOND ? k : ranks.low;
        ranks.high = 1.0 - up_to <= BEYOND ? k : ranks.high;
    }
    return ranks;
}

// The variance of block means of what is above a value, over that of independent numbers; 1 where
// there are too few blocks.
static double block_ratio(const QuantileSeries *series, double value, double share, size_t length)
{
    size_t blocks = 0;
    double squares = 0.0;
    const double *at = series->values;
    for (size_t i = 0; i < series->series_count; i++) {
        for (size_t k = 0; k + length <= series->lengths[i]; k += length) {
            size_t above = 0;
            for (size_t j = 0; j < length; j++) {
                above += at[k + j] > value ? 1 : 0;
            }
            const double off = (double)above / (double)length - (1.0 - share);
            squares += off * off;
            blocks++;
        }
        at += series->lengths[i];
    }
    return blocks < BLOCKS_LEAST
               ? 1.0
               : (double)length * squares / ((double)blocks * share * (1.0 - share));
}

// How many numbers in a row tell as much as one that depends on none.
static double inefficiency(const QuantileSeries *series, double value, double share)
{
    double most = 1.0;
    for (size_t length = 2; length * BLOCKS_LEAST <= series->count; length *= 2) {
        most = fmax(most, block_ratio(series, value, share, length));
    }
    return most;
}

Quantile quantile_of(const QuantileSeries *series, double share)
{
    const size_t count = series->count;
    double *sorted = zeroed(count, sizeof *sorted);
    memcpy(sorted, series->values, count * sizeof *sorted);
    sorted_make(sorted, count);
    const double rank = ceil(share * (double)count);
    Quantile found = {.value = sorted[(size_t)fmax(rank, 1.0) - 1]};
    const double independent = (double)count / inefficiency(series, found.value, share);
    const size_t n = (size_t)fmax(1.0, floor(independent));
    const Ranks ranks = bounding_ranks(n, share);
    const double per_rank = (double)count / (double)n;
    const double low = floor((double)ranks.low * per_rank);
    const double high = ceil((double)ranks.high * per_rank);
    found.low = sorted[(size_t)fmax(low, 1.0) - 1];
    found.high = ranks.high > n ? INFINITY : sorted[(size_t)fmin(high, (double)count) - 1];
    free(sorted);
    return found;
}

// The share at which so many or fewer of a total (or so many or more) have the probability BEYOND.
static double share_at(size_t count, size_t total, bool is_or_fewer)
{
    double low = 0.0;
    double high = 1.0;
    for (int i = 0; i < BISECTIONS; i++) {
        const double share = 0.5 * (low + high);
        const double probability = is_or_fewer ? binomial_up_to(count, total, share)
                                               : 1.0 - binomial_up_to(count - 1, total, share);
        // fewer become less likely as the share grows, more likelier
        const bool is_above = is_or_fewer ? probability < BEYOND : probability > BEYOND;
        *(is_above ? &high : &low) = share;
    }
    return 0.5 * (low + high);
}

Quantile quantile_share(size_t count, size_t total)
{
    return (Quantile){
        .value = (double)count / (double)total,
        .low = count == 0 ? 0.0 : share_at(count, total, false),
        .high = count == total ? 1.0 : share_at(count, total, true),
    };
}
