// Does the interval of a quantile hold the true one as often as it says?
//
// The truths are known distributions: of numbers that depend on none, and of ones that depend on
// their predecessors, x_(k+1) = a x_k + e, whose distribution is normal, too. The control takes the
// latter for independent. Shares are those of printed tables.
#include "close.h"

#include "base/lcg.h"
#include "base/quantile.h"
#include "base/sorted.h"

#include <stdbool.h>
#include <stdlib.h>

enum { TRIALS = 400, SERIES = 16, LENGTH = 150 };

static const double NORMAL_95 = 1.6448536269514722; // the 95 % quantile of the normal distribution

// A normal number by the sum of twelve evenly spread ones: right to 0.01 at 95 %, where it is used.
static double normal_draw(uint64_t *seed)
{
    double sum = 0.0;
    for (int i = 0; i < 12; i++) {
        sum += 0.5 * lcg_draw(seed);
    }
    return sum;
}

// The share of trials whose interval holds the true quantile; the series may be told as they are,
// or as numbers that depend on none.
static double share_held(double memory, bool is_told)
{
    static double values[SERIES * LENGTH];
    static size_t lengths[SERIES * LENGTH];
    int held = 0;
    for (int trial = 0; trial < TRIALS; trial++) {
        uint64_t seed = lcg_stirred((unsigned)trial);
        for (size_t i = 0; i < SERIES; i++) {
            double x = normal_draw(&seed);
            for (size_t k = 0; k < LENGTH; k++) {
                values[LENGTH * i + k] = x;
                x = memory * x + sqrt(1.0 - memory * memory) * normal_draw(&seed);
            }
            lengths[i] = LENGTH;
        }
        const size_t count = SERIES * LENGTH;
        for (size_t i = 0; i < count && !is_told; i++) {
            lengths[i] = 1;
        }
        const QuantileSeries series = {values, count, lengths, is_told ? SERIES : count};
        const Quantile found = quantile_of(&series, 0.95);
        held += found.low <= NORMAL_95 && NORMAL_95 <= found.high ? 1 : 0;
    }
    return (double)held / TRIALS;
}

static void intervals_of_independent_numbers_hold_the_quantile(void **state)
{
    (void)state;
    // 95 %, less three standard deviations of the trials
    assert_true(share_held(0.0, true) >= 0.95 - 3.0 * sqrt(0.95 * 0.05 / TRIALS));
}

static void intervals_of_dependent_numbers_hold_it_too(void **state)
{
    (void)state;
    assert_true(share_held(0.9, true) >= 0.95 - 3.0 * sqrt(0.95 * 0.05 / TRIALS));
    // the control: taken for independent they are too narrow
    assert_true(share_held(0.9, false) < 0.7);
}

// The chance that all of n numbers are below the 95 % quantile is 0.95^n: 72 of them bound it from
// above, 71 do not.
static void too_few_numbers_do_not_bound_it(void **state)
{
    (void)state;
    enum { ENOUGH = 72, FEW = 71 };
    double values[ENOUGH];
    size_t lengths[ENOUGH];
    for (size_t i = 0; i < ENOUGH; i++) {
        values[i] = (double)i;
        lengths[i] = 1;
    }
    const Quantile bound = quantile_of(&(QuantileSeries){values, ENOUGH, lengths, ENOUGH}, 0.95);
    const Quantile open = quantile_of(&(QuantileSeries){values, FEW, lengths, FEW}, 0.95);
    assert_true(isinf(open.high));
    assert_close(bound.high, 71.0, 1e-12);
}

// Clopper and Pearson: of 4 of 4, 0.025^(1/4); 10 of 16 by tables.
static void a_share_has_its_interval(void **state)
{
    (void)state;
    const Quantile all = quantile_share(4, 4);
    assert_close(all.low, pow(0.025, 0.25), 1e-9);
    assert_close(all.high, 1.0, 1e-12);
    const Quantile some = quantile_share(10, 16);
    assert_close(some.low, 0.3543, 1e-3);
    assert_close(some.high, 0.8480, 1e-3);
    const Quantile none = quantile_share(0, 64);
    assert_close(none.high, 1.0 - pow(0.025, 1.0 / 64.0), 1e-9);
}

// As R gives them, quantile(c(1, 2, 4, 8), ...) of type 7.
static void quantiles_lie_between_the_values_beside_them(void **state)
{
    (void)state;
    const double values[] = {1.0, 2.0, 4.0, 8.0};
    assert_close(sorted_quantile(values, 4, 0.05), 1.15, 1e-14);
    assert_close(sorted_quantile(values, 4, 0.5), 3.0, 1e-14);
    assert_close(sorted_quantile(values, 4, 0.95), 7.4, 1e-14);
    assert_close(sorted_quantile(values, 4, 0.0), 1.0, 0.0);
    assert_close(sorted_quantile(values, 4, 1.0), 8.0, 0.0);
    assert_close(sorted_quantile(values, 1, 0.95), 1.0, 0.0);
    // of infinite ones no NaN
    const double open[] = {1.0, INFINITY, INFINITY};
    assert_close(sorted_quantile(open, 2, 0.0), 1.0, 0.0);
    assert_true(isinf(sorted_quantile(open, 3, 0.95)));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(intervals_of_independent_numbers_hold_the_quantile),
        cmocka_unit_test(intervals_of_dependent_numbers_hold_it_too),
        cmocka_unit_test(too_few_numbers_do_not_bound_it),
        cmocka_unit_test(a_share_has_its_interval),
        cmocka_unit_test(quantiles_lie_between_the_values_beside_them),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
