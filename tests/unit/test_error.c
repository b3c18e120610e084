// Is the distance between two trajectories what its definition says?
#include "close.h"

#include "mechanism.h"
#include "slider.h"

#include "measure/error.h"

// A trajectory whose speeds are sin and cos of the sample, each body scaled.
static Trajectory *made(const Scenario *scenario, double offset, double slip)
{
    Trajectory *trajectory = trajectory_create(scenario, "made");
    for (size_t k = 0; k < trajectory->sample_count; k++) {
        Sample sample = sample_create(&scenario->linkage);
        sample.time_s = scenario_sample_time(scenario, k);
        for (size_t i = 0; i < 3; i++) {
            const double scale = i == 1 ? 10.0 : 100.0;
            sample.bodies[i].omega = scale * (k % 2 == 0 ? 1.0 : -0.5) + (k == 7 ? offset : 0.0);
            sample.bodies[i].alpha = scale;
            sample.bodies[i].angle = slip * (double)k;
        }
        trajectory_store(trajectory, k, &sample);
        sample_free(&sample);
    }
    trajectory->is_complete = true;
    return trajectory;
}

static void the_largest_relative_error_of_any_free_body_counts(void **state)
{
    (void)state;
    Scenario scenario = mechanism_paper();
    scenario.run.samples = 20;
    Trajectory *truth = made(&scenario, 0.0, 0.0);
    Trajectory *other = made(&scenario, 0.3, 0.001);
    const TrajectoryError error = error_against(other, truth, INFINITY);
    assert_true(error.is_known);
    assert_string_equal(error.against, "made");
    // the coupler, whose scale is 10; the crank is driven and does not count
    assert_near(error.omega_max, 0.03, 1e-15);
    assert_near(error.omega_max_time_s, scenario_sample_time(&scenario, 7), 1e-18);
    assert_near(error.omega_rms, sqrt((0.03 * 0.03 + 0.003 * 0.003) / 42.0), 1e-15);
    assert_near(error.angle_max_rad, 0.02, 1e-15);
    assert_near(error.alpha_max, 0.0, 0.0);
    assert_near(trajectory_omega_scale(truth, 1), 10.0, 0.0);
    trajectory_destroy(truth);
    trajectory_destroy(other);
}

// A slider whose velocity is off by some, and whose block turns by some.
static Trajectory *made_sliding(const Scenario *scenario, double faster, double turning)
{
    Trajectory *trajectory = made(scenario, 0.0, 0.0);
    for (size_t k = 0; k < trajectory->sample_count; k++) {
        Sample sample = sample_create(&scenario->linkage);
        sample.time_s = scenario_sample_time(scenario, k);
        sample.bodies[1].omega = 10.0;
        sample.bodies[2].velocity.x = 5.0 + faster;
        sample.bodies[2].omega = turning;
        trajectory_store(trajectory, k, &sample);
        sample_free(&sample);
    }
    return trajectory;
}

// Its omega is 0 whatever its error.
static void a_body_that_slides_is_measured_by_the_speed_of_its_points(void **state)
{
    (void)state;
    Scenario scenario = slider_driven(&SLIDER_USUAL, 100.0);
    scenario.run.revolutions = 1.0;
    scenario.run.samples = 20;
    slider_loosen_guide(&scenario, 0.061, 0.06, 0.08);
    Trajectory *truth = made_sliding(&scenario, 0.0, 0.0);
    Trajectory *faster = made_sliding(&scenario, 0.01, 0.0);
    Trajectory *turning = made_sliding(&scenario, 0.0, 2.0);
    // half a diagonal of the block
    assert_near(linkage_reach(&scenario.linkage, 2), 0.05, 1e-17);
    assert_near(error_against(faster, truth, INFINITY).omega_max, 0.01 / 5.0, 1e-15);
    assert_near(error_against(turning, truth, INFINITY).omega_max, 2.0 * 0.05 / 5.0, 1e-15);
    trajectory_destroy(truth);
    trajectory_destroy(faster);
    trajectory_destroy(turning);
}

static void a_failed_run_has_no_error(void **state)
{
    (void)state;
    const Scenario scenario = mechanism_paper();
    Trajectory *truth = made(&scenario, 0.0, 0.0);
    Trajectory *failed = made(&scenario, 0.0, 0.0);
    failed->is_complete = false;
    assert_false(error_against(failed, truth, INFINITY).is_known);
    assert_false(error_against(truth, failed, INFINITY).is_known);
    trajectory_destroy(truth);
    trajectory_destroy(failed);
    trajectory_destroy(NULL);
}

static void a_number_that_is_not_finite_is_no_small_error(void **state)
{
    (void)state;
    Scenario scenario = mechanism_paper();
    scenario.run.samples = 20;
    Trajectory *truth = made(&scenario, 0.0, 0.0);
    Trajectory *broken = made(&scenario, NAN, 0.0);
    assert_false(error_against(broken, truth, INFINITY).is_known);
    trajectory_destroy(truth);
    trajectory_destroy(broken);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_largest_relative_error_of_any_free_body_counts),
        cmocka_unit_test(a_body_that_slides_is_measured_by_the_speed_of_its_points),
        cmocka_unit_test(a_failed_run_has_no_error),
        cmocka_unit_test(a_number_that_is_not_finite_is_no_small_error),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
