// With ideal joints, is ODE's motion the closed form's, and does its error go with the step?
#include "mechanism.h"
#include "ode_error.h"

static void extremes_at_ten_microseconds_are_the_closed_forms(void **state)
{
    (void)state;
    Scenario scenario = mechanism_paper();
    scenario.run.step = 1e-5;
    Trajectory *ode = complete_run(&scenario, BACKEND_ODE);
    Trajectory *analytic = complete_run(&scenario, BACKEND_ANALYTIC);
    for (size_t i = 1; i < 3; i++) {
        const BodyExtremes *now = &ode->bodies[i];
        const BodyExtremes *truth = &analytic->bodies[i];
        assert_close(now->omega_max.value, truth->omega_max.value, 1e-4);
        assert_close(now->omega_min.value, truth->omega_min.value, 1e-4);
        assert_close(now->alpha_max.value, truth->alpha_max.value, 1e-3);
        assert_close(now->alpha_min.value, truth->alpha_min.value, 1e-3);
        // read at the end of the step, half a step late: 5 us are 0.03 deg of the crank
        assert_near(now->omega_max.crank_rad, truth->omega_max.crank_rad, 2e-3);
    }
    trajectory_destroy(ode);
    trajectory_destroy(analytic);
}

static void the_error_falls_in_proportion_to_the_step(void **state)
{
    (void)state;
    Scenario scenario = mechanism_paper();
    const double steps[] = {1e-4, 3e-5, 1e-5, 3e-6, 1e-6};
    for (size_t i = 0; i + 1 < sizeof steps / sizeof *steps; i++) {
        const double coarse = ode_error_at(scenario, BACKEND_ANALYTIC, steps[i]).max;
        const double fine = ode_error_at(scenario, BACKEND_ANALYTIC, steps[i + 1]).max;
        const double order = ode_order(coarse, fine, steps[i] / steps[i + 1]);
        // the second-order term is 2 % of the first at 1e-4 s
        assert_near(order, 1.0, 0.03);
    }
}

// The error of plain stepping is the half step by which it reads late: h/2 |alpha| over |omega|.
static void the_error_is_the_half_step_that_plain_reading_is_late(void **state)
{
    (void)state;
    Scenario scenario = mechanism_paper();
    const double predicted = 0.5e-5 * 12485.5 / 80.5551;
    assert_close(ode_error_at(scenario, BACKEND_ANALYTIC, 1e-5).max, predicted, 0.01);
}

// The control: without the steps before time zero the joint rows lag at the start.
static void without_settling_the_accelerations_start_wrong_at_any_step(void **state)
{
    (void)state;
    Scenario scenario = mechanism_paper();
    const double settled = ode_error_at(scenario, BACKEND_ANALYTIC, 1e-6).alpha_max;
    scenario.ode.settle_steps = 0;
    assert_true(ode_error_at(scenario, BACKEND_ANALYTIC, 1e-5).alpha_max > 0.05);
    assert_true(ode_error_at(scenario, BACKEND_ANALYTIC, 1e-6).alpha_max > 0.05);
    assert_true(settled < 1e-3);
}

static void joint_forces_are_those_of_inverse_dynamics(void **state)
{
    (void)state;
    Scenario scenario = mechanism_paper();
    scenario.run.step = 1e-6;
    Trajectory *ode = complete_run(&scenario, BACKEND_ODE);
    Trajectory *analytic = complete_run(&scenario, BACKEND_ANALYTIC);
    for (size_t joint = 1; joint < 4; joint++) {
        const double scale = analytic->joints[joint].force_max.value;
        assert_close(ode->joints[joint].force_max.value, scale, 1e-4);
        for (size_t k = 0; k < ode->sample_count; k++) {
            // first order in the step, as the accelerations are
            assert_near(trajectory_state(ode, k, joint)->force,
                        trajectory_state(analytic, k, joint)->force, 5e-4 * scale);
        }
    }
    trajectory_destroy(ode);
    trajectory_destroy(analytic);
}

static void a_fourbar_takes_nine_rows_and_never_leaves_the_plane(void **state)
{
    (void)state;
    Scenario scenario = mechanism_paper();
    scenario.run.step = 1e-4;
    Trajectory *ode = complete_run(&scenario, BACKEND_ODE);
    assert_int_equal(ode->constraint_rows, 9);
    assert_int_equal(ode->contact_rows, 0);
    trajectory_destroy(ode);
}

// Turned the other way the ideal mechanism passes the same places: omega changes sign.
static void the_other_direction_mirrors_the_speeds(void **state)
{
    (void)state;
    Scenario scenario = mechanism_paper();
    scenario.linkage.driver.speed *= -1.0;
    for (size_t i = 0; i < 3; i++) {
        scenario.linkage.bodies[i].start.omega *= -1.0;
        scenario.linkage.bodies[i].start.velocity =
            vec2_scale(-1.0, scenario.linkage.bodies[i].start.velocity);
    }
    scenario.run.step = 1e-5;
    Trajectory *ode = complete_run(&scenario, BACKEND_ODE);
    assert_close(ode->bodies[1].omega_max.value, 78.6973, 1e-4);
    assert_close(ode->bodies[2].alpha_max.value, 12485.5, 1e-3);
    trajectory_destroy(ode);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(extremes_at_ten_microseconds_are_the_closed_forms),
        cmocka_unit_test(the_error_falls_in_proportion_to_the_step),
        cmocka_unit_test(the_error_is_the_half_step_that_plain_reading_is_late),
        cmocka_unit_test(without_settling_the_accelerations_start_wrong_at_any_step),
        cmocka_unit_test(joint_forces_are_those_of_inverse_dynamics),
        cmocka_unit_test(a_fourbar_takes_nine_rows_and_never_leaves_the_plane),
        cmocka_unit_test(the_other_direction_mirrors_the_speeds),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
