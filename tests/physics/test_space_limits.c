// Do stops and backlash of hinges in space press as their law has it?
//
// Outside truths: the plane, for an axis along z; the energy of a pendulum on a tilted axis that
// falls on a stop, and of a lever of three different inertias.
#include "close.h"
#include "complete_run.h"
#include "kept.h"
#include "load_case.h"

#include "measure/chosen_run.h"
#include "model/space.h"

#include <stdio.h>

static const double G = 9.81;
static const double MASS = 0.4;        // kg
static const double ARM = 0.2;         // m, from the pivot to the centre of mass
static const double STIFFNESS = 500.0; // N m/rad
static const double TILT = 0.7;        // rad, of the axis from z towards y

// A pendulum level at the start whose axis is tilted, with a stop where it hangs lowest.
static Scenario make_pendulum(double tilt)
{
    Scenario scenario = kept_default();
    Linkage *linkage = &scenario.linkage;
    linkage->is_spatial = true;
    linkage->body_count = linkage->joint_count = 1;
    linkage->bodies[0] = (Body){.name = "bob", .mass = MASS, .inertia = 1e-3};
    linkage->bodies[0].start.position.x = ARM;
    linkage->bodies[0].space.inertia_x = 4e-4;
    linkage->bodies[0].space.inertia_y = 8e-4;
    linkage->joints[0] = (Joint){
        .name = "pivot",
        .body_a = LINKAGE_GROUND,
        .body_b = 0,
        .anchor_b = {-ARM, 0.0},
        .space.axis = {0.0, sin(tilt), cos(tilt)},
        .limits = {.kind = LIMIT_STOPS, .low = -0.5 * M_PI, .high = INFINITY},
        .contact = {.stiffness = STIFFNESS,
                    .exponent = 1.0,
                    .has_restitution = true,
                    .restitution = 1.0},
    };
    scenario.gravity = scenario_downward(G);
    scenario.contact.restitution = 1.0;
    scenario.run.duration = 0.7;
    scenario.run.samples = 700;
    scenario.run.step = 2e-5;
    scenario.ode.stepping = ODE_STAGGERED;
    scenario.ode.map = ODE_MAP_MIDPOINT;
    return scenario;
}

// The depth at which the spring has taken up all of the fall: k d^2 / 2 = m g L cos(tilt) cos(d).
static double deepest(double tilt)
{
    double depth = 0.0;
    for (int i = 0; i < 100; i++) {
        depth = sqrt(2.0 * MASS * G * ARM * cos(tilt) * cos(depth) / STIFFNESS);
    }
    return depth;
}

static void a_pendulum_on_a_tilted_axis_presses_its_stop_by_its_energy(void **state)
{
    (void)state;
    static const struct {
        BackendKind backend;
        OdeMap map;
        double tolerance;
    } RUNS[] = {
        {BACKEND_REFERENCE, ODE_MAP_IMPULSE, 1e-9},
        {BACKEND_ODE, ODE_MAP_MIDPOINT, 2e-3},
        {BACKEND_ODE, ODE_MAP_IMPULSE, 1e-6},
    };
    for (size_t i = 0; i < sizeof RUNS / sizeof *RUNS; i++) {
        Scenario scenario = make_pendulum(TILT);
        scenario.ode.map = RUNS[i].map;
        Trajectory *run = complete_run(&scenario, RUNS[i].backend);
        const JointExtremes *pivot = &run->joints[0];
        const double tolerance = RUNS[i].tolerance;
        assert_true(pivot->impacts == 1);
        assert_close(pivot->penetration_max.value, deepest(TILT), tolerance);
        assert_close(pivot->force_max.value, STIFFNESS * deepest(TILT), tolerance);
        // it rises again to where it fell from
        double highest = -INFINITY;
        for (size_t k = run->sample_count / 2; k < run->sample_count; k++) {
            highest = fmax(highest, trajectory_state(run, k, 0)->tilt);
        }
        assert_near(highest, 0.0, 1e-3);
        // control: the axis of the plane
        assert_true(fabs(pivot->penetration_max.value / deepest(0.0) - 1.0) > 0.05);
        trajectory_destroy(run);
    }
}

// The largest difference of omega at the samples.
static double apart(const Trajectory *a, const Trajectory *b)
{
    double worst = 0.0;
    for (size_t i = 0; i < a->sample_count * a->body_count; i++) {
        worst = fmax(worst, fabs(a->motions[i].omega - b->motions[i].omega));
    }
    return worst;
}

static void an_upright_hinge_rebounds_as_in_the_plane(void **state)
{
    (void)state;
    static const struct {
        BackendKind backend;
        OdeStepping stepping;
        OdeMap map;
        double within; // rad/s, of 10
    } RUNS[] = {
        {BACKEND_REFERENCE, ODE_STAGGERED, ODE_MAP_MIDPOINT, 1e-9},
        {BACKEND_ODE, ODE_STAGGERED, ODE_MAP_MIDPOINT, 1e-9},
        // rounding of two units in the last place of 10 rad/s, which grows so, too
        {BACKEND_ODE, ODE_STAGGERED, ODE_MAP_IMPULSE, 3e-9},
        // the rounding of ODE's own turning inertias, 1e-12, grows 15 times at each of five impacts
        {BACKEND_ODE, ODE_PLAIN, ODE_MAP_MIDPOINT, 1e-3},
    };
    for (size_t i = 0; i < sizeof RUNS / sizeof *RUNS; i++) {
        Scenario scenario = load_with("cases/mechanisms/stop-rebound.yaml", "run.step=50 us");
        scenario.ode.stepping = RUNS[i].stepping;
        scenario.ode.map = RUNS[i].map;
        Trajectory *plane = complete_run(&scenario, RUNS[i].backend);
        scenario.linkage.is_spatial = true;
        space_complete(&scenario.linkage);
        scenario.linkage.joints[0].space.axis = (Vec3){0.0, 0.0, 1.0};
        Trajectory *space = complete_run(&scenario, RUNS[i].backend);
        assert_true(apart(space, plane) < RUNS[i].within);
        assert_true(plane->joints[0].impacts > 3);
        assert_true(space->joints[0].impacts == plane->joints[0].impacts);
        assert_close(space->joints[0].force_max.value, plane->joints[0].force_max.value, 1e-6);
        // control: a stop elsewhere
        scenario.linkage.joints[0].limits.high += 1e-3;
        Trajectory *other = complete_run(&scenario, RUNS[i].backend);
        assert_true(apart(other, plane) > 1e-2);
        trajectory_destroy(other);
        trajectory_destroy(space);
        trajectory_destroy(plane);
    }
}

// A joint with backlash that turns with its body a, several times round: the angle goes on beyond a
// turn. Constants up by nothing else, both bodies keep the angular momentum about the axis.
static void backlash_on_a_body_that_turns_keeps_the_momentum(void **state)
{
    (void)state;
    Scenario scenario = make_pendulum(TILT);
    Linkage *linkage = &scenario.linkage;
    const Vec3 axis = linkage->joints[0].space.axis;
    const double gap = 0.02;
    scenario.gravity = scenario_downward(0.0);
    linkage->body_count = linkage->joint_count = 2;
    linkage->bodies[1] = linkage->bodies[0];
    snprintf(linkage->bodies[1].name, sizeof linkage->bodies[1].name, "rotor");
    linkage->bodies[0].start.position.x = 0.0;
    linkage->bodies[1].start.position.x = 0.0;
    linkage->joints[0].anchor_b.x = 0.0;
    linkage->joints[0].limits = (Limits){.kind = LIMIT_NONE};
    linkage->joints[0].contact = (JointContact){.stiffness = 0.0};
    linkage->joints[1] = linkage->joints[0];
    snprintf(linkage->joints[1].name, sizeof linkage->joints[1].name, "coupling");
    linkage->joints[1].body_a = 0;
    linkage->joints[1].body_b = 1;
    linkage->joints[1].limits = (Limits){.kind = LIMIT_BACKLASH, .backlash = gap};
    linkage->joints[1].contact = (JointContact){
        .stiffness = STIFFNESS, .exponent = 1.0, .has_restitution = true, .restitution = 0.5};
    const double rate = 30.0; // rad/s
    SpaceMotion spun = {.omega = vec3_scale(rate, axis)};
    space_set_start(&spun, &linkage->bodies[1]);
    Trajectory *run = complete_run(&scenario, BACKEND_REFERENCE);
    const double both = run->motions[2 * (run->sample_count - 1)].omega +
                        run->motions[2 * (run->sample_count - 1) + 1].omega;
    assert_true(run->joints[1].impacts > 3);
    // two bodies alike on one axis
    assert_close(both, rate * axis.z, 1e-9);
    for (size_t k = 0; k < run->sample_count; k++) {
        const double at = trajectory_state(run, k, 1)->tilt;
        assert_true(fabs(at) < 0.5 * gap + 0.1);
    }
    // control: it is the flanks that hand the momentum on
    assert_true(fabs(run->motions[2 * (run->sample_count - 1)].omega) > 0.3 * rate * axis.z);
    trajectory_destroy(run);
}

// A tilted stop on a body that is itself carried round a tilted pivot by its fall: with map impulse
// the error against the reference falls with the square of the step.
static Scenario make_carried(void)
{
    Scenario scenario = make_pendulum(TILT);
    Linkage *linkage = &scenario.linkage;
    linkage->body_count = linkage->joint_count = 2;
    linkage->bodies[1] = linkage->bodies[0];
    snprintf(linkage->bodies[1].name, sizeof linkage->bodies[1].name, "arm");
    linkage->bodies[1].start.position.x = 3.0 * ARM;
    linkage->joints[0].limits = (Limits){.kind = LIMIT_NONE};
    linkage->joints[0].contact = (JointContact){.stiffness = 0.0};
    linkage->joints[1] = linkage->joints[0];
    snprintf(linkage->joints[1].name, sizeof linkage->joints[1].name, "elbow");
    linkage->joints[1].body_a = 0;
    linkage->joints[1].body_b = 1;
    linkage->joints[1].anchor_a.x = ARM;
    linkage->joints[1].space.axis = (Vec3){0.6, 0.0, 0.8};
    linkage->joints[1].limits = (Limits){.kind = LIMIT_STOPS, .low = -0.05, .high = 0.08};
    linkage->joints[1].contact = (JointContact){
        .stiffness = STIFFNESS, .exponent = 1.0, .has_restitution = true, .restitution = 0.6};
    scenario.reference.tolerance = 1e-12;
    scenario.run.duration = 0.3;
    scenario.run.samples = 150;
    scenario.ode.map = ODE_MAP_IMPULSE;
    return scenario;
}

static void a_stop_on_a_carried_body_is_of_second_order(void **state)
{
    (void)state;
    enum { STEPS = 3 };
    Scenario scenario = make_carried();
    Trajectory *truth = complete_run(&scenario, BACKEND_REFERENCE);
    double errors[STEPS];
    assert_true(truth->joints[1].impacts > 3);
    for (int i = 0; i < STEPS; i++) {
        scenario.run.step = 4e-4 / (1 << i);
        Trajectory *run = complete_run(&scenario, BACKEND_ODE);
        errors[i] = apart(run, truth);
        print_message("# step %g us: error %.2g rad/s, %zu of %zu impacts, energy %.2g of %.2g J\n",
                      1e6 * scenario.run.step, errors[i], run->joints[1].impacts,
                      truth->joints[1].impacts, fabs(run->energy.residual),
                      truth->energy.dissipated);
        assert_int_equal(run->joints[1].impacts, truth->joints[1].impacts);
        assert_close(run->joints[1].force_max.value, truth->joints[1].force_max.value, 1e-3);
        assert_close(run->energy.dissipated, truth->energy.dissipated, 1e-2);
        trajectory_destroy(run);
    }
    assert_true(errors[STEPS - 1] < errors[0] / 10.0);
    // control: the rows of the same step are further off, and so is a stop elsewhere
    scenario.ode.map = ODE_MAP_MIDPOINT;
    Trajectory *rows = complete_run(&scenario, BACKEND_ODE);
    assert_true(apart(rows, truth) > 3.0 * errors[STEPS - 1]);
    scenario.ode.map = ODE_MAP_IMPULSE;
    scenario.linkage.joints[1].limits.low -= 1e-3;
    scenario.linkage.joints[1].limits.high += 1e-3;
    Trajectory *other = complete_run(&scenario, BACKEND_ODE);
    assert_true(apart(other, truth) > 30.0 * errors[STEPS - 1]);
    trajectory_destroy(other);
    trajectory_destroy(rows);
    trajectory_destroy(truth);
}

// The same with the first pivot driven, and the driven body on either side of the stops: the
// drive's work is what the energy of all else says.
static void the_drive_does_its_work_against_stops(void **state)
{
    (void)state;
    for (int side = 0; side < 2; side++) {
        Scenario scenario = make_carried();
        Linkage *linkage = &scenario.linkage;
        Joint *elbow = &linkage->joints[1];
        linkage->driver = (Driver){.is_present = true, .joint = 0, .speed = 12.0};
        // the arm goes round with the driven body at the start
        const Vec3 omega = vec3_scale(linkage->driver.speed, linkage->joints[0].space.axis);
        SpaceMotion round = {
            .position = {3.0 * ARM, 0.0, 0.0}, .turn = {1.0, 0.0, 0.0, 0.0}, .omega = omega};
        round.velocity = vec3_cross(omega, round.position);
        space_set_start(&round, &linkage->bodies[1]);
        const SpaceMotion driven = space_driven(linkage, 0.0);
        space_set_start(&driven, &linkage->bodies[0]);
        if (side == 1) {
            const Joint straight = *elbow;
            elbow->body_a = straight.body_b;
            elbow->body_b = straight.body_a;
            elbow->anchor_a = straight.anchor_b;
            elbow->anchor_b = straight.anchor_a;
        }
        Trajectory *truth = complete_run(&scenario, BACKEND_REFERENCE);
        double residuals[2];
        for (int i = 0; i < 2; i++) {
            scenario.run.step = 2e-4 / (1 << (2 * i));
            Trajectory *run = complete_run(&scenario, BACKEND_ODE);
            residuals[i] = fabs(run->energy.residual);
            print_message("# driven body %c: work %.6g, reference's %.6g J, residual %.2g J, %zu "
                          "impacts, apart by %.2g rad/s\n",
                          side == 0 ? 'a' : 'b', run->energy.drive_work, truth->energy.drive_work,
                          residuals[i], run->joints[1].impacts, apart(run, truth));
            assert_close(run->energy.drive_work, truth->energy.drive_work, 1e-3);
            assert_int_equal(run->joints[1].impacts, truth->joints[1].impacts);
            assert_true(run->joints[1].impacts >= 2);
            trajectory_destroy(run);
        }
        assert_true(residuals[1] < residuals[0] / 8.0);
        assert_true(residuals[1] < 1e-4 * truth->energy.dissipated);
        trajectory_destroy(truth);
    }
}

// A step chosen for an error: the deepest point is where the energy is, to the error wanted.
static void a_step_is_chosen_for_limits_in_space(void **state)
{
    (void)state;
    Scenario scenario = make_pendulum(TILT);
    scenario.run.step = 0.0;
    scenario.run.tolerance = 1e-4;
    assert_int_equal(scenario_with_step(&scenario, 1e-5).ode.map, ODE_MAP_IMPULSE);
    Trajectory *run = backend_run(&scenario, BACKEND_ODE, NULL, (ChosenWatch){.begin = NULL}, NULL);
    if (!run->is_complete) {
        fail_msg("%s", run->message);
    }
    assert_true(run->error_estimate <= 1e-4);
    assert_close(run->joints[0].penetration_max.value, deepest(TILT), 1e-3);
    // control: it took steps far longer than a hundredth of the contact, half a period of which is
    // 18 ms: rows would not do
    assert_true(run->step_s > 1e-4);
    trajectory_destroy(run);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_pendulum_on_a_tilted_axis_presses_its_stop_by_its_energy),
        cmocka_unit_test(an_upright_hinge_rebounds_as_in_the_plane),
        cmocka_unit_test(backlash_on_a_body_that_turns_keeps_the_momentum),
        cmocka_unit_test(a_stop_on_a_carried_body_is_of_second_order),
        cmocka_unit_test(the_drive_does_its_work_against_stops),
        cmocka_unit_test(a_step_is_chosen_for_limits_in_space),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
