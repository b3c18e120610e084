// Does a study keep the numbers of a run, under the names that its JSON output has?
#include "commands/study/metrics.h"

#include "complete_run.h"
#include "mechanism.h"
#include "study_file.h"

static size_t column(const Layout *layout, const char *name)
{
    for (size_t i = 0; i < layout->result_count; i++) {
        if (strcmp(layout->results[i].name, name) == 0) {
            return i;
        }
    }
    fail_msg("no column %s", name);
    return 0;
}

static Spec one_key(bool has_truth)
{
    Spec spec = {.has_truth = has_truth, .variable_count = 3};
    spec.variables[0] = (Variable){.key = "drive.speed", .column_unit = "rad/s"};
    spec.variables[1] = (Variable){.key = "scheme", .is_word = true};
    spec.variables[2] = (Variable){.key = "contact.stiffness", .column_unit = "N/m^1.5"};
    return spec;
}

static void columns_have_names_with_units(void **state)
{
    (void)state;
    const Spec spec = one_key(true);
    const Scenario scenario = mechanism_loose(1);
    Layout layout;
    metrics_layout(&spec, &scenario, &layout);
    assert_int_equal(layout.setting_count, 3);
    assert_string_equal(layout.settings[0].name, "drive_speed_rad_s");
    assert_int_equal(layout.settings[0].kind, COLUMN_REAL);
    assert_string_equal(layout.settings[1].name, "scheme");
    assert_int_equal(layout.settings[1].kind, COLUMN_WORD);
    assert_string_equal(layout.settings[2].name, "contact_stiffness_N_m1_5");
    assert_int_equal(layout.results[column(&layout, "crank_coupler_impacts")].kind, COLUMN_WHOLE);
    column(&layout, "follower_omega_max_rad_s");
    column(&layout, "coupler_alpha_min_rad_s2");
    column(&layout, "error_max_in_horizon");
    // the crank is driven, the other joints are ideal
    for (size_t i = 0; i < layout.result_count; i++) {
        assert_true(strncmp(layout.results[i].name, "crank_omega", 11) != 0);
        assert_true(strncmp(layout.results[i].name, "coupler_follower", 16) != 0);
    }
    const Spec bare = one_key(false);
    Layout short_one;
    metrics_layout(&bare, &scenario, &short_one);
    assert_int_equal(short_one.result_count + 14, layout.result_count);
}

// A row has room for a number of bodies; more are refused and not cut.
static void too_many_bodies_are_refused(void **state)
{
    (void)state;
    Scenario scenario = scenario_default();
    Err err = {ERR_NONE, ""};
    scenario.linkage = mechanism_chain(60, 0.1, 1.0);
    assert_true(metrics_fit(&scenario, &err));
    linkage_free(&scenario.linkage);
    scenario.linkage = mechanism_chain(100, 0.1, 1.0);
    assert_false(metrics_fit(&scenario, &err));
    assert_int_equal(err.kind, ERR_CASE);
    assert_non_null(strstr(err.text, "100 bodies"));
    linkage_free(&scenario.linkage);
}

static void names_that_become_one_are_numbered(void **state)
{
    (void)state;
    const Spec spec = one_key(false);
    Scenario scenario = mechanism_loose(1);
    strcpy(scenario.linkage.bodies[1].name, "arm-a");
    strcpy(scenario.linkage.bodies[2].name, "Arm_A");
    Layout layout;
    metrics_layout(&spec, &scenario, &layout);
    column(&layout, "arm_a_omega_max_rad_s");
    column(&layout, "Arm_A_omega_max_rad_s_2");
}

static void results_are_those_of_the_trajectory(void **state)
{
    (void)state;
    const Spec spec = one_key(true);
    const Scenario scenario = mechanism_loose(1);
    Layout layout;
    metrics_layout(&spec, &scenario, &layout);
    Trajectory *run = complete_run(&scenario, BACKEND_ODE);
    Trajectory *exact = complete_run(&scenario, BACKEND_REFERENCE);
    const Truth truth = {.trajectory = exact, .uncertainty = 1e-9, .horizon_s = 0.01};
    double results[RECORD_RESULT_MAX];
    metrics_take(&layout, &scenario, run, &truth, results);

    const JointExtremes *joint = &run->joints[1];
    const TrajectoryError error = error_against(run, exact, 0.01);
    assert_true(results[column(&layout, "follower_omega_min_rad_s")] ==
                run->bodies[2].omega_min.value);
    assert_true(results[column(&layout, "coupler_alpha_max_rad_s2")] ==
                run->bodies[1].alpha_max.value);
    assert_true(joint->impacts > 0);
    assert_true(results[column(&layout, "crank_coupler_impacts")] == (double)joint->impacts);
    assert_true(results[column(&layout, "impacts")] == (double)joint->impacts);
    assert_true(results[column(&layout, "crank_coupler_force_max_N")] == joint->force_max.value);
    assert_true(results[column(&layout, "crank_coupler_contact_fraction")] ==
                joint->contact_time / run->duration_s);
    assert_true(results[column(&layout, "steps")] == (double)run->steps);
    assert_true(results[column(&layout, "energy_residual_J")] == run->energy.residual);
    assert_true(results[column(&layout, "error_max")] == error.max);
    assert_true(results[column(&layout, "error_horizon_s")] == 0.01);
    assert_true(results[column(&layout, "error_reference_uncertainty")] == 1e-9);
    double peak = 0.0;
    for (size_t i = 1; i < 3; i++) {
        peak = fmax(peak, fmax(run->bodies[i].alpha_max.value, -run->bodies[i].alpha_min.value));
    }
    assert_true(results[column(&layout, "alpha_peak_rad_s2")] == peak);
    // behind the last column nothing is left over
    assert_true(isnan(results[layout.result_count]));
    trajectory_destroy(run);
    trajectory_destroy(exact);
}

// Of the whole settled motion, whatever the run itself had; the control is the run's own force.
static void settled_forces_are_those_of_the_motion(void **state)
{
    (void)state;
    const Spec spec = one_key(false);
    Scenario scenario = mechanism_loose(1);
    Trajectory *run = complete_run(&scenario, BACKEND_REFERENCE);
    scenario.run.start = START_SETTLED;
    Layout layout;
    metrics_layout(&spec, &scenario, &layout);
    SettledJoint joints[8] = {{.force = {.headline = 0.0}}};
    joints[1].force = (SettledNumber){
        .headline = 5.0, .low = 4.0, .high = INFINITY, .median = 3.0, .largest = 7.0};
    SettledNumber alpha[8] = {{.headline = 0.0}};
    alpha[1] = (SettledNumber){.headline = 50.0, .median = 30.0, .largest = 70.0};
    SettledMotion motion = {.starts = 1, .watched = 200, .joints = joints, .alpha = alpha};
    scenario.settled.motions = &motion;
    scenario.settled.motion_count = 1;
    double results[RECORD_RESULT_MAX];
    metrics_take(&layout, &scenario, run, NULL, results);
    assert_true(results[column(&layout, "crank_coupler_settled_force_N")] == 5.0);
    assert_true(results[column(&layout, "crank_coupler_settled_force_low_N")] == 4.0);
    // no revolution bounds it
    assert_true(isnan(results[column(&layout, "crank_coupler_settled_force_high_N")]));
    assert_true(results[column(&layout, "crank_coupler_settled_force_median_N")] == 3.0);
    assert_true(results[column(&layout, "crank_coupler_settled_force_largest_N")] == 7.0);
    assert_true(results[column(&layout, "settled_watched")] == 200.0);
    assert_true(results[column(&layout, "coupler_settled_alpha_size_max_rad_s2")] == 50.0);
    assert_true(results[column(&layout, "coupler_settled_alpha_size_median_rad_s2")] == 30.0);
    assert_true(results[column(&layout, "coupler_settled_alpha_size_largest_rad_s2")] == 70.0);
    assert_true(results[column(&layout, "crank_coupler_force_max_N")] ==
                run->joints[1].force_max.value);
    assert_true(run->joints[1].force_max.value != 5.0);
    // each has a title, and whose it is
    const char *title;
    const char *key;
    size_t owner;
    assert_true(metrics_title("crank_coupler_settled_force_low_N", &title, &key, &owner));
    assert_int_equal(owner, strlen("crank_coupler"));
    assert_string_equal(key, "settled_force_low_N");
    scenario.settled = (SettledStart){.motion_count = 0};
    trajectory_destroy(run);
}

static void without_a_truth_there_is_no_error(void **state)
{
    (void)state;
    const Spec spec = one_key(true);
    const Scenario scenario = mechanism_loose(1);
    Layout layout;
    metrics_layout(&spec, &scenario, &layout);
    Trajectory *run = complete_run(&scenario, BACKEND_REFERENCE);
    double results[RECORD_RESULT_MAX];
    metrics_take(&layout, &scenario, run, NULL, results);
    assert_true(isnan(results[column(&layout, "error_max")]));
    assert_true(isnan(results[column(&layout, "error_horizon_s")]));
    // a truth that is not certified gives errors, and no horizon to trust
    Truth open = {.trajectory = run, .horizon_s = 0.01};
    strcpy(open.message, "its two runs differ");
    metrics_take(&layout, &scenario, run, &open, results);
    assert_true(results[column(&layout, "error_max")] == 0.0);
    assert_true(isnan(results[column(&layout, "error_horizon_s")]));
    // the reference has no step of its own
    assert_true(isnan(results[column(&layout, "step_s")]));
    trajectory_destroy(run);
}

static void what_was_not_felt_is_no_number(void **state)
{
    (void)state;
    const Spec spec = one_key(false);
    const Scenario scenario = mechanism_loose(1);
    Layout layout;
    metrics_layout(&spec, &scenario, &layout);
    // the closed form takes every joint as ideal
    Trajectory *run = complete_run(&scenario, BACKEND_ANALYTIC);
    double results[RECORD_RESULT_MAX];
    run->energy.residual = INFINITY;
    metrics_take(&layout, &scenario, run, NULL, results);
    assert_true(isnan(results[column(&layout, "crank_coupler_impacts")]));
    assert_true(isnan(results[column(&layout, "impacts")]));
    assert_true(isnan(results[column(&layout, "crank_coupler_penetration_max_m")]));
    assert_true(isnan(results[column(&layout, "energy_residual_J")]));
    assert_true(isfinite(results[column(&layout, "crank_coupler_force_max_N")]));
    trajectory_destroy(run);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(columns_have_names_with_units),
        cmocka_unit_test(too_many_bodies_are_refused),
        cmocka_unit_test(names_that_become_one_are_numbered),
        cmocka_unit_test(results_are_those_of_the_trajectory),
        cmocka_unit_test(settled_forces_are_those_of_the_motion),
        cmocka_unit_test(without_a_truth_there_is_no_error),
        cmocka_unit_test(what_was_not_felt_is_no_number),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
