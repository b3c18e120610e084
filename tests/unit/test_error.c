// Is the distance between two trajectories what its definition says?
#include "close.h"

#include "mechanism.h"
#include "slider.h"

#include "measure/error.h"

#include <string.h>

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

static void the_largest_relative_error_of_any_rate_counts(void **state)
{
    (void)state;
    Scenario scenario = mechanism_paper();
    scenario.run.samples = 20;
    Trajectory *truth = made(&scenario, 0.0, 0.0);
    Trajectory *other = made(&scenario, 0.3, 0.001);
    const TrajectoryError error = error_against(other, truth, INFINITY);
    assert_true(error.is_known);
    assert_string_equal(error.against, "made");
    // the coupler, whose scale is 10
    assert_near(error.max, 0.03, 1e-15);
    assert_near(error.max_time_s, scenario_sample_time(&scenario, 7), 1e-18);
    assert_string_equal(error.in, "omega of coupler");
    assert_false(error.is_floor);
    assert_near(error.omega_max, 0.03, 1e-15);
    // the crank is driven and has no part in the mean
    assert_near(error.omega_rms, sqrt((0.03 * 0.03 + 0.003 * 0.003) / 42.0), 1e-15);
    assert_near(error.angle_max_rad, 0.02, 1e-15);
    assert_near(error.alpha_max, 0.0, 0.0);
    assert_near(trajectory_omega_scale(truth, 1), 10.0, 0.0);
    // before the sample that is off, and where the horizon ends before the first sample
    const double before_s = 0.5 * (truth->times[6] + truth->times[7]);
    assert_near(error_against(other, truth, before_s).max_in_horizon, 0.0, 0.0);
    assert_true(isnan(error_against(other, truth, 0.5 * truth->times[1]).max_in_horizon));
    trajectory_destroy(truth);
    trajectory_destroy(other);
}

// A slider that moves at 5 m/s in guides of the ground, off by some, and turns by some.
static Trajectory *made_sliding(const Scenario *scenario, Vec2 off, double turning)
{
    Trajectory *trajectory = made(scenario, 0.0, 0.0);
    for (size_t k = 0; k < trajectory->sample_count; k++) {
        Sample sample = sample_create(&scenario->linkage);
        sample.time_s = scenario_sample_time(scenario, k);
        sample.bodies[1].omega = 10.0;
        sample.bodies[2].velocity = vec2_add((Vec2){5.0, 0.0}, off);
        sample.bodies[2].omega = turning;
        trajectory_store(trajectory, k, &sample);
        sample_free(&sample);
    }
    return trajectory;
}

static Scenario sliding(void)
{
    Scenario scenario = slider_driven(&SLIDER_USUAL, 100.0);
    scenario.run.revolutions = 1.0;
    scenario.run.samples = 20;
    slider_loosen_guide(&scenario, 0.061, 0.06, 0.08);
    return scenario;
}

static void a_velocity_counts_as_a_vector_and_a_tilt_rate_by_itself(void **state)
{
    (void)state;
    Scenario scenario = sliding();
    Trajectory *truth = made_sliding(&scenario, (Vec2){0.0, 0.0}, 0.1);
    Trajectory *faster = made_sliding(&scenario, (Vec2){0.03, 0.04}, 0.1);
    Trajectory *turning = made_sliding(&scenario, (Vec2){0.0, 0.0}, 0.102);
    const TrajectoryError of_velocity = error_against(faster, truth, INFINITY);
    assert_near(of_velocity.max, 0.05 / 5.0, 1e-15);
    assert_string_equal(of_velocity.in, "velocity of slider");
    assert_near(of_velocity.omega_max, 0.0, 0.0);
    // 2 % of its own rate, though a point of it moves hardly faster for it
    const TrajectoryError of_tilt = error_against(turning, truth, INFINITY);
    assert_near(of_tilt.max, 0.02, 1e-13);
    assert_string_equal(of_tilt.in, "omega of slider");
    trajectory_destroy(truth);
    trajectory_destroy(faster);
    trajectory_destroy(turning);
}

// What hardly moves is measured by a millionth of the fastest point's speed, over the reach.
static void a_rate_that_is_nothing_has_a_floor(void **state)
{
    (void)state;
    Scenario scenario = sliding();
    Trajectory *truth = made_sliding(&scenario, (Vec2){0.0, 0.0}, 0.0);
    Trajectory *turning = made_sliding(&scenario, (Vec2){0.0, 0.0}, 1e-6);
    double fastest = 0.0;
    for (size_t i = 0; i < 3; i++) {
        const Motion *motion = trajectory_motion(truth, 0, i);
        const double speed = vec2_length(motion->velocity) +
                             fabs(motion->omega) * linkage_reach(&scenario.linkage, (int)i);
        fastest = fmax(fastest, speed);
    }
    const TrajectoryError error = error_against(turning, truth, INFINITY);
    // half a diagonal of the block
    assert_near(linkage_reach(&scenario.linkage, 2), 0.05, 1e-17);
    assert_close(error.max, 1e-6 / (1e-6 * fastest / 0.05), 1e-12);
    assert_true(error.is_floor);
    trajectory_destroy(truth);
    trajectory_destroy(turning);
}

// The pin's own velocity in its hole is small beside those of the bodies, and so is its scale.
static void a_pin_is_measured_in_its_hole(void **state)
{
    (void)state;
    Scenario scenario = mechanism_loose(1);
    scenario.run.samples = 20;
    const Joint *joint = &scenario.linkage.joints[1];
    DistanceMeasure rates = distance_rates(&scenario.linkage);
    assert_int_equal(rates.count, 7);
    assert_int_equal(rates.rates[6].kind, DISTANCE_PLAY);
    Motion motions[3];
    linkage_start(&scenario.linkage, motions);
    const DistanceMotion motion = {motions, NULL};
    // at the start it goes with its hole, as the ideal joint does
    assert_near(distance_value(&scenario.linkage, &rates.rates[6], motion).x, 0.0, 1e-12);
    motions[joint->body_b].velocity.y += 0.25;
    assert_near(distance_value(&scenario.linkage, &rates.rates[6], motion).y, 0.25, 1e-12);
    char name[DISTANCE_NAME_SIZE];
    distance_name(&scenario.linkage, &rates.rates[6], name);
    assert_string_equal(name, "pin velocity in crank-coupler");
    distance_finish(&rates);
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

// A run of the paper's mechanism with play, whose pin is pushed with 100 N but for one sample.
static Trajectory *made_pushed(const Scenario *scenario, double force, const Spike *spikes,
                               size_t count)
{
    Trajectory *trajectory = made(scenario, 0.0, 0.0);
    for (size_t k = 0; k < trajectory->sample_count; k++) {
        trajectory->states[k * trajectory->joint_count + 1].force = k == 7 ? force : 100.0;
    }
    JointExtremes *joint = &trajectory->joints[1];
    joint->force_max.value = 400.0;
    joint->spike_count = count;
    for (size_t i = 0; i < count; i++) {
        joint->spikes[i] = spikes[i];
    }
    return trajectory;
}

static JointError force_error(const Spike *run, size_t run_count, const Spike *truth,
                              size_t truth_count, double horizon_s)
{
    Scenario scenario = mechanism_loose(1);
    scenario.run.samples = 20;
    scenario.run.revolutions = 1.0;
    Trajectory *reference = made_pushed(&scenario, 100.0, truth, truth_count);
    Trajectory *other = made_pushed(&scenario, 97.0, run, run_count);
    assert_true(error_has_forces(other, reference, 1));
    assert_false(error_has_forces(other, reference, 0));
    const JointError error = error_of_joint(other, reference, 1, horizon_s);
    trajectory_destroy(reference);
    trajectory_destroy(other);
    return error;
}

static void a_force_is_off_by_a_share_of_the_joints_largest(void **state)
{
    (void)state;
    const JointError error = force_error(NULL, 0, NULL, 0, 0.02);
    assert_near(error.force_max, 0.03, 1e-15);
    // the horizon ends before that sample
    assert_near(error.force_max_in_horizon, 0.0, 0.0);
    assert_near(error.peak_max, 0.0, 0.0);
}

static void contacts_that_overlap_are_compared_and_others_are_off_by_all_they_have(void **state)
{
    (void)state;
    const Spike truth[] = {
        {.onset_s = 10e-3, .duration_s = 10e-3, .force_max = 400.0},
        {.onset_s = 50e-3, .duration_s = 1e-4, .force_max = 40.0},
    };
    // one contact of the reference is two here, and the second stands elsewhere
    const Spike run[] = {
        {.onset_s = 11e-3, .duration_s = 2e-4, .force_max = 396.0},
        {.onset_s = 15e-3, .duration_s = 10e-3, .force_max = 8.0},
        {.onset_s = 60e-3, .duration_s = 1e-4, .force_max = 20.0},
    };
    JointError error = force_error(run, 2, truth, 1, INFINITY);
    assert_near(error.peak_max, 0.01, 1e-15);
    assert_int_equal(error.missed + error.extra, 0);
    error = force_error(run, 3, truth, 2, INFINITY);
    assert_near(error.peak_max, 0.1, 1e-15);
    assert_int_equal(error.missed, 1);
    assert_int_equal(error.extra, 1);
    // up to a horizon before those, and to one in the first contact
    error = force_error(run, 3, truth, 2, 40e-3);
    assert_near(error.peak_max_in_horizon, 0.01, 1e-15);
    assert_near(force_error(run, 3, truth, 2, 20e-3).peak_max_in_horizon, 0.0, 0.0);
}

static void a_contact_that_was_not_kept_is_no_stronger_than_those_that_were(void **state)
{
    (void)state;
    Spike truth[TRAJECTORY_SPIKE_MAX];
    for (size_t i = 0; i < TRAJECTORY_SPIKE_MAX; i++) {
        truth[i] = (Spike){
            .onset_s = 1e-4 * (double)i, .duration_s = 1e-5, .force_max = 400.0 - 10.0 * (double)i};
    }
    Spike run[TRAJECTORY_SPIKE_MAX];
    memcpy(run, truth, sizeof run);
    // one that the reference may have had, too, as the thirteenth
    run[TRAJECTORY_SPIKE_MAX - 1].onset_s = 50e-4;
    JointError error =
        force_error(run, TRAJECTORY_SPIKE_MAX, truth, TRAJECTORY_SPIKE_MAX, INFINITY);
    assert_near(error.peak_max, 0.0, 0.0);
    // and one that it cannot have had
    run[TRAJECTORY_SPIKE_MAX - 1].force_max = 330.0;
    error = force_error(run, TRAJECTORY_SPIKE_MAX, truth, TRAJECTORY_SPIKE_MAX, INFINITY);
    assert_near(error.peak_max, 0.1, 1e-15);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_largest_relative_error_of_any_rate_counts),
        cmocka_unit_test(a_velocity_counts_as_a_vector_and_a_tilt_rate_by_itself),
        cmocka_unit_test(a_rate_that_is_nothing_has_a_floor),
        cmocka_unit_test(a_pin_is_measured_in_its_hole),
        cmocka_unit_test(a_failed_run_has_no_error),
        cmocka_unit_test(a_number_that_is_not_finite_is_no_small_error),
        cmocka_unit_test(a_force_is_off_by_a_share_of_the_joints_largest),
        cmocka_unit_test(contacts_that_overlap_are_compared_and_others_are_off_by_all_they_have),
        cmocka_unit_test(a_contact_that_was_not_kept_is_no_stronger_than_those_that_were),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
