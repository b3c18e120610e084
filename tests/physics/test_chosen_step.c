// Does a step chosen for an error give that error, on joints with and without play?
//
// Outside truths: the reference, and the closed form with ideal joints. A run may be better than
// asked, but not by so much that its steps are wasted.
#include "mechanism.h"
#include "ode_error.h"

#include "compare/truth.h"

#include <string.h>

// what is asked may be missed by this factor: an estimate from differences is no bound
static const double MISSED = 1.5;
// and beaten by this one: steps fall in powers of two until the last, which is fitted
static const double WASTED = 15.0;

static Scenario loose(double tolerance, size_t joints)
{
    Scenario scenario = mechanism_loose(joints);
    scenario.run.tolerance = tolerance;
    return scenario;
}

static double delivered(const Scenario *scenario, BackendKind truth)
{
    return ode_error_at(*scenario, truth, 0.0).omega_max;
}

static void assert_delivers(const Scenario *scenario, BackendKind truth)
{
    const double asked = scenario->run.tolerance;
    const double error = delivered(scenario, truth);
    if (!(error <= MISSED * asked && error >= asked / WASTED)) {
        fail_msg("asked %g, delivered %g", asked, error);
    }
}

static void the_error_asked_for_is_delivered_with_play(void **state)
{
    (void)state;
    for (size_t joints = 1; joints <= 3; joints++) {
        const Scenario coarse = loose(1e-3, joints);
        const Scenario fine = loose(1e-5, joints);
        assert_delivers(&coarse, BACKEND_REFERENCE);
        assert_delivers(&fine, BACKEND_REFERENCE);
    }
}

static void the_speed_of_the_drive_makes_no_difference(void **state)
{
    (void)state;
    Scenario scenario = loose(1e-4, 1);
    scenario.linkage.driver.speed *= 1.5;
    for (size_t i = 0; i < scenario.linkage.body_count; i++) {
        Motion *start = &scenario.linkage.bodies[i].start;
        start->velocity = vec2_scale(1.5, start->velocity);
        start->omega *= 1.5;
    }
    assert_delivers(&scenario, BACKEND_REFERENCE);
}

static void the_error_asked_for_is_delivered_with_ideal_joints(void **state)
{
    (void)state;
    Scenario scenario = mechanism_paper();
    scenario.run.tolerance = 1e-6;
    assert_delivers(&scenario, BACKEND_ANALYTIC);
    scenario.run.tolerance = 1e-8;
    assert_delivers(&scenario, BACKEND_ANALYTIC);
}

// The control: what is good enough for one error is not for a hundredth of it.
static void a_step_for_a_coarse_error_is_too_coarse_for_a_fine_one(void **state)
{
    (void)state;
    const Scenario scenario = loose(1e-3, 1);
    assert_true(delivered(&scenario, BACKEND_REFERENCE) > MISSED * 1e-5);
}

// Half a millimetre of play: a start 1e-10 beside this one is 1e5 times further away before the
// end, and the error is that up to there.
static void where_motion_cannot_be_predicted_the_error_holds_up_to_there(void **state)
{
    (void)state;
    Scenario scenario = loose(1e-3, 1);
    Joint *joint = &scenario.linkage.joints[1];
    joint->clearance.hole_radius = joint->clearance.pin_radius + 0.5e-3;
    scenario.run.revolutions = 0.5;
    Truth truth = truth_make(&scenario, (RunWatch){NULL, NULL});
    assert_true(truth.is_limited);
    scenario.run.step = 0.0;
    Trajectory *run = complete_run(&scenario, BACKEND_ODE);
    const TrajectoryError error = error_against(run, truth.trajectory, truth.horizon_s);
    assert_true(error.omega_max_in_horizon <= 2.0 * MISSED * 1e-3);
    assert_true(error.omega_max > 1e-3);
    assert_true(run->estimate_s < scenario_duration(&scenario));
    trajectory_destroy(run);
    truth_finish(&truth);
}

static void what_it_expects_and_what_it_cost_are_told(void **state)
{
    (void)state;
    Scenario scenario = loose(1e-4, 1);
    scenario.run.step = 0.0;
    Trajectory *run = complete_run(&scenario, BACKEND_ODE);
    assert_true(run->error_estimate > 0.0 && run->error_estimate <= 1e-4);
    assert_near(run->estimate_s, scenario_duration(&scenario), 1e-12);
    // the steps of the trials are counted with those of the run
    assert_true((double)run->steps > 1.5 * scenario_duration(&scenario) / run->step_s);
    assert_non_null(strstr(run->label, "error 0.0001 wanted"));
    trajectory_destroy(run);
}

static void count_beat(double share, double wall_s, void *context)
{
    (void)wall_s;
    *(size_t *)context += share == 0.0 ? 1 : 0;
}

static void trials_show_that_they_are_under_way(void **state)
{
    (void)state;
    Scenario scenario = loose(1e-3, 1);
    scenario.run.step = 0.0;
    size_t beats = 0;
    Trajectory *run =
        run_scenario(&scenario, registry_solver(BACKEND_ODE), (RunWatch){count_beat, &beats});
    assert_true(run->is_complete);
    // three trials at the least, and a beat at each of their thousand samples and more
    assert_true(beats > 3000);
    trajectory_destroy(run);
}

static void an_error_that_no_step_gives_is_told(void **state)
{
    (void)state;
    Scenario scenario = mechanism_paper();
    scenario.run.step = 0.0;
    scenario.run.tolerance = 1e-14; // rounding shows at 1e-11
    scenario.run.samples = 100;
    Trajectory *run = run_scenario(&scenario, registry_solver(BACKEND_ODE), (RunWatch){NULL, NULL});
    assert_false(run->is_complete);
    assert_non_null(strstr(run->message, "no step gives the tolerance 1e-14"));
    trajectory_destroy(run);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_error_asked_for_is_delivered_with_play),
        cmocka_unit_test(the_speed_of_the_drive_makes_no_difference),
        cmocka_unit_test(the_error_asked_for_is_delivered_with_ideal_joints),
        cmocka_unit_test(a_step_for_a_coarse_error_is_too_coarse_for_a_fine_one),
        cmocka_unit_test(where_motion_cannot_be_predicted_the_error_holds_up_to_there),
        cmocka_unit_test(what_it_expects_and_what_it_cost_are_told),
        cmocka_unit_test(trials_show_that_they_are_under_way),
        cmocka_unit_test(an_error_that_no_step_gives_is_told),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
