// Is a mechanism in space that has no reason to leave the plane the plane's?
//
// Bodies without products of inertia whose joints are at the heights of their centres stay in the
// plane. Each end of a hole has half of the joint's law: together they press as the planar pin
// does, whose run by the planar reference is the truth. The controls have a reason to leave it.
#include "complete_run.h"
#include "load_case.h"
#include "mechanism.h"

#include "base/lcg.h"
#include "model/space.h"

#include <stdio.h>

// m/s^2, along z: it moves nothing, but bodies that it pulls do not go by the equations of the
// plane (model/space_flat.h; tests/physics/test_space_flat.c)
static const double PULL = 1e-30;

static Scenario four_bar(const char *space, const char *friction, const char *other)
{
    const char *const overrides[] = {space, friction, "run.samples=600", other};
    Scenario scenario = load("cases/paper/impact-k66.yaml", overrides, other != NULL ? 4 : 3);
    scenario.gravity.z = scenario.linkage.is_spatial ? PULL : 0.0;
    return scenario;
}

// The largest difference of any omega about z over the largest omega, up to a time.
static double apart(const Trajectory *a, const Trajectory *b, double until_s)
{
    double largest = 0.0;
    for (size_t i = 0; i < a->body_count; i++) {
        const double scale = trajectory_omega_scale(a, i);
        for (size_t k = 0; k < a->sample_count && a->times[k] <= until_s; k++) {
            const double difference =
                trajectory_motion(a, k, i)->omega - trajectory_motion(b, k, i)->omega;
            largest = fmax(largest, fabs(difference) / scale);
        }
    }
    return largest;
}

static void assert_same_contacts(const Trajectory *space, const Trajectory *plane)
{
    const JointExtremes *a = &space->joints[1];
    const JointExtremes *b = &plane->joints[1];
    assert_int_equal(a->impacts, b->impacts);
    assert_true(a->impacts > 1);
    assert_close(a->force_max.value, b->force_max.value, 1e-9);
    assert_close(a->penetration_max.value, b->penetration_max.value, 1e-9);
    assert_close(a->impulse, b->impulse, 1e-9);
    assert_close(a->spikes[0].approach_speed, b->spikes[0].approach_speed, 1e-9);
    assert_close(space->energy.dissipated, plane->energy.dissipated, 1e-9);
    assert_true(a->tilt_max.value < 1e-15);
    assert_true(a->axial_max.value < 1e-15);
}

static void a_lifted_mechanism_moves_as_in_the_plane(void **state)
{
    (void)state;
    const char *const frictions[] = {"contact.friction=0", "contact.friction=0.1"};
    for (int i = 0; i < 2; i++) {
        const Scenario flat = four_bar("space=planar", frictions[i], NULL);
        const Scenario lifted = four_bar("space=spatial", frictions[i], NULL);
        Trajectory *plane = complete_run(&flat, BACKEND_REFERENCE);
        Trajectory *space = complete_run(&lifted, BACKEND_REFERENCE);
        const double error = apart(space, plane, plane->duration_s);
        if (!(error < 1e-10)) {
            fail_msg("friction %d: omega differs by %.3g", i, error);
        }
        assert_same_contacts(space, plane);
        assert_close(space->energy.friction, plane->energy.friction, 1e-9);
        trajectory_destroy(space);
        trajectory_destroy(plane);
    }
}

// With play at both its ends nothing holds the coupler in the plane but that it has no reason to
// leave it. The controls give it one.
static void a_coupler_with_play_at_both_ends_stays_in_the_plane(void **state)
{
    (void)state;
    const char *const loose =
        "joints.coupler-follower={radial-clearance: 14.5 um, width: 13 mm, start: centred}";
    const char *const others[] = {NULL, "four-bar.coupler.offset=1 mm",
                                  "four-bar.coupler.product-xz=5 kg mm^2"};
    const Scenario flat = four_bar("space=planar", loose, NULL);
    Trajectory *plane = complete_run(&flat, BACKEND_REFERENCE);
    for (int i = 0; i < 3; i++) {
        const Scenario lifted = four_bar("space=spatial", loose, others[i]);
        Trajectory *space = complete_run(&lifted, BACKEND_REFERENCE);
        const double error = apart(space, plane, 0.2 * plane->duration_s);
        assert_true(i == 0 ? error < 1e-10 : error > 1e-5);
        assert_true(i == 0 || space->joints[2].tilt_max.value > 1e-5);
        trajectory_destroy(space);
    }
    trajectory_destroy(plane);
}

// Where the implicit method wins its trial in the plane it wins it in space.
static void strong_damping_takes_the_steps_of_the_plane(void **state)
{
    (void)state;
    const char *const overrides[] = {
        "space=planar",
        "joints.coupler-follower={radial-clearance: 14.5 um, width: 13 mm, start: centred}",
        "contact.damping=flores",
        "contact.restitution=0.01",
        "run.revolutions=0.1",
        "run.samples=100",
    };
    Scenario scenario = load("cases/paper/impact-k66.yaml", overrides, 6);
    Trajectory *plane = complete_run(&scenario, BACKEND_REFERENCE);
    scenario.linkage.is_spatial = true;
    scenario.gravity.z = PULL;
    Trajectory *space = complete_run(&scenario, BACKEND_REFERENCE);
    assert_true(apart(space, plane, plane->duration_s) < 1e-9);
    assert_true((double)space->steps < 1.2 * (double)plane->steps);
    trajectory_destroy(space);
    trajectory_destroy(plane);
}

// Forty links in a row, level at the start, each with a little speed of its own; every third pin
// has play.
static Scenario make_chain(void)
{
    enum { LINKS = 40 };
    static const double LENGTH = 0.1;
    Scenario scenario = scenario_default();
    scenario.linkage = mechanism_chain(LINKS, LENGTH, 0.1);
    uint64_t seed = lcg_stirred(1);
    for (size_t i = 0; i < LINKS; i++) {
        Body *body = &scenario.linkage.bodies[i];
        Joint *joint = &scenario.linkage.joints[i];
        // about the pins before: all points of the chain on one line stay there
        body->start.velocity.y = 0.02 * lcg_draw(&seed);
        if (i % 3 == 0) {
            joint->kind = JOINT_CLEARANCE;
            joint->clearance =
                (Clearance){.hole_radius = 5.01e-3, .pin_radius = 5e-3, .width = 0.02};
        } else {
            const Body *before = &scenario.linkage.bodies[i - 1];
            // the joint holds: the ends move alike
            const double end = before->start.velocity.y + 0.5 * LENGTH * before->start.omega;
            body->start.omega = (body->start.velocity.y - end) / (0.5 * LENGTH);
        }
    }
    space_complete(&scenario.linkage);
    scenario.contact.stiffness = 6.6e9;
    scenario.contact.exponent = 1.5;
    scenario.run.duration = 2e-3;
    scenario.run.samples = 40;
    scenario.run.step = 2e-5;
    scenario.reference.tolerance = 1e-11;
    return scenario;
}

static void forty_links_in_space_move_as_in_the_plane(void **state)
{
    (void)state;
    Scenario scenario = make_chain();
    const BackendKind backends[3] = {BACKEND_REFERENCE, BACKEND_ODE, BACKEND_ODE};
    for (int i = 0; i < 3; i++) {
        scenario.ode.stepping = ODE_STAGGERED;
        scenario.ode.map = i == 1 ? ODE_MAP_MIDPOINT : ODE_MAP_IMPULSE;
        scenario.linkage.is_spatial = false;
        scenario.gravity.z = 0.0;
        Trajectory *plane = complete_run(&scenario, backends[i]);
        scenario.linkage.is_spatial = true;
        scenario.gravity.z = PULL;
        Trajectory *space = complete_run(&scenario, backends[i]);
        size_t impacts = 0;
        for (size_t k = 0; k < plane->joint_count; k++) {
            impacts += plane->joints[k].impacts;
            assert_true(space->joints[k].impacts == plane->joints[k].impacts);
        }
        const double error = apart(space, plane, plane->duration_s);
        assert_true(impacts > 14);
        // contacts within the step have its errors
        assert_true(error < (i == 2 ? 2e-4 : 1e-6));
        // control: one body whose mass is off the plane
        if (i == 1) {
            scenario.linkage.bodies[20].space.height = 1e-3;
            Trajectory *other = complete_run(&scenario, backends[i]);
            scenario.linkage.bodies[20].space.height = 0.0;
            assert_true(apart(other, plane, plane->duration_s) > 0.1);
            trajectory_destroy(other);
        }
        trajectory_destroy(space);
        trajectory_destroy(plane);
    }
    linkage_free(&scenario.linkage);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_lifted_mechanism_moves_as_in_the_plane),
        cmocka_unit_test(a_coupler_with_play_at_both_ends_stays_in_the_plane),
        cmocka_unit_test(strong_damping_takes_the_steps_of_the_plane),
        cmocka_unit_test(forty_links_in_space_move_as_in_the_plane),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
