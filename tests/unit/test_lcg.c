// Are the draws of neighbouring seeds independent, whichever draw of a start it is?
#include "base/lcg.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

enum { MEMBERS = 64, HALF = MEMBERS / 2, DRAWS = 4000 };

// How far the ranks of the first half lie from where they would by chance, in standard deviations
// (Wilcoxon's rank sum, normal for samples of this size).
static double rank_deviation(const double *values)
{
    double sum = 0.0;
    for (size_t i = 0; i < HALF; i++) {
        for (size_t k = 0; k < MEMBERS; k++) {
            sum += values[k] < values[i] ? 1.0 : 0.0;
        }
    }
    const double mean = 0.5 * HALF * (MEMBERS - 1);
    return (sum - mean) / sqrt(HALF * HALF * (MEMBERS + 1) / 12.0);
}

// Of how many draws a rank test at the false-alarm rate 0.001 calls the first 32 members others
// than the next 32.
static size_t count_alarms(uint64_t (*stirred)(unsigned number))
{
    static const double ALARM = 3.29; // standard deviations, two-sided
    uint64_t seeds[MEMBERS];
    for (unsigned i = 0; i < MEMBERS; i++) {
        seeds[i] = stirred(1000 + i);
    }
    size_t alarms = 0;
    for (size_t draw = 0; draw < DRAWS; draw++) {
        double values[MEMBERS];
        for (size_t i = 0; i < MEMBERS; i++) {
            values[i] = lcg_draw(&seeds[i]);
        }
        alarms += fabs(rank_deviation(values)) > ALARM ? 1 : 0;
    }
    return alarms;
}

// Stirred by the generator itself.
static uint64_t stirred_by_steps(unsigned number)
{
    uint64_t seed = number;
    for (int i = 0; i < 4; i++) {
        (void)lcg_draw(&seed);
    }
    return seed;
}

// Expected are 4 alarms in 4000 draws. Control: seeds stirred by an affine map make more than 100.
static void no_draw_rises_with_the_seed(void **state)
{
    (void)state;
    assert_in_range(count_alarms(lcg_stirred), 0, 12);
    assert_true(count_alarms(stirred_by_steps) > 100);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(no_draw_rises_with_the_seed),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
