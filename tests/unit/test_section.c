// Is the period of a run the one that its motion was made with?
//
// The controls: a motion whose sections drift by more than the tolerance a revolution does not
// repeat, and one of too few revolutions is not said to.
#include "close.h"
#include "made_run.h"
#include "mechanism.h"

#include "measure/section.h"

static Scenario turning(double revolutions)
{
    Scenario scenario = mechanism_paper();
    scenario.run.revolutions = revolutions;
    scenario.run.samples = 36;
    return scenario;
}

static size_t number_of(double turns)
{
    return (size_t)floor(turns + 1e-9);
}

static double of_one(double turns)
{
    return 20.0 + sin(2.0 * M_PI * turns);
}

// Another value at the end of every fifth revolution.
static double of_five(double turns)
{
    return 20.0 + 0.1 * (double)(number_of(turns) % 5);
}

// What differs in the last but one of its revolutions alone: the last two agree, and no more.
static double of_none(double turns)
{
    const double n = (double)number_of(turns);
    return 20.0 + sin(n * n);
}

static double drifting(double turns)
{
    return 20.0 + 0.002 * turns; // of 20: 1e-4 a revolution
}

static double settling(double turns)
{
    return 20.0 + exp2(-20.0 * turns);
}

static Sections sections_of(double revolutions, MadeOmega *omega)
{
    Scenario scenario = turning(revolutions);
    Trajectory *run = made_run(&scenario, omega);
    const Sections sections = section_find(run);
    trajectory_destroy(run);
    scenario_free(&scenario);
    return sections;
}

static void the_period_is_that_of_the_motion(void **state)
{
    (void)state;
    assert_int_equal(sections_of(12.0, of_one).period, 1);
    assert_int_equal(sections_of(12.0, of_five).period, 5);
    assert_int_equal(sections_of(12.0, of_none).period, 0);
    assert_int_equal(sections_of(12.0, settling).period, 1);
    assert_int_equal(sections_of(12.0, drifting).period, 0);
    assert_near(sections_of(12.0, drifting).change, 1e-4, 1e-6);
}

static void too_few_revolutions_say_nothing(void **state)
{
    (void)state;
    const Sections one = sections_of(1.0, of_one);
    assert_int_equal(one.count, 2);
    assert_false(one.is_period_known);
    assert_true(isnan(one.change));
    // five take ten
    assert_int_equal(sections_of(9.0, of_five).period, 0);
    assert_int_equal(sections_of(10.0, of_five).period, 5);
    assert_int_equal(sections_of(0.5, of_one).count, 0);
}

static void sections_are_counted_from_the_end(void **state)
{
    (void)state;
    Scenario scenario = turning(7.0);
    Trajectory *run = made_run(&scenario, of_five);
    assert_near(section_omega(run, 1, 0), 20.2, 1e-12);
    assert_near(section_omega(run, 1, 1), 20.1, 1e-12);
    assert_near(section_omega(run, 1, 6), 20.1, 1e-12);
    assert_true(isnan(section_omega(run, 1, 7)));
    // what is not reported has no sections
    run->report_from_s = 2.5 * linkage_period(&scenario.linkage);
    const Sections late = section_find(run);
    assert_int_equal(late.count, 5);
    assert_int_equal(late.first, 3 * 36);
    trajectory_destroy(run);
    scenario_free(&scenario);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_period_is_that_of_the_motion),
        cmocka_unit_test(too_few_revolutions_say_nothing),
        cmocka_unit_test(sections_are_counted_from_the_end),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
