// Does the reference see every contact begin and end, however it comes about, and certify no more
// than it knows?
#include "complete_run.h"

#include "mechanism.h"

#include "measure/error.h"
#include "measure/truth.h"
#include "model/kinematics.h"

#include <stdio.h>
#include <string.h>

static const RunWatch NOBODY = {NULL, NULL};

// A rod let go level about its end: from rest the scale of its speeds must come from gravity.
static void a_pendulum_let_go_at_rest_keeps_its_energy(void **state)
{
    (void)state;
    Scenario scenario = mechanism_pin(0.1, 1e-4);
    Linkage *linkage = &scenario.linkage;
    linkage->bodies[0].inertia = 1e-4;
    linkage->bodies[0].start.position = (Vec2){0.1, 0.0};
    linkage->joints[0].kind = JOINT_REVOLUTE;
    linkage->joints[0].anchor_b = (Vec2){-0.1, 0.0};
    scenario.gravity = scenario_downward(9.80665);
    scenario.run.duration = 2.0;
    scenario.run.samples = 1000;
    Trajectory *trajectory = complete_run(&scenario, BACKEND_REFERENCE);
    // at the lowest point: I w^2 / 2 = m g l, I about the pivot
    const double fastest = sqrt(2.0 * 0.1 * 9.80665 * 0.1 / (1e-4 + 0.1 * 0.1 * 0.1));
    double largest = 0.0;
    for (size_t k = 0; k < trajectory->sample_count; k++) {
        const Motion *motion = trajectory_motion(trajectory, k, 0);
        const double expected =
            sqrt(fmax(0.0, -2.0 * 0.1 * 9.80665 * motion->position.y / (1e-4 + 0.1 * 0.1 * 0.1)));
        largest = fmax(largest, fabs(motion->omega));
        assert_near(motion->omega * motion->omega, expected * expected, 1e-9);
    }
    assert_close(largest, fastest, 1e-3);
    assert_true(fabs(trajectory->energy.residual) < 1e-11);
    trajectory_destroy(trajectory);
}

// A pin thrown upwards a little faster than it needs to touch the top of its hole: in and out again
// within microns, at times and speeds that the parabola gives.
static void a_grazing_touch_between_two_looks_is_seen(void **state)
{
    (void)state;
    const double gravity = 9.80665;
    const double play = 1e-4;
    const double speeds[] = {0.0444, 0.0446, 0.0460, 0.06};
    for (size_t i = 0; i < sizeof speeds / sizeof *speeds; i++) {
        Scenario scenario = mechanism_pin(0.1, play);
        scenario.gravity = scenario_downward(gravity);
        scenario.contact.stiffness = 6.6e10;
        scenario.linkage.bodies[0].start.velocity.y = speeds[i];
        scenario.run.duration = 0.02;
        scenario.run.samples = 10;
        Trajectory *trajectory = complete_run(&scenario, BACKEND_REFERENCE);
        const double arrival = sqrt(speeds[i] * speeds[i] - 2.0 * gravity * play);
        const JointExtremes *joint = &trajectory->joints[0];
        assert_true(joint->impacts > 0);
        double first = INFINITY;
        double speed = 0.0;
        for (size_t k = 0; k < joint->spike_count; k++) {
            if (joint->spikes[k].onset_s < first) {
                first = joint->spikes[k].onset_s;
                speed = joint->spikes[k].approach_speed;
            }
        }
        assert_close(first, (speeds[i] - arrival) / gravity, 1e-9);
        assert_close(speed, arrival, 1e-7);
        trajectory_destroy(trajectory);
    }
}

// The control: slower, and it never gets there.
static void a_pin_too_slow_for_the_wall_does_not_touch_it(void **state)
{
    (void)state;
    Scenario scenario = mechanism_pin(0.1, 1e-4);
    scenario.gravity = scenario_downward(9.80665);
    scenario.contact.stiffness = 6.6e10;
    scenario.linkage.bodies[0].start.velocity.y = 0.0442;
    scenario.run.duration = 8e-3;
    scenario.run.samples = 10;
    Trajectory *trajectory = complete_run(&scenario, BACKEND_REFERENCE);
    assert_int_equal(trajectory->joints[0].impacts, 0);
    trajectory_destroy(trajectory);
}

static void a_pin_that_starts_at_the_wall_stays_in_its_hole(void **state)
{
    (void)state;
    // no speed towards the wall, a load that presses it there: contact begins with the run
    const Vec2 places[] = {{0.6e-4, -0.8e-4}, {0.0, -1e-4}, {-0.8e-4, -0.6e-4}};
    for (size_t i = 0; i < sizeof places / sizeof *places; i++) {
        Scenario scenario = mechanism_pin(0.1, 1e-4);
        scenario.gravity = scenario_downward(9.80665);
        scenario.contact.stiffness = 6.6e10;
        scenario.linkage.bodies[0].start.position = places[i];
        scenario.run.duration = 0.05;
        scenario.run.samples = 100;
        Trajectory *trajectory = complete_run(&scenario, BACKEND_REFERENCE);
        assert_true(trajectory->joints[0].penetration_max.value < 1e-6);
        assert_true(fabs(trajectory->energy.residual) < 1e-12);
        trajectory_destroy(trajectory);
    }
}

// With a viscous damper the force jumps to c v at the onset and is largest there.
static void the_jump_of_a_viscous_damper_is_the_peak(void **state)
{
    (void)state;
    Scenario scenario = mechanism_pin(0.1, 1e-3);
    scenario.contact.stiffness = 6.6e10;
    scenario.contact.damping = DAMPING_VISCOUS;
    scenario.contact.viscous_coefficient = 2e5;
    scenario.linkage.bodies[0].start.velocity.x = 0.05;
    scenario.run.duration = 0.03;
    scenario.run.samples = 10;
    Trajectory *trajectory = complete_run(&scenario, BACKEND_REFERENCE);
    assert_close(trajectory->joints[0].force_max.value, 2e5 * 0.05, 1e-9);
    trajectory_destroy(trajectory);
}

// Sixteen pins that hit sixteen holes at one instant.
static void many_contacts_may_begin_at_once(void **state)
{
    (void)state;
    Scenario scenario = mechanism_pin(0.1, 1e-4);
    Linkage *linkage = &scenario.linkage;
    for (int i = 1; i < KINEMATICS_BODY_MAX; i++) {
        linkage->bodies[i] = linkage->bodies[0];
        linkage->joints[i] = linkage->joints[0];
        linkage->joints[i].body_b = i;
        snprintf(linkage->bodies[i].name, LINKAGE_NAME_SIZE, "pin-%d", i);
        snprintf(linkage->joints[i].name, LINKAGE_NAME_SIZE, "hole-%d", i);
    }
    linkage->body_count = KINEMATICS_BODY_MAX;
    linkage->joint_count = KINEMATICS_BODY_MAX;
    scenario.gravity = scenario_downward(9.80665);
    scenario.contact.stiffness = 6.6e10;
    scenario.run.duration = 0.02;
    scenario.run.samples = 10;
    Trajectory *trajectory = complete_run(&scenario, BACKEND_REFERENCE);
    for (int i = 0; i < KINEMATICS_BODY_MAX; i++) {
        assert_int_equal(trajectory->joints[i].impacts, trajectory->joints[0].impacts);
        assert_near(trajectory_motion(trajectory, 10, (size_t)i)->position.y,
                    trajectory_motion(trajectory, 10, 0)->position.y, 1e-12);
    }
    trajectory_destroy(trajectory);
}

static void a_loose_fourbar_has_a_truth_with_an_uncertainty_and_a_twin(void **state)
{
    (void)state;
    Scenario scenario = mechanism_paper();
    mechanism_loosen(&scenario, "crank-coupler");
    scenario.contact.stiffness = 6.6e10;
    scenario.run.revolutions = 0.25;
    Truth truth = truth_make(&scenario, NOBODY);
    assert_true(truth.trajectory->is_complete);
    assert_string_equal(truth.message, "");
    assert_false(truth.is_limited);
    assert_close(truth.horizon_s, 0.015, 1e-9);
    assert_true(truth.uncertainty > 0.0 && truth.uncertainty < 1e-9);
    // the twin is another motion, and the impacts make it so
    assert_true(truth.growth > 1.5 && truth.growth < 1e4);
    truth_finish(&truth);
}

static void a_truth_made_on_many_processors_is_the_same(void **state)
{
    (void)state;
    Scenario scenario = mechanism_paper();
    mechanism_loosen(&scenario, "crank-coupler");
    scenario.contact.stiffness = 6.6e10;
    scenario.run.revolutions = 0.1;
    for (int i = 0; i < 2; i++) {
        // with samples that are fine enough to certify on, and with few
        scenario.run.samples = i == 0 ? 12000 : 360;
        Truth one = truth_make_on(&scenario, NOBODY, 1);
        Truth many = truth_make_on(&scenario, NOBODY, 4);
        Truth alone = truth_make_uncertified(&scenario, NOBODY);
        assert_string_equal(many.message, "");
        assert_true(many.uncertainty == one.uncertainty && many.uncertainty > 0.0);
        assert_true(many.growth == one.growth && many.horizon_s == one.horizon_s);
        assert_true(many.trajectory->hash == one.trajectory->hash);
        // the first run alone has the same motion and none of the rest
        assert_true(alone.trajectory->hash == one.trajectory->hash);
        assert_true(alone.is_uncertified && alone.message[0] != '\0');
        assert_true(isinf(alone.uncertainty));
        truth_finish(&alone);
        truth_finish(&many);
        truth_finish(&one);
    }
}

static void wide_play_has_a_horizon_on_any_grid_of_samples(void **state)
{
    (void)state;
    Scenario scenario = mechanism_paper();
    mechanism_loosen(&scenario, "crank-coupler");
    scenario.contact.stiffness = 6.6e10;
    Clearance *clearance = &scenario.linkage.joints[1].clearance;
    clearance->hole_radius = clearance->pin_radius + 0.5e-3;
    double horizons[2];
    for (int i = 0; i < 2; i++) {
        scenario.run.samples = i == 0 ? 3600 : 3;
        Truth truth = truth_make(&scenario, NOBODY);
        assert_true(truth.is_limited);
        assert_true(truth.growth > 1e3 && truth.growth <= 1e5);
        horizons[i] = truth.horizon_s;
        // three samples: none but the start lies within, and there is no error to speak of
        if (i == 1) {
            const TrajectoryError error =
                error_against(truth.trajectory, truth.trajectory, truth.horizon_s);
            assert_true(isnan(error.omega_max_in_horizon));
        }
        truth_finish(&truth);
    }
    assert_true(horizons[0] > 8e-3 && horizons[0] < 20e-3);
    assert_near(horizons[1], horizons[0], 1e-3);
}

static void the_tightest_tolerance_is_certified_by_a_looser_run(void **state)
{
    (void)state;
    Scenario scenario = mechanism_paper();
    mechanism_loosen(&scenario, "crank-coupler");
    scenario.contact.stiffness = 6.6e10;
    scenario.run.revolutions = 0.02;
    scenario.reference.tolerance = 1e-14;
    Truth truth = truth_make(&scenario, NOBODY);
    assert_string_equal(truth.message, "");
    assert_true(truth.uncertainty < 1e-9);
    truth_finish(&truth);
}

// An event taken at a wrong place now and then would stand out as an error far above its
// neighbours.
static void the_error_goes_with_the_tolerance_without_outliers(void **state)
{
    (void)state;
    Scenario scenario = mechanism_paper();
    mechanism_loosen(&scenario, "crank-coupler");
    mechanism_loosen(&scenario, "coupler-follower");
    scenario.contact.stiffness = 6.6e10;
    scenario.reference.tolerance = 1e-13;
    Trajectory *truth = complete_run(&scenario, BACKEND_REFERENCE);
    for (double tolerance = 2e-9; tolerance > 1e-11; tolerance /= 1.5) {
        scenario.reference.tolerance = tolerance;
        Trajectory *trajectory = complete_run(&scenario, BACKEND_REFERENCE);
        const double error = error_against(trajectory, truth, INFINITY).omega_max;
        // some 40 times the tolerance, by the growth that the impacts bring
        if (!(error <= 100.0 * tolerance)) {
            fail_msg("tolerance %.3g: error %.3g", tolerance, error);
        }
        trajectory_destroy(trajectory);
    }
    trajectory_destroy(truth);
}

static void ideal_joints_are_certified_by_the_other_solution(void **state)
{
    (void)state;
    const Scenario scenario = mechanism_paper();
    Truth truth = truth_make(&scenario, NOBODY);
    assert_string_equal(truth.trajectory->backend, "analytic");
    assert_true(truth.uncertainty < 1e-12);
    assert_false(truth.is_limited);
    truth_finish(&truth);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_pendulum_let_go_at_rest_keeps_its_energy),
        cmocka_unit_test(a_grazing_touch_between_two_looks_is_seen),
        cmocka_unit_test(a_pin_too_slow_for_the_wall_does_not_touch_it),
        cmocka_unit_test(a_pin_that_starts_at_the_wall_stays_in_its_hole),
        cmocka_unit_test(the_jump_of_a_viscous_damper_is_the_peak),
        cmocka_unit_test(many_contacts_may_begin_at_once),
        cmocka_unit_test(a_loose_fourbar_has_a_truth_with_an_uncertainty_and_a_twin),
        cmocka_unit_test(a_truth_made_on_many_processors_is_the_same),
        cmocka_unit_test(wide_play_has_a_horizon_on_any_grid_of_samples),
        cmocka_unit_test(the_tightest_tolerance_is_certified_by_a_looser_run),
        cmocka_unit_test(the_error_goes_with_the_tolerance_without_outliers),
        cmocka_unit_test(ideal_joints_are_certified_by_the_other_solution),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
