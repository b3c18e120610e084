// Does a search take the right settings from the errors it is given?
#include "commands/tune/tune.h"

#include "close.h"
#include "kept.h"
#include "mechanism.h"

#include <string.h>

static Scenario loose(void)
{
    Scenario scenario = mechanism_paper();
    mechanism_loosen(&scenario, "crank-coupler");
    return scenario;
}

static Tune *search(const Scenario *scenario, const char *list, double target)
{
    Scheme schemes[SCHEME_MAX];
    size_t count = scheme_list(scenario, schemes);
    Err err = {0};
    assert_true(scheme_filter(list, schemes, &count, &err));
    return tune_create(scenario, schemes, count, target);
}

// A run that took so many steps, and as many microseconds.
static LadderRun run_of(double error, size_t steps)
{
    return (LadderRun){
        .is_complete = true,
        .error = {.is_known = true, .max = error, .max_in_horizon = error},
        .steps = steps,
        .wall_s = 1e-6 * (double)steps,
        .processor_s = 1e-6 * (double)steps,
    };
}

static void take(Tune *tune, size_t scheme, int index, double error, size_t steps)
{
    const LadderRun run = run_of(error, steps);
    tune_take(tune, scheme, index, &run);
}

static void values_are_preferred_numbers(void **state)
{
    (void)state;
    static const double SERIES[] = {1.0, 0.8, 0.63, 0.5, 0.4, 0.315, 0.25, 0.2, 0.16, 0.125, 0.1};
    for (int i = 0; i < 11; i++) {
        assert_true(tune_value(i) == SERIES[i]);
    }
    assert_true(tune_value(-1) == 1.25);
    assert_true(tune_value(-10) == 10.0);
    assert_true(tune_value(56) == 2.5e-6);
    // the tenth root of ten, with the rounding of the series: 1.6 over 1.25 is the largest
    for (int i = -20; i < 100; i++) {
        const double ratio = tune_value(i) / tune_value(i + 1);
        assert_true(ratio > 1.24 && ratio < 1.281);
    }
}

static void a_lucky_dip_is_no_setting(void **state)
{
    (void)state;
    const Scenario scenario = loose();
    Tune *tune = search(&scenario, "direct/plain/corrected", 1e-3);
    take(tune, 0, 40, 9e-4, 1000);
    assert_int_equal(tune->schemes[0].next, 41);
    assert_null(tune_best(tune, 0));
    take(tune, 0, 41, 2e-3, 1260);
    assert_null(tune_best(tune, 0));
    take(tune, 0, 42, 8e-4, 1600);
    take(tune, 0, 43, 7e-4, 2000);
    assert_int_equal(tune_best(tune, 0)->index, 42);
    assert_int_equal(tune->schemes[0].outcome, TUNE_MEETS);
    tune_destroy(tune);
}

static void only_steps_that_no_order_reaches_are_left_out(void **state)
{
    (void)state;
    const Scenario scenario = loose();
    Tune *tune = search(&scenario, "direct/plain/corrected,direct/staggered/midpoint", 1e-4);
    // 1e-1 to 4e-4 is a factor 250: at order 2 a step 15.8 times finer, twelve indices
    take(tune, 0, 20, 1e-1, 100);
    assert_int_equal(tune->schemes[0].next, 31);
    // at order 6 a step 2.5 times finer: four indices, less what is rounded down
    take(tune, 1, 20, 1e-1, 100);
    assert_int_equal(tune->schemes[1].next, 23);
    // near the target none is left out
    take(tune, 0, 31, 3e-4, 1000);
    assert_int_equal(tune->schemes[0].next, 32);
    tune_destroy(tune);
}

// Errors of order one, at long runs: 1e-3 is met at index 50, 22 settings behind index 28.
static double of_order_one(int index)
{
    return 1e-3 * tune_value(index) / tune_value(50);
}

static void take_in_order(Tune *tune, size_t scheme, double factor)
{
    const int index = tune->schemes[scheme].next;
    take(tune, scheme, index, factor * of_order_one(index), (size_t)(1.0 / tune_value(index)));
}

// Control: where runs are short all settings that an order of two could reach are run.
static void an_order_that_was_observed_stands_for_long_runs(void **state)
{
    (void)state;
    const Scenario scenario = loose();
    size_t trials[2];
    for (int i = 0; i < 2; i++) {
        Tune *tune = search(&scenario, "direct/plain/corrected", 1.0001e-3);
        tune->dear_s = i == 0 ? 0.0 : INFINITY;
        tune->schemes[0].next = 28;
        while (tune->schemes[0].outcome == TUNE_OPEN) {
            take_in_order(tune, 0, 1.0);
        }
        assert_int_equal(tune->schemes[0].outcome, TUNE_MEETS);
        assert_int_equal(tune_best(tune, 0)->index, 50);
        assert_true(tune->schemes[0].is_by_order == (i == 0));
        trials[i] = tune->trial_count;
        tune_destroy(tune);
    }
    assert_true(trials[0] <= 6 && trials[1] >= 10);
}

// Errors that fall faster from some index on: what the order had ruled out is run after all.
static void a_search_goes_back_where_errors_fell_faster(void **state)
{
    (void)state;
    const Scenario scenario = loose();
    Tune *tune = search(&scenario, "direct/plain/corrected", 1.0001e-3);
    tune->dear_s = 0.0;
    tune->schemes[0].next = 28;
    while (tune->schemes[0].outcome == TUNE_OPEN) {
        take_in_order(tune, 0, tune->schemes[0].next > 42 ? 0.6 : 1.0);
    }
    // 0.6 e is met two settings before
    assert_int_equal(tune_best(tune, 0)->index, 48);
    tune_destroy(tune);
}

static void errors_without_an_order_rule_nothing_out(void **state)
{
    (void)state;
    const Scenario scenario = loose();
    Tune *tune = search(&scenario, "direct/plain/corrected", 1.0001e-3);
    tune->dear_s = 0.0;
    tune->schemes[0].next = 28;
    static const double SCATTER[] = {1.0, 3.0, 1.0, 4.0, 2.0, 8.0, 1.5, 6.0};
    for (int i = 0; i < 8; i++) {
        take_in_order(tune, 0, SCATTER[i]);
        assert_false(tune->schemes[0].is_by_order);
    }
    tune_destroy(tune);
}

static void what_is_left_goes_by_the_order_that_was_seen(void **state)
{
    (void)state;
    const Scenario scenario = loose();
    Tune *tune = search(&scenario, "direct/plain/corrected,direct/staggered/midpoint", 1e-4);
    TuneLeft left = {.is_in = {true}, .best = INFINITY, .margin = 1.3, .limit_s = 1e9};
    assert_near(tune_left(tune, &left), 0.0, 0.0);
    // order 2 between a step and half of it: 1.5e-3 needs a quarter of that, six settings on, and
    // one more to confirm it
    take(tune, 0, 40, 6.0e-3, 10000);
    take(tune, 0, 43, 1.5e-3, 20000);
    tune->schemes[0].next = 44;
    double sum_s = 0.0;
    for (int index = 44; index <= 50; index++) {
        sum_s += tune_time(tune, 0, index);
    }
    assert_near(tune_left(tune, &left), sum_s, 1e-12);
    // on a machine that does as much beside them it takes twice as long
    tune->trials[0].run.wall_s *= 2.0;
    tune->trials[1].run.wall_s *= 2.0;
    assert_near(tune_left(tune, &left), 2.0 * sum_s, 1e-12);
    tune->trials[0].run.wall_s *= 0.5;
    tune->trials[1].run.wall_s *= 0.5;
    // not what costs more than the best, nor what takes too long
    left.best = tune_time(tune, 0, 45) / left.margin;
    assert_near(tune_left(tune, &left), tune_time(tune, 0, 44) + tune_time(tune, 0, 45), 1e-12);
    left.best = INFINITY;
    left.limit_s = 1.001 * tune_time(tune, 0, 44);
    assert_near(tune_left(tune, &left), tune_time(tune, 0, 44), 1e-12);
    // a scheme that has ended, unless it is taken up again
    tune->schemes[0].outcome = TUNE_COSTLIER;
    assert_near(tune_left(tune, &left), 0.0, 0.0);
    left.is_reopened = true;
    assert_near(tune_left(tune, &left), tune_time(tune, 0, 44), 1e-12);
    tune_destroy(tune);
}

static void a_run_that_fails_or_is_unstable_has_no_error(void **state)
{
    (void)state;
    const Scenario scenario = loose();
    Tune *tune = search(&scenario, "direct/plain/corrected", 1e-3);
    char reason[LADDER_MESSAGE_SIZE];
    const LadderRun failed = {.message = "it broke"};
    assert_true(isnan(tune_error(tune, &failed, reason)));
    assert_string_equal(reason, "it broke");
    const LadderRun wild = run_of(2.5, 10);
    assert_true(isnan(tune_error(tune, &wild, reason)));
    // control: one that is merely bad has, such as impacts at other times, velocities turned round
    const LadderRun bad = run_of(1.9, 10);
    assert_true(tune_error(tune, &bad, reason) == 1.9);
    assert_string_equal(reason, "");
    // and only the next setting is tried after a failure
    tune_take(tune, 0, 20, &failed);
    assert_int_equal(tune->schemes[0].next, 21);
    tune_destroy(tune);
}

static void the_uncertainty_of_the_truth_counts_as_error(void **state)
{
    (void)state;
    const Scenario scenario = loose();
    Tune *tune = search(&scenario, "direct/plain/corrected", 1e-3);
    tune->truth.uncertainty = 1e-4;
    take(tune, 0, 40, 9.5e-4, 1000);
    assert_false(tune->trials[0].meets);
    take(tune, 0, 41, 8.5e-4, 1000);
    assert_true(tune->trials[1].meets);
    tune_destroy(tune);
}

static void the_cheapest_wins_by_steps_and_by_time(void **state)
{
    (void)state;
    const Scenario scenario = loose();
    Tune *tune = search(&scenario, "direct/plain/corrected,direct/staggered/impulse", 1e-3);
    take(tune, 0, 40, 9e-4, 2000);
    take(tune, 0, 41, 8e-4, 2500);
    // fewer steps that take longer
    LadderRun slow = run_of(9e-4, 500);
    slow.evaluations = 1000000;
    tune_take(tune, 1, 30, &slow);
    slow.steps = 630;
    tune_take(tune, 1, 31, &slow);
    tune->cost = TUNE_STEPS;
    tune_conclude(tune, &scenario);
    assert_int_equal(tune->winner, 1);
    assert_int_equal(tune->plain, 0);
    tune->cost = TUNE_TIME;
    tune_conclude(tune, &scenario);
    assert_int_equal(tune->winner, 0);
    tune_destroy(tune);
}

static void a_limit_leaves_the_least_error_that_it_allows(void **state)
{
    (void)state;
    const Scenario scenario = loose();
    Tune *tune = search(&scenario, "direct/plain/corrected", 1e-3);
    tune->cost = TUNE_STEPS;
    tune->limit.steps = 1500;
    take(tune, 0, 38, 2e-3, 1000);
    take(tune, 0, 39, 3e-3, 1260);
    take(tune, 0, 40, 9e-4, 1600);
    take(tune, 0, 41, 8e-4, 2000);
    tune_conclude(tune, &scenario);
    assert_int_equal(tune->within, 0);
    assert_false(tune_is_within(tune, tune_best(tune, tune->winner)));
    tune_destroy(tune);
}

static void tolerances_of_chosen_steps_are_one_scheme(void **state)
{
    (void)state;
    const Scenario scenario = loose();
    Tune *tune = search(&scenario, "auto", 1e-3);
    assert_int_equal(tune->scheme_count, 1);
    assert_string_equal(tune->schemes[0].scheme.name, "auto");
    assert_true(tune_value(tune->schemes[0].first) <= 6e-3);
    Scenario changed = kept_copy(&scenario);
    tune_apply(&tune->schemes[0], 2.5e-4, &changed);
    assert_true(changed.run.step == 0.0 && changed.run.tolerance == 2.5e-4);
    tune_destroy(tune);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(values_are_preferred_numbers),
        cmocka_unit_test(a_lucky_dip_is_no_setting),
        cmocka_unit_test(only_steps_that_no_order_reaches_are_left_out),
        cmocka_unit_test(an_order_that_was_observed_stands_for_long_runs),
        cmocka_unit_test(a_search_goes_back_where_errors_fell_faster),
        cmocka_unit_test(errors_without_an_order_rule_nothing_out),
        cmocka_unit_test(what_is_left_goes_by_the_order_that_was_seen),
        cmocka_unit_test(a_run_that_fails_or_is_unstable_has_no_error),
        cmocka_unit_test(the_uncertainty_of_the_truth_counts_as_error),
        cmocka_unit_test(the_cheapest_wins_by_steps_and_by_time),
        cmocka_unit_test(a_limit_leaves_the_least_error_that_it_allows),
        cmocka_unit_test(tolerances_of_chosen_steps_are_one_scheme),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
