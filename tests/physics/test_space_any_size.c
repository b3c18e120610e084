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
    scenario.gravity = 9.81;
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
static void forces_hold_a_chain_as_odes_rows_do(void **state)
{
    (void)state;
    Scenario scenario = make_chain(12, TILTED);
    Trajectory *forces = complete_run(&scenario, BACKEND_ODE);
    scenario.ode.cfm = 1e-15;
    Trajectory *rows = complete_run(&scenario, BACKEND_ODE);
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

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_long_chain_moves_as_in_the_plane),
        cmocka_unit_test(forces_hold_a_chain_as_odes_rows_do),
        cmocka_unit_test(a_tilted_chain_held_by_forces_is_of_second_order),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
