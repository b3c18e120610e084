// Does a linkage that makes no sense get past the door?
#include "close.h"

#include "mechanism.h"

#include <stdio.h>
#include <string.h>

static void expect_refused(const Scenario *scenario, const char *words)
{
    Err err = {ERR_NONE, ""};
    assert_false(scenario_check(scenario, &err));
    assert_int_equal(err.kind, ERR_CASE);
    if (strstr(err.text, words) == NULL) {
        fail_msg("'%s' does not say '%s'", err.text, words);
    }
}

static void the_papers_mechanism_passes(void **state)
{
    (void)state;
    const Scenario scenario = mechanism_paper();
    Err err = {ERR_NONE, ""};
    assert_true(scenario_check(&scenario, &err));
}

static void a_step_is_finite_and_not_negative(void **state)
{
    (void)state;
    Scenario scenario = mechanism_paper();
    static const double BAD[] = {-1e-6, INFINITY, NAN};
    for (size_t i = 0; i < sizeof BAD / sizeof BAD[0]; i++) {
        scenario.run.step = BAD[i];
        expect_refused(&scenario, "step");
    }
}

static void bodies_need_mass_inertia_and_a_name_of_their_own(void **state)
{
    (void)state;
    Scenario scenario = mechanism_paper();
    scenario.linkage.bodies[1].mass = 0.0;
    expect_refused(&scenario, "mass");
    scenario = mechanism_paper();
    scenario.linkage.bodies[1].mass = INFINITY;
    expect_refused(&scenario, "mass");
    scenario = mechanism_paper();
    scenario.linkage.bodies[2].inertia = NAN;
    expect_refused(&scenario, "inertia");
    scenario = mechanism_paper();
    snprintf(scenario.linkage.bodies[2].name, LINKAGE_NAME_SIZE, "crank");
    expect_refused(&scenario, "two bodies");
    scenario = mechanism_paper();
    scenario.linkage.body_count = 0;
    expect_refused(&scenario, "bodies");
}

static void joints_join_two_bodies_that_exist(void **state)
{
    (void)state;
    Scenario scenario = mechanism_paper();
    scenario.linkage.joints[1].body_b = 7;
    expect_refused(&scenario, "two different bodies");
    scenario = mechanism_paper();
    scenario.linkage.joints[1].body_b = scenario.linkage.joints[1].body_a;
    expect_refused(&scenario, "two different bodies");
    scenario = mechanism_paper();
    snprintf(scenario.linkage.joints[2].name, LINKAGE_NAME_SIZE, "crank-coupler");
    expect_refused(&scenario, "two joints");
}

static void a_pin_is_smaller_than_its_hole_and_starts_inside_it(void **state)
{
    (void)state;
    Scenario scenario = mechanism_paper();
    mechanism_loosen(&scenario, "crank-coupler");
    assert_near(linkage_radial_clearance(&scenario.linkage.joints[1]), 14.5e-6, 1e-18);
    scenario.linkage.joints[1].clearance.pin_radius = 5.0075e-3;
    expect_refused(&scenario, "smaller than its hole");
    mechanism_loosen(&scenario, "crank-coupler");
    scenario.linkage.joints[1].clearance.start = (Vec2){1e-5, 1.2e-5};
    expect_refused(&scenario, "start eccentricity");
}

static void the_driver_turns_an_ideal_joint_with_the_ground(void **state)
{
    (void)state;
    Scenario scenario = mechanism_paper();
    scenario.linkage.driver.joint = 1;
    expect_refused(&scenario, "ideal joint with the ground");
    scenario = mechanism_paper();
    scenario.linkage.driver.joint = 9;
    expect_refused(&scenario, "does not exist");
    scenario = mechanism_paper();
    scenario.linkage.driver.speed = 0.0;
    expect_refused(&scenario, "speed");
}

static void a_run_has_a_step_and_samples(void **state)
{
    (void)state;
    Scenario scenario = mechanism_paper();
    scenario.run.step = NAN;
    expect_refused(&scenario, "step");
    scenario = mechanism_paper();
    scenario.run.samples = 0;
    expect_refused(&scenario, "no sample");
    scenario = mechanism_paper();
    scenario.gravity = scenario_downward(INFINITY);
    expect_refused(&scenario, "gravity");
    scenario.gravity = (Vec3){NAN, 0.0, 0.0};
    expect_refused(&scenario, "gravity");
    scenario.gravity = (Vec3){0.0, -9.8, 1e-3};
    expect_refused(&scenario, "along z, allowed in the plane: 0");
}

static void samples_stand_at_exact_multiples_of_the_interval(void **state)
{
    (void)state;
    Scenario scenario = mechanism_paper();
    scenario.run.revolutions = 2.5;
    scenario.run.samples = 360;
    assert_int_equal(scenario_sample_count(&scenario), 901);
    assert_near(scenario_duration(&scenario), 0.15, 1e-15);
    assert_near(scenario_sample_time(&scenario, 360), 0.06, 1e-17);
    Scenario pin = mechanism_pin(1.0, 1e-4);
    pin.run.duration = 2.0;
    pin.run.samples = 4;
    assert_int_equal(scenario_sample_count(&pin), 5);
    assert_near(scenario_sample_time(&pin, 3), 1.5, 1e-15);
    assert_near(scenario_duration(&pin), 2.0, 0.0);
    assert_true(scenario_has_clearance(&pin));
    assert_false(scenario_has_clearance(&scenario));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_papers_mechanism_passes),
        cmocka_unit_test(a_step_is_finite_and_not_negative),
        cmocka_unit_test(bodies_need_mass_inertia_and_a_name_of_their_own),
        cmocka_unit_test(joints_join_two_bodies_that_exist),
        cmocka_unit_test(a_pin_is_smaller_than_its_hole_and_starts_inside_it),
        cmocka_unit_test(the_driver_turns_an_ideal_joint_with_the_ground),
        cmocka_unit_test(a_run_has_a_step_and_samples),
        cmocka_unit_test(samples_stand_at_exact_multiples_of_the_interval),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
