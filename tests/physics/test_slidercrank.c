// Do the reference and ODE give a slider-crank with ideal joints the motion and the forces of the
// closed form?
#include "kept.h"
#include "mechanism.h"
#include "ode_error.h"

#include <string.h>

// The largest difference of a joint's force from the closed form's at the samples, over the largest
// force; of the guide's couple likewise, over that force times the crank.
static double force_error(const Trajectory *run, const Trajectory *truth, size_t joint)
{
    double worst = 0.0;
    double scale = 0.0;
    for (size_t k = 0; k < truth->sample_count; k++) {
        const JointState *state = trajectory_state(run, k, joint);
        const JointState *exact = trajectory_state(truth, k, joint);
        scale = fmax(scale, exact->force);
        worst = fmax(worst, vec2_length(vec2_sub(state->force_on_b, exact->force_on_b)));
        worst = fmax(worst, fabs(state->moment_on_b - exact->moment_on_b) / 0.05);
    }
    return worst / scale;
}

static Scenario oblique(void)
{
    Scenario scenario = mechanism_slidercrank(0.02, 0.4, SLIDER_LEFT);
    scenario.run.revolutions = 1.0;
    scenario.run.samples = 360;
    return scenario;
}

static void the_reference_agrees_with_the_closed_form_to_rounding(void **state)
{
    (void)state;
    const Scenario scenario = oblique();
    Trajectory *truth = complete_run(&scenario, BACKEND_ANALYTIC);
    Trajectory *reference = complete_run(&scenario, BACKEND_REFERENCE);
    const TrajectoryError error = error_against(reference, truth, INFINITY);
    assert_true(error.is_known && error.max <= 1e-12);
    for (size_t joint = 1; joint < 4; joint++) {
        assert_true(force_error(reference, truth, joint) <= 1e-10);
    }
    // where the slider is on its line
    for (size_t k = 0; k < truth->sample_count; k++) {
        assert_near(trajectory_state(reference, k, 3)->eccentricity.x,
                    trajectory_state(truth, k, 3)->eccentricity.x, 1e-14);
    }
    // the control: a slider a thousandth heavier is pushed by other forces
    Scenario heavier = kept_copy(&scenario);
    heavier.linkage.bodies[2].mass *= 1.001;
    Trajectory *other = complete_run(&heavier, BACKEND_REFERENCE);
    for (size_t joint = 1; joint < 4; joint++) {
        assert_true(force_error(other, truth, joint) > 1e-5);
    }
    trajectory_destroy(other);
    trajectory_destroy(reference);
    trajectory_destroy(truth);
}

static void the_error_of_staggered_stepping_falls_with_the_square_of_the_step(void **state)
{
    (void)state;
    Scenario scenario = oblique();
    scenario.ode.stepping = ODE_STAGGERED;
    scenario.ode.map = ODE_MAP_MIDPOINT;
    const double steps[] = {2e-5, 1e-5, 5e-6};
    for (size_t i = 0; i + 1 < sizeof steps / sizeof *steps; i++) {
        const double coarse = ode_error_at(scenario, BACKEND_ANALYTIC, steps[i]).max;
        const double fine = ode_error_at(scenario, BACKEND_ANALYTIC, steps[i + 1]).max;
        assert_near(ode_order(coarse, fine, 2.0), 2.0, 0.1);
    }
    // the control: plain stepping is of the first order
    scenario.ode.stepping = ODE_PLAIN;
    const double coarse = ode_error_at(scenario, BACKEND_ANALYTIC, 2e-5).max;
    const double fine = ode_error_at(scenario, BACKEND_ANALYTIC, 1e-5).max;
    assert_near(ode_order(coarse, fine, 2.0), 1.0, 0.1);
}

// Staggered stepping gives the forces of mid-step: half a step late, at speed times half the step.
static void odes_forces_are_those_of_the_closed_form_half_a_step_late(void **state)
{
    (void)state;
    Scenario scenario = oblique();
    scenario.ode.stepping = ODE_STAGGERED;
    Trajectory *truth = complete_run(&scenario, BACKEND_ANALYTIC);
    double coarse[4];
    const double steps[] = {4e-6, 2e-6};
    for (size_t i = 0; i < 2; i++) {
        scenario.run.step = steps[i];
        Trajectory *ode = complete_run(&scenario, BACKEND_ODE);
        for (size_t joint = 1; joint < 4; joint++) {
            const double error = force_error(ode, truth, joint);
            // the guide's force changes fastest: some four times itself in a radian
            assert_true(error <= 4.0 * scenario.linkage.driver.speed * 0.5 * steps[i]);
            if (i > 0) {
                assert_near(ode_order(coarse[joint], error, 2.0), 1.0, 0.05);
            }
            coarse[joint] = error;
        }
        trajectory_destroy(ode);
    }
    trajectory_destroy(truth);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_reference_agrees_with_the_closed_form_to_rounding),
        cmocka_unit_test(the_error_of_staggered_stepping_falls_with_the_square_of_the_step),
        cmocka_unit_test(odes_forces_are_those_of_the_closed_form_half_a_step_late),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
