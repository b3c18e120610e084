// Does a Bennett linkage move as its closed form has it?
//
// Four revolute joints whose axes neither meet nor are parallel: links of lengths a, b, a, b and
// twists alpha, beta, alpha, beta move where a / sin(alpha) = b / sin(beta), with the angles theta
// of the crank and phi of the follower to the frame's line
//     tan(theta / 2) tan(phi / 2) = sin((beta + alpha) / 2) / sin((beta - alpha) / 2)
// (G. T. Bennett, Engineering 76 (1903) 777). Three of the five rows of the joint that closes the
// loop follow from the two others. With play in one pin the follower is off by some part of it.
#include "complete_run.h"
#include "load_case.h"

#include <string.h>

static const double TWIST_A = 40.0 * M_PI / 180.0;
static const double TWIST_B = 80.0 * M_PI / 180.0;
static const double START = 30.0 * M_PI / 180.0;

// The follower's angle by the crank's, from the one root to the next as the crank turns.
static double follower_angle(double crank)
{
    const double ratio = sin(0.5 * (TWIST_B + TWIST_A)) / sin(0.5 * (TWIST_B - TWIST_A));
    return 2.0 * atan2(ratio * cos(0.5 * crank), sin(0.5 * crank));
}

// With a radial play, m, of its pin, and collars with two and a half times that; or ideal.
static Scenario bennett(double play, bool is_ideal)
{
    const char *const override = "run.revolutions=0.35";
    Scenario scenario = load_with("cases/space/bennett.yaml", override);
    Joint *joint = &scenario.linkage.joints[2];
    joint->kind = is_ideal ? JOINT_REVOLUTE : JOINT_CLEARANCE;
    joint->clearance.hole_radius = joint->clearance.pin_radius + play;
    joint->space.axial_clearance = 2.5 * play;
    scenario.contact.stiffness = 2e8;
    return scenario;
}

// The largest distance of the follower's angle from the closed form's, rad, from a time on.
static double follower_error(const Scenario *scenario, const Trajectory *run, double from_s,
                             double *turned)
{
    const Vec3 axis = scenario->linkage.joints[3].space.axis;
    const Vec3 side = vec3_normal_to(axis);
    const Vec3 own = quat_rotate_back(trajectory_space_motion(run, 0, 2)->turn, side);
    double largest = 0.0;
    for (size_t k = 0; k < run->sample_count; k++) {
        const Vec3 now = quat_rotate(trajectory_space_motion(run, k, 2)->turn, own);
        const double angle = atan2(vec3_dot(axis, vec3_cross(side, now)), vec3_dot(side, now));
        const double crank = START + run->crank_angles[k] - run->crank_angles[0];
        // both count from the line of the frame, the follower's backwards
        const double truth = follower_angle(START) - follower_angle(crank);
        const double off = remainder(angle + truth, 2.0 * M_PI);
        *turned = fmax(*turned, fabs(truth));
        if (run->times[k] >= from_s) {
            largest = fmax(largest, fabs(off));
        }
    }
    return largest;
}

static void the_ideal_loop_follows_the_closed_form(void **state)
{
    (void)state;
    const Scenario scenario = bennett(0.0, true);
    Trajectory *run = complete_run(&scenario, BACKEND_REFERENCE);
    assert_int_equal(run->constraint_rows, 2);
    double turned = 0.0;
    // as far as the ten digits of the case's lengths go
    assert_true(follower_error(&scenario, run, 0.0, &turned) < 1e-10);
    assert_true(turned > 0.5);
    assert_near(run->energy.residual, 0.0, 1e-9 * fabs(run->energy.drive_work));
    trajectory_destroy(run);
    // control: with another twist it does not move at all
    Scenario other = bennett(0.0, true);
    other.linkage.joints[1].space.axis = (Vec3){0.0, 0.0, 1.0};
    run = run_scenario(&other, registry_solver(BACKEND_REFERENCE), (RunWatch){NULL, NULL});
    assert_false(run->is_complete);
    assert_non_null(strstr(run->message, "follower-ground cannot be kept closed"));
    trajectory_destroy(run);
}

static void the_error_of_a_pin_with_play_is_proportional_to_it(void **state)
{
    (void)state;
    const double plays[2] = {80e-6, 40e-6};
    double shares[2];
    for (int i = 0; i < 2; i++) {
        const Scenario scenario = bennett(plays[i], false);
        Trajectory *run = complete_run(&scenario, BACKEND_REFERENCE);
        double turned = 0.0;
        shares[i] = follower_error(&scenario, run, 0.0, &turned) / plays[i];
        assert_true(run->joints[2].impacts > 1);
        trajectory_destroy(run);
    }
    // the follower's pin is 98 mm from its pivot: 22 rad per metre of play
    assert_close(shares[1], shares[0], 1e-3);
    assert_true(shares[0] > 1.0 && shares[0] < 100.0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_ideal_loop_follows_the_closed_form),
        cmocka_unit_test(the_error_of_a_pin_with_play_is_proportional_to_it),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
