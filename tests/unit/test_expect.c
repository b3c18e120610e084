// Which numbers are within a limit of a case, and which case says what of which run?
#include "commands/check/baseline.h"
#include "commands/check/check_judge.h"
#include "commands/check/check_measure.h"
#include "load_case.h"

#include <float.h>
#include <stdio.h>
#include <stdlib.h>

// The expectation of one limit, on a number of an own case.
static Expectation read_expectation(const char *path, const char *limit)
{
    char setting[256];
    snprintf(setting, sizeof setting, "expect={%s: %s}", path, limit);
    const char *settings[] = {setting};
    const Scenario scenario = load("cases/literature/pin-in-hole-drop.yaml", settings, 1);
    assert_int_equal(scenario.expectation_count, 1);
    return scenario.expectations[0];
}

static bool holds(const char *limit, double value)
{
    const Expectation expectation = read_expectation("joints.hole.force_max", limit);
    return expect_value_off(&expectation, value) == 0.0;
}

static void ends_belong_to_between_and_within_alone(void **state)
{
    (void)state;
    assert_true(holds("below 1.2 kN", 1199.9));
    assert_false(holds("below 1.2 kN", 1200.0));
    assert_true(holds("above 1.2 kN", 1200.1));
    assert_false(holds("above 1.2 kN", 1200.0));
    assert_true(holds("between 1 N and 2 N", 1.0) && holds("between 1 N and 2 N", 2.0));
    assert_false(holds("between 1 N and 2 N", 2.0 * (1.0 + DBL_EPSILON)));
    assert_true(holds("within 2 % of 100 N", 102.0) && holds("within 2% of 100 N", 98.0));
    assert_false(holds("within 2 % of 100 N", 102.1) || holds("within 2 % of 100 N", 97.9));
    assert_true(holds("within 500 mN of 2 N", 1.5) && holds("within 500 mN of 2 N", 2.5));
    assert_false(holds("within 500 mN of 2 N", 2.6) || holds("within 500 mN of 2 N", 1.4));
    // what is no number keeps no limit
    assert_false(holds("below 1.2 kN", NAN) || holds("between 1 N and 2 N", NAN));
}

static void off_is_signed_and_never_0_outside(void **state)
{
    (void)state;
    const Expectation within = read_expectation("joints.hole.force_max", "within 2 % of 100 N");
    assert_close(expect_value_off(&within, 105.0), 3.0, 1e-12);
    assert_close(expect_value_off(&within, 90.0), -8.0, 1e-12);
    const Expectation below = read_expectation("joints.hole.force_max", "below 1 N");
    assert_true(expect_value_off(&below, 1.0) > 0.0);
    const Expectation count = read_expectation("ode.joints.hole.impacts", "equals 3");
    assert_true(expect_value_off(&count, 3.0) == 0.0 && expect_value_off(&count, 2.0) == -1.0);
    assert_int_equal(count.backend, BACKEND_ODE);
}

static void a_limit_is_of_the_backends_that_feel_the_play(void **state)
{
    (void)state;
    const char *settings[] = {
        "expect={joints.crank-coupler.force_max: below 1 N, "
        "error.omega_max: below 1, analytic.bodies.coupler.omega_max: above 0 "
        "rpm}"};
    const Scenario scenario = load("cases/paper/stackup-impact.yaml", settings, 1);
    const Expectation *limits = scenario.expectations;
    assert_false(expect_value_concerns(&limits[0], &scenario, BACKEND_ANALYTIC));
    assert_true(expect_value_concerns(&limits[0], &scenario, BACKEND_REFERENCE));
    assert_true(expect_value_concerns(&limits[0], &scenario, BACKEND_ODE));
    // the reference has no error against itself
    assert_false(expect_value_concerns(&limits[1], &scenario, BACKEND_REFERENCE));
    assert_true(expect_value_concerns(&limits[1], &scenario, BACKEND_ODE));
    assert_true(expect_value_concerns(&limits[2], &scenario, BACKEND_ANALYTIC));
    assert_false(expect_value_concerns(&limits[2], &scenario, BACKEND_ODE));
}

static void numbers_are_those_of_the_run(void **state)
{
    (void)state;
    const char *settings[] = {
        "run.step=10 us",
        "expect={ode.joints.hole.force_max: below 1 GN, ode.joints.hole.impacts: above 0, "
        "ode.energy.residual: below 1 J, ode.error.omega_max: below 1}"};
    // there is no such unit
    Scenario scenario;
    Err err = {0};
    assert_false(
        casefile_load("cases/literature/pin-in-hole-drop.yaml", settings, 2, &scenario, &err));
    assert_int_equal(err.kind, ERR_USAGE);
    settings[1] =
        "expect={ode.joints.hole.force_max: below 1 MN, ode.joints.hole.impacts: above 0, "
        "ode.energy.residual: below 1 J, ode.error.omega_max: below 1}";
    scenario = load("cases/literature/pin-in-hole-drop.yaml", settings, 2);
    CheckMeasure *measure = calloc(1, sizeof *measure);
    CheckLimit *limits = calloc(CHECK_LIMIT_MAX, sizeof *limits);
    const CheckPlan plan = {.has_truth = false};
    check_measure(&scenario, &plan, measure);
    assert_true(measure->is_complete);
    assert_int_equal(check_limits_judge(&scenario, measure, limits), 4);
    const size_t force = baseline_find(measure, "ode/hole/force_max_N", 0);
    const size_t impacts = baseline_find(measure, "ode/hole/impacts", 0);
    const size_t residual = baseline_find(measure, "ode/energy/residual_J", 0);
    assert_true(limits[0].value == measure->metrics[force].value);
    assert_true(limits[1].value == measure->metrics[impacts].value);
    assert_true(limits[2].value == measure->metrics[residual].value);
    // without a truth there is no error to measure, and that never passes
    assert_int_equal(limits[3].verdict, CHECK_GONE);
    assert_string_equal(limits[3].name, "ode.error.omega_max");
    free(limits);
    check_measure_finish(measure);
    free(measure);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(ends_belong_to_between_and_within_alone),
        cmocka_unit_test(off_is_signed_and_never_0_outside),
        cmocka_unit_test(a_limit_is_of_the_backends_that_feel_the_play),
        cmocka_unit_test(numbers_are_those_of_the_run),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
