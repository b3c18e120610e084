// Do mechanisms in space of more bodies than fit a dense matrix move as they have to?
//
// Outside truths: the plane, whose equations are others; ODE's own rows; the same mechanism alone.
#include "close.h"
#include "complete_run.h"
#include "mechanism.h"

#include "base/lcg.h"
#include "model/space.h"

#include <stdio.h>

static const double LENGTH = 0.1; // m
static const double MASS = 0.1;   // kg

// Links in a row, level at the start and at rest.
static Scenario make_chain(size_t count, Vec3 odd_axis)
{
    Scenario scenario = scenario_default();
    scenario.linkage = mechanism_chain(count, LENGTH, MASS);
    scenario.linkage.is_spatial = true;
    uint64_t seed = lcg_stirred(3);
    for (size_t i = 0; i < count; i++) {
        Body *body = &scenario.linkage.bodies[i];
        body->mass = MASS * (1.0 + 0.3 * lcg_draw(&seed));
        body->inertia = body->mass * LENGTH * LENGTH / 12.0;
        if (i % 2 == 1) {
            scenario.linkage.joints[i].space.axis = odd_axis;
        }
    }
    space_complete(&scenario.linkage);
    scenario.gravity = scenario_downward(9.81);
    scenario.run.duration = 0.02;
    scenario.run.samples = 20;
    scenario.run.step = 1e-4;
    scenario.ode.stepping = ODE_STAGGERED;
    return scenario;
}

static const Vec3 UPRIGHT = {0.0, 0.0, 1.0};
static const Vec3 TILTED = {0.0, 0.6, 0.8};

// The largest difference of any angular velocity about z at the samples, of the largest there is.
static double apart(const Trajectory *a, const Trajectory *b)
{
    double largest = 0.0;
    double worst = 0.0;
    for (size_t i = 0; i < a->sample_count * a->body_count; i++) {
        largest = fmax(largest, fabs(a->motions[i].omega));
        worst = fmax(worst, fabs(a->motions[i].omega - b->motions[i].omega));
    }
    assert_true(largest > 0.1);
    return worst / largest;
}

// 150 links, 750 rows: the reference by elimination body by body, ODE by forces.
static void a_long_chain_moves_as_in_the_plane(void **state)
{
    (void)state;
    const BackendKind backends[2] = {BACKEND_REFERENCE, BACKEND_ODE};
    for (int i = 0; i < 2; i++) {
        Scenario scenario = make_chain(150, UPRIGHT);
        Trajectory *space = complete_run(&scenario, backends[i]);
        scenario.linkage.is_spatial = false;
        Trajectory *plane = complete_run(&scenario, backends[i]);
        assert_true(apart(space, plane) < 1e-8);
        // control: every second axis tilted
        Scenario tilted = make_chain(150, TILTED);
        Trajectory *other = complete_run(&tilted, backends[i]);
        assert_true(apart(other, plane) > 1e-2);
        trajectory_destroy(other);
        trajectory_destroy(plane);
        trajectory_destroy(space);
        linkage_free(&tilted.linkage);
        linkage_free(&scenario.linkage);
    }
}

// Joints that the case makes a little soft stay rows of ODE.
static void check_rows(OdeStepping stepping)
{
    Scenario scenario = make_chain(12, TILTED);
    scenario.ode.stepping = stepping;
    // turning inertias count: the first links spin
    for (size_t i = 0; i < 12; i++) {
        scenario.linkage.bodies[i].space.inertia_x = 0.3 * scenario.linkage.bodies[i].inertia;
        scenario.linkage.bodies[i].start.omega = 20.0;
        scenario.linkage.bodies[i].start.velocity.y = 20.0 * LENGTH * ((double)i + 0.5);
    }
    Trajectory *forces = complete_run(&scenario, BACKEND_ODE);
    scenario.ode.cfm = 1e-15;
    Trajectory *rows = complete_run(&scenario, BACKEND_ODE);
    print_message("# forces and rows are apart by %.2g\n", apart(forces, rows));
    assert_true(apart(forces, rows) < 1e-8);
    for (size_t i = 0; i < forces->joint_count; i++) {
        assert_close(forces->joints[i].force_max.value, rows->joints[i].force_max.value, 1e-7);
    }
    // control: soft ones
    scenario.ode.cfm = 1e-3;
    Trajectory *soft = complete_run(&scenario, BACKEND_ODE);
    assert_true(apart(soft, rows) > 1e-5);
    trajectory_destroy(soft);
    trajectory_destroy(rows);
    trajectory_destroy(forces);
    linkage_free(&scenario.linkage);
}

static void forces_hold_a_chain_as_odes_rows_do(void **state)
{
    (void)state;
    check_rows(ODE_STAGGERED);
    check_rows(ODE_PLAIN);
}

// Error at the end against the reference: the order of a staggered step is 2.
static void a_tilted_chain_held_by_forces_is_of_second_order(void **state)
{
    (void)state;
    Scenario scenario = make_chain(12, TILTED);
    Trajectory *truth = complete_run(&scenario, BACKEND_REFERENCE);
    double errors[2];
    for (int i = 0; i < 2; i++) {
        scenario.run.step = i == 0 ? 1e-4 : 5e-5;
        Trajectory *run = complete_run(&scenario, BACKEND_ODE);
        errors[i] = apart(run, truth);
        trajectory_destroy(run);
    }
    assert_true(errors[1] < 1e-3);
    assert_true(errors[0] / errors[1] > 3.5 && errors[0] / errors[1] < 4.5);
    trajectory_destroy(truth);
    linkage_free(&scenario.linkage);
}

// A tilted chain with play in two joints of three, so that ideal joints hold pairs of links
// together; each link has a little speed of its own.
static Scenario make_loose_chain(size_t count)
{
    Scenario scenario = make_chain(count, TILTED);
    Linkage *linkage = &scenario.linkage;
    uint64_t seed = lcg_stirred(5);
    for (size_t i = 0; i < count; i++) {
        Body *body = &linkage->bodies[i];
        body->start.velocity = (Vec2){0.02 * lcg_draw(&seed), 0.02 * lcg_draw(&seed)};
        // what an ideal joint holds together moves together
        if (i % 3 == 2) {
            body->start.velocity = linkage->bodies[i - 1].start.velocity;
            continue;
        }
        linkage->joints[i].kind = JOINT_CLEARANCE;
        linkage->joints[i].clearance = (Clearance){
            .hole_radius = 5.01e-3 + 5e-6 * lcg_draw(&seed), .pin_radius = 5e-3, .width = 0.01};
    }
    space_complete(linkage);
    scenario.contact.stiffness = 6.6e10;
    scenario.contact.exponent = 1.5;
    scenario.contact.friction = 0.1;
    scenario.run.duration = 2e-3;
    scenario.ode.map = ODE_MAP_IMPULSE;
    return scenario;
}

// The largest difference of velocities at the samples, m/s.
static double difference(const Trajectory *a, const Trajectory *b)
{
    double largest = 0.0;
    for (size_t i = 0; i < a->sample_count; i++) {
        for (size_t k = 0; k < a->body_count; k++) {
            const Vec3 between = vec3_sub(trajectory_space_motion(a, i, k)->velocity,
                                          trajectory_space_motion(b, i, k)->velocity);
            largest = fmax(largest, vec3_length(between));
        }
    }
    return largest;
}

// 40 places of contact, integrated by islands.
static void contacts_of_a_long_chain_follow_the_reference(void **state)
{
    (void)state;
    enum { LINKS = 30, RUNS = 3 };
    Scenario scenario = make_loose_chain(LINKS);
    scenario.reference.tolerance = 1e-12;
    Trajectory *truth = complete_run(&scenario, BACKEND_REFERENCE);
    double errors[RUNS];
    double loose[RUNS] = {0.0};
    double ideal[RUNS] = {0.0};
    for (int i = 0; i < RUNS; i++) {
        scenario.run.step = 4e-5 / (1 << i);
        Trajectory *run = complete_run(&scenario, BACKEND_ODE);
        errors[i] = difference(run, truth);
        print_message("# step %g us: error %.2g m/s, %zu of %zu impacts, energy %.2g of %.2g J\n",
                      1e6 * scenario.run.step, errors[i], run_impacts(run), run_impacts(truth),
                      fabs(run->energy.residual), run->energy.friction);
        assert_int_equal(run_impacts(run), run_impacts(truth));
        assert_true(run_impacts(run) > LINKS);
        assert_close(run->energy.friction, truth->energy.friction, 1e-3);
        for (size_t k = 0; k < run->joint_count; k++) {
            const double force = truth->joints[k].force_max.value;
            const double off = fabs(run->joints[k].force_max.value / force - 1.0);
            double *of = k % 3 == 2 ? &ideal[i] : &loose[i];
            *of = fmax(*of, off);
        }
        trajectory_destroy(run);
    }
    // the sum of both ends' forces is looked at when either of them is the largest
    assert_true(loose[RUNS - 1] < 2e-2 && ideal[RUNS - 1] < 5e-3);
    assert_true(errors[0] < 1e-5);
    assert_true(errors[RUNS - 1] < errors[0] / 8.0);
    // control: a pin with a micron more of play shows
    scenario.linkage.joints[LINKS / 2].clearance.hole_radius += 1e-6;
    Trajectory *other = complete_run(&scenario, BACKEND_ODE);
    assert_true(difference(other, truth) > 100.0 * errors[RUNS - 1]);
    trajectory_destroy(other);
    trajectory_destroy(truth);
    linkage_free(&scenario.linkage);
}

// Both ends of every pin come to their walls within 20 us, by turns above and below: 60 places that
// are integrated in blocks. Spins about the links' own axes make the ends part.
static void many_pins_that_meet_their_walls_at_once_follow_the_reference(void **state)
{
    (void)state;
    enum { LINKS = 30, RUNS = 2 };
    Scenario scenario = make_chain(LINKS, UPRIGHT);
    Linkage *linkage = &scenario.linkage;
    uint64_t seed = lcg_stirred(7);
    double offset = 0.0;
    double speed = 0.0;
    for (size_t i = 0; i < LINKS; i++) {
        const double sign = i % 2 == 0 ? -1.0 : 1.0;
        const double closing = 0.02 * (1.0 + lcg_draw(&seed));
        const double left_s = 4e-5 + 2e-5 * lcg_draw(&seed);
        const double play = 1e-5 + 5e-6 * lcg_draw(&seed);
        linkage->joints[i].kind = JOINT_CLEARANCE;
        linkage->joints[i].clearance =
            (Clearance){.hole_radius = 5e-3 + play, .pin_radius = 5e-3, .width = 0.01};
        offset += sign * (play - closing * left_s);
        speed += sign * closing;
        linkage->bodies[i].start.position.y = offset;
        linkage->bodies[i].start.velocity.y = speed;
        linkage->bodies[i].space.omega_x = 0.2 * lcg_draw(&seed);
    }
    scenario.contact.stiffness = 6.6e10;
    scenario.contact.exponent = 1.5;
    scenario.contact.friction = 0.1;
    scenario.run.duration = 2.4e-4;
    scenario.ode.map = ODE_MAP_IMPULSE;
    scenario.reference.tolerance = 1e-12;
    Trajectory *truth = complete_run(&scenario, BACKEND_REFERENCE);
    double errors[RUNS];
    for (int i = 0; i < RUNS; i++) {
        scenario.run.step = 4e-5 / (1 << (2 * i));
        Trajectory *run = complete_run(&scenario, BACKEND_ODE);
        errors[i] = difference(run, truth);
        print_message("# step %g us: error %.2g m/s, %zu of %zu impacts\n", 1e6 * scenario.run.step,
                      errors[i], run_impacts(run), run_impacts(truth));
        assert_int_equal(run_impacts(run), run_impacts(truth));
        assert_true(run_impacts(run) >= LINKS);
        trajectory_destroy(run);
    }
    assert_true(errors[0] < 1e-6 && errors[1] < errors[0] / 4.0);
    // control: a pin with a micron more of play shows
    linkage->joints[LINKS / 2].clearance.hole_radius += 1e-6;
    Trajectory *other = complete_run(&scenario, BACKEND_ODE);
    assert_true(difference(other, truth) > 100.0 * errors[0]);
    trajectory_destroy(other);
    trajectory_destroy(truth);
    linkage_free(linkage);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_long_chain_moves_as_in_the_plane),
        cmocka_unit_test(forces_hold_a_chain_as_odes_rows_do),
        cmocka_unit_test(contacts_of_a_long_chain_follow_the_reference),
        cmocka_unit_test(many_pins_that_meet_their_walls_at_once_follow_the_reference),
        cmocka_unit_test(a_tilted_chain_held_by_forces_is_of_second_order),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
