// Is ODE in space what it is in the plane, where nothing leaves the plane, and right where bodies
// do leave it?
//
// Outside truths: the planar runs, whose law each end of a hole has half of; Euler's equations of a
// free body; statics of a pin that is pressed off its middle; the restitution asked for; Newton's
// law for a crank.
#include "complete_run.h"
#include "load_case.h"

#include "contact/pin_space.h"
#include "kept.h"

// The paper's mechanism in space.
static Scenario paper(OdeStepping stepping, OdeMap map, double step_s)
{
    Scenario scenario = load_with("cases/paper/impact-k66.yaml", "space=spatial");
    scenario.run.revolutions = 0.2;
    scenario.run.step = step_s;
    scenario.ode.stepping = stepping;
    scenario.ode.map = map;
    // local steps of contacts that are as good in either, of errors of 2e-10
    scenario.ode.contact_phase = 0.0125;
    return scenario;
}

// The largest difference of angular velocities and joint forces, over the largest of each.
typedef struct Apart {
    double omega;
    double alpha;
    double force;
} Apart;

static Apart apart(const Trajectory *a, const Trajectory *b)
{
    double scale[3] = {0.0};
    double worst[3] = {0.0};
    assert_int_equal(a->sample_count, b->sample_count);
    for (size_t i = 0; i < a->sample_count; i++) {
        for (size_t k = 0; k < a->body_count; k++) {
            const Motion *one = trajectory_motion(a, i, k);
            const Motion *two = trajectory_motion(b, i, k);
            scale[0] = fmax(scale[0], fabs(one->omega));
            scale[1] = fmax(scale[1], fabs(one->alpha));
            worst[0] = fmax(worst[0], fabs(one->omega - two->omega));
            worst[1] = fmax(worst[1], fabs(one->alpha - two->alpha));
        }
        for (size_t k = 0; k < a->joint_count; k++) {
            const JointState *one = trajectory_state(a, i, k);
            const JointState *two = trajectory_state(b, i, k);
            scale[2] = fmax(scale[2], one->force);
            worst[2] = fmax(worst[2], vec2_length(vec2_sub(one->force_on_b, two->force_on_b)));
        }
    }
    return (Apart){worst[0] / scale[0], worst[1] / scale[1], worst[2] / scale[2]};
}

static Apart lifted(Scenario flat, double height)
{
    Scenario spatial = kept_copy(&flat);
    flat.linkage.is_spatial = false;
    // in space bodies answer contacts within a step as at its middle; a pull across the plane,
    // which moves nothing, keeps those of a linkage in it from its steps (model/space_flat.h)
    flat.ode.is_frozen = true;
    spatial.gravity.z = 1e-30;
    for (size_t i = 0; i < spatial.linkage.body_count; i++) {
        spatial.linkage.bodies[i].space.height = height;
    }
    Trajectory *one = complete_run(&flat, BACKEND_ODE);
    Trajectory *two = complete_run(&spatial, BACKEND_ODE);
    const Apart found = apart(one, two);
    for (size_t i = 0; i < one->joint_count && height == 0.0; i++) {
        assert_int_equal(one->joints[i].impacts, two->joints[i].impacts);
        assert_close(two->joints[i].force_max.value, one->joints[i].force_max.value, 1e-6);
    }
    trajectory_destroy(one);
    trajectory_destroy(two);
    return found;
}

// A depth is rounded by 1e-17 m, of a micron, and impacts make more of it.
static void assert_same(Apart found)
{
    assert_true(found.omega < 1e-9);
    assert_true(found.alpha < 1e-6);
    assert_true(found.force < 1e-6);
}

static void a_planar_mechanism_moves_in_space_as_in_the_plane(void **state)
{
    (void)state;
    for (int i = 0; i < 2; i++) {
        const double step_s = i == 0 ? 4e-6 : 1e-6;
        for (OdeMap map = ODE_MAP_TEXTBOOK; map <= ODE_MAP_IMPULSE; map++) {
            assert_same(lifted(paper(ODE_STAGGERED, map, step_s), 0.0));
            if (map != ODE_MAP_IMPULSE) {
                assert_same(lifted(paper(ODE_PLAIN, map, step_s), 0.0));
            }
        }
    }
}

// What never leaves the plane has its steps, within which the response changes. The truth is the
// reference; the control, the steps in space.
static void impulse_steps_in_the_plane_are_those_of_the_plane(void **state)
{
    (void)state;
    Scenario flat = paper(ODE_STAGGERED, ODE_MAP_IMPULSE, 10e-6);
    Scenario spatial = kept_copy(&flat);
    flat.linkage.is_spatial = false;
    Trajectory *truth = complete_run(&flat, BACKEND_REFERENCE);
    Trajectory *plane = complete_run(&flat, BACKEND_ODE);
    Trajectory *run = complete_run(&spatial, BACKEND_ODE);
    spatial.gravity.z = 1e-30;
    Trajectory *other = complete_run(&spatial, BACKEND_ODE);
    assert_same(apart(plane, run));
    assert_true(apart(truth, run).omega < 0.2 * apart(truth, other).omega);
    assert_true(apart(plane, other).omega > 1e-8);
    for (size_t i = 0; i < run->joint_count; i++) {
        assert_int_equal(run->joints[i].impacts, plane->joints[i].impacts);
    }
    Trajectory *const runs[] = {truth, plane, run, other};
    for (size_t i = 0; i < sizeof runs / sizeof *runs; i++) {
        trajectory_destroy(runs[i]);
    }
}

// The control: half the friction.
static void friction_is_that_of_the_plane(void **state)
{
    (void)state;
    for (OdeMap map = ODE_MAP_TEXTBOOK; map <= ODE_MAP_IMPULSE; map += 2) {
        Scenario scenario = paper(ODE_STAGGERED, map, 4e-6);
        scenario.run.revolutions = 0.02;
        scenario.contact.friction = 0.1;
        // the step's own equations are solved to 1e-7, contacts in the step by other local steps
        assert_true(lifted(scenario, 0.0).omega < 1e-6);
        Scenario half = kept_copy(&scenario);
        half.contact.friction = 0.05;
        Trajectory *one = complete_run(&scenario, BACKEND_ODE);
        Trajectory *two = complete_run(&half, BACKEND_ODE);
        assert_true(apart(one, two).omega > 1e-3);
        trajectory_destroy(one);
        trajectory_destroy(two);
    }
}

// The coupler between two pins with play: nothing but the pins keeps it from tilting. The control:
// centres of mass beside the plane of the pins.
static void a_body_between_two_pins_tilts_only_where_its_mass_is_off_the_plane(void **state)
{
    (void)state;
    for (OdeMap map = ODE_MAP_MIDPOINT; map <= ODE_MAP_IMPULSE; map += 2) {
        Scenario scenario = paper(ODE_STAGGERED, map, 2e-6);
        Joint *joints = scenario.linkage.joints;
        joints[2].kind = JOINT_CLEARANCE;
        joints[2].clearance = joints[1].clearance;
        assert_same(lifted(scenario, 0.0));
        assert_true(lifted(scenario, 2e-3).omega > 1e-4);
    }
}

// The largest part of Newton's law for the driven crank that the forces in its two joints leave
// over at any sample, over the largest force; `share` is of the force of the second that is
// counted.
static double crank_is_off(const Trajectory *run, const Scenario *scenario, double share)
{
    const double mass = scenario->linkage.bodies[0].mass;
    double worst = 0.0;
    double largest = 0.0;
    for (size_t i = 0; i < run->sample_count; i++) {
        const Vec2 drive = trajectory_state(run, i, 0)->force_on_b;
        const Vec2 taken = vec2_scale(share, trajectory_state(run, i, 1)->force_on_b);
        const Vec2 weight = vec2_scale(mass, scenario_gravity(scenario));
        const Vec2 sum = vec2_add(vec2_sub(drive, taken), weight);
        const Vec2 moved = vec2_scale(mass, trajectory_motion(run, i, 0)->acceleration);
        worst = fmax(worst, vec2_length(vec2_sub(moved, sum)));
        largest = fmax(largest, vec2_length(drive));
    }
    return worst / largest;
}

// The play is at the far end of the coupler: an ideal joint hands on to the crank what the contacts
// do within a step.
static void the_drive_bears_what_an_ideal_joint_hands_on(void **state)
{
    (void)state;
    Scenario scenario = paper(ODE_STAGGERED, ODE_MAP_IMPULSE, 20e-6);
    scenario.run.samples = 2000;
    Joint *joints = scenario.linkage.joints;
    joints[2].kind = JOINT_CLEARANCE;
    joints[2].clearance = joints[1].clearance;
    joints[1].kind = JOINT_REVOLUTE;
    Trajectory *run = complete_run(&scenario, BACKEND_ODE);
    assert_true(run->joints[2].impacts > 0);
    const double off = crank_is_off(run, &scenario, 1.0);
    if (!(off < 1e-9)) {
        fail_msg("the crank's forces leave over %.3g", off);
    }
    // the control: a force off by a thousandth
    assert_true(crank_is_off(run, &scenario, 1.001) > 1e-4);
    trajectory_destroy(run);
}

// A run with few samples against all steps of it, as the samples of another.
static void the_largest_tilt_is_that_of_the_steps(void **state)
{
    (void)state;
    Scenario scenario = paper(ODE_STAGGERED, ODE_MAP_MIDPOINT, 2e-6);
    scenario.run.revolutions = 0.1;
    scenario.linkage.bodies[1].space.height = 2e-3;
    scenario.linkage.joints[2].kind = JOINT_CLEARANCE;
    scenario.linkage.joints[2].clearance = scenario.linkage.joints[1].clearance;
    scenario.run.samples = 30;
    Trajectory *run = complete_run(&scenario, BACKEND_ODE);
    scenario.run.samples = 10000;
    Trajectory *dense = complete_run(&scenario, BACKEND_ODE);
    double tilt = 0.0;
    double axial = 0.0;
    for (size_t i = 0; i < dense->sample_count; i++) {
        tilt = fmax(tilt, trajectory_space_state(dense, i, 1)->tilt);
        axial = fmax(axial, fabs(trajectory_space_state(dense, i, 1)->axial));
    }
    assert_true(tilt > 1e-5);
    assert_close(run->joints[1].tilt_max.value, tilt, 1e-3);
    assert_close(run->joints[1].axial_max.value, axial, 1e-3);
    trajectory_destroy(run);
    trajectory_destroy(dense);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_planar_mechanism_moves_in_space_as_in_the_plane),
        cmocka_unit_test(impulse_steps_in_the_plane_are_those_of_the_plane),
        cmocka_unit_test(friction_is_that_of_the_plane),
        cmocka_unit_test(a_body_between_two_pins_tilts_only_where_its_mass_is_off_the_plane),
        cmocka_unit_test(the_drive_bears_what_an_ideal_joint_hands_on),
        cmocka_unit_test(the_largest_tilt_is_that_of_the_steps),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
