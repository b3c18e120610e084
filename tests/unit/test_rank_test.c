// Does the rank test know the chances it speaks of?
#include "base/lcg.h"
#include "base/sorted.h"
#include "close.h"
#include "measure/rank_test.h"

#include <string.h>

static double p_of(const double *first, size_t first_count, const double *second,
                   size_t second_count)
{
    RankTest test = {.count = 0};
    const double p = rank_test_p(&test, first, first_count, second, second_count);
    rank_test_finish(&test);
    return p;
}

static double shift_of(const double *sorted, size_t count, double rate)
{
    RankTest test = {.count = 0};
    const double shift = rank_test_shift(&test, sorted, count, rate);
    rank_test_finish(&test);
    return shift;
}

static void samples_apart_have_the_chance_of_one_choice_in_all(void **state)
{
    (void)state;
    const double low[] = {1, 2, 3, 4};
    const double high[] = {5, 6, 7, 8};
    // two of the C(8, 4) = 70 choices are as extreme
    assert_near(p_of(low, 4, high, 4), 2.0 / 70.0, 1e-15);
    assert_near(p_of(high, 4, low, 4), 2.0 / 70.0, 1e-15);
    const double three[] = {1, 2, 3};
    // C(7, 3) = 35
    assert_near(p_of(three, 3, high, 4), 2.0 / 35.0, 1e-15);
}

static void the_chance_of_a_table_is_found(void **state)
{
    (void)state;
    // W = 16 of n = 5, m = 5 (ranks 1, 2, 3, 4, 6): 2 of the 252 choices have W <= 16, so p = 4 /
    // 252
    const double first[] = {1, 2, 3, 4, 6};
    const double second[] = {5, 7, 8, 9, 10};
    assert_near(p_of(first, 5, second, 5), 4.0 / 252.0, 1e-15);
}

// The same chance by going through every choice of 4 of 8.
static double by_enumeration(const double *all)
{
    double ranks[8];
    double seen = 0.0;
    for (int i = 0; i < 8; i++) {
        ranks[i] = 0.5;
        for (int k = 0; k < 8; k++) {
            ranks[i] += all[k] < all[i] ? 1.0 : all[k] == all[i] ? 0.5 : 0.0;
        }
        seen += i < 4 ? ranks[i] : 0.0;
    }
    int far = 0;
    int choices = 0;
    for (unsigned mask = 0; mask < 256; mask++) {
        double sum = 0.0;
        for (int i = 0; i < 8; i++) {
            sum += (mask >> i & 1u) != 0 ? ranks[i] : 0.0;
        }
        if (__builtin_popcount(mask) == 4) {
            choices++;
            far += fabs(sum - 18.0) >= fabs(seen - 18.0) - 1e-9 ? 1 : 0;
        }
    }
    return (double)far / (double)choices;
}

static void ties_are_counted_as_every_choice_would(void **state)
{
    (void)state;
    uint64_t seed = 7;
    for (int trial = 0; trial < 50; trial++) {
        double all[8];
        for (int i = 0; i < 8; i++) {
            // five values for eight places: there are ties always
            all[i] = floor(2.5 * (1.0 + lcg_draw(&seed)));
        }
        assert_near(p_of(all, 4, all + 4, 4), by_enumeration(all), 1e-14);
    }
}

static void equal_samples_are_never_told_apart(void **state)
{
    (void)state;
    double values[RANK_TEST_MAX];
    for (int i = 0; i < RANK_TEST_MAX; i++) {
        values[i] = 3.0;
    }
    assert_near(p_of(values, RANK_TEST_MAX, values, RANK_TEST_MAX), 1.0, 1e-12);
    assert_true(shift_of(values, 32, 1e-3) == INFINITY);
}

static size_t count_alarms(double shift, double rate, size_t trials)
{
    uint64_t seed = 11;
    size_t alarms = 0;
    for (size_t trial = 0; trial < trials; trial++) {
        double first[16];
        double second[16];
        for (int i = 0; i < 16; i++) {
            first[i] = lcg_draw(&seed);
            second[i] = lcg_draw(&seed) + shift;
        }
        alarms += p_of(first, 16, second, 16) <= rate ? 1 : 0;
    }
    return alarms;
}

static void false_alarms_come_no_more_often_than_asked_for(void **state)
{
    (void)state;
    // 400 trials at 0.05: 20 expected, 35 is 3.4 standard deviations above
    const size_t alarms = count_alarms(0.0, 0.05, 400);
    assert_in_range(alarms, 5, 35);
    // the control: a shift of 1.5 standard deviations (0.577 each) is seen nearly always
    assert_in_range(count_alarms(1.5 * 0.577, 0.05, 400), 380, 400);
}

static void the_shift_that_is_told_is_told(void **state)
{
    (void)state;
    double sample[32];
    uint64_t seed = 5;
    for (int i = 0; i < 32; i++) {
        sample[i] = lcg_draw(&seed);
    }
    sorted_make(sample, 32);
    const double shift = shift_of(sample, 32, 1e-4);
    double moved[32];
    for (int i = 0; i < 32; i++) {
        moved[i] = sample[i] + shift;
    }
    assert_true(p_of(sample, 32, moved, 32) <= 1e-4);
    for (int i = 0; i < 32; i++) {
        moved[i] = sample[i] + 0.9 * shift;
    }
    assert_true(p_of(sample, 32, moved, 32) > 1e-4);
}

// What is kept of one pair of samples is used for the next where it holds, and not where it does
// not.
static void what_is_kept_holds_for_the_same_ties_alone(void **state)
{
    (void)state;
    const double plain[3][8] = {
        {1, 2, 3, 4, 5, 6, 7, 8}, {8, 1, 7, 2, 6, 3, 5, 4}, {1, 3, 2, 4, 8, 6, 7, 5}};
    const double tied[8] = {1, 1, 2, 3, 3, 3, 4, 5};
    RankTest test = {.count = 0};
    for (int i = 0; i < 3; i++) {
        assert_near(rank_test_p(&test, plain[i], 4, plain[i] + 4, 4), by_enumeration(plain[i]),
                    1e-14);
    }
    assert_near(rank_test_p(&test, tied, 4, tied + 4, 4), by_enumeration(tied), 1e-14);
    assert_near(rank_test_p(&test, plain[0], 4, plain[0] + 4, 4), by_enumeration(plain[0]), 1e-14);
    // other sizes of the same values: C(8, 3) = 56
    assert_near(rank_test_p(&test, plain[0], 3, plain[0] + 3, 5), 2.0 / 56.0, 1e-14);
    rank_test_finish(&test);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(samples_apart_have_the_chance_of_one_choice_in_all),
        cmocka_unit_test(the_chance_of_a_table_is_found),
        cmocka_unit_test(what_is_kept_holds_for_the_same_ties_alone),
        cmocka_unit_test(ties_are_counted_as_every_choice_would),
        cmocka_unit_test(equal_samples_are_never_told_apart),
        cmocka_unit_test(false_alarms_come_no_more_often_than_asked_for),
        cmocka_unit_test(the_shift_that_is_told_is_told),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
