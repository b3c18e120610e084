// Are the ideal joints of a long chain held as rows of ODE hold them?
//
// A world with many ideal joints has no rows of ODE for them; with a CFM that is smaller than any
// rounding it has.
#include "close.h"
#include "kept.h"

#include "model/solver.h"

// cmocka.h needs these before it
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { LINKS = 24, STEPS = 200 };

static const double LENGTH = 0.1;        // m
static const double NO_SOFTNESS = 1e-30; // s/kg
static const double SLIDER_MASS = 0.3;   // kg

// Links that hang from a slider on the ground, level at the start.
static Scenario make_chain(OdeStepping stepping)
{
    Scenario scenario = kept_default();
    Linkage *linkage = &scenario.linkage;
    for (size_t i = 0; i <= LINKS; i++) {
        Body *body = &linkage->bodies[linkage->body_count++];
        snprintf(body->name, sizeof body->name, "body-%zu", i);
        body->mass = i == 0 ? SLIDER_MASS : 0.1;
        body->inertia = body->mass * LENGTH * LENGTH / 12.0;
        body->start.position.x = i == 0 ? 0.0 : LENGTH * ((double)i - 0.5);
        Joint *joint = &linkage->joints[linkage->joint_count++];
        snprintf(joint->name, sizeof joint->name, "joint-%zu", i);
        joint->kind = i == 0 ? JOINT_PRISMATIC : JOINT_REVOLUTE;
        joint->body_a = (int)i - 1;
        joint->body_b = (int)i;
        joint->anchor_a.x = i > 1 ? 0.5 * LENGTH : 0.0;
        joint->anchor_b.x = i > 0 ? -0.5 * LENGTH : 0.0;
    }
    scenario.run.step = 1e-4;
    scenario.run.duration = 1.0;
    scenario.ode.stepping = stepping;
    scenario.ode.settle_steps = 0;
    return scenario;
}

// Takes steps and writes how the bodies move then and what the joints do.
static void take_steps(const Scenario *scenario, double *omega, JointState *joints)
{
    Err err = {ERR_NONE, ""};
    void *state = NULL;
    assert_true(ODE_SOLVER.open(scenario, &state, &err));
    for (size_t i = 0; i < STEPS; i++) {
        assert_true(ODE_SOLVER.step(state, 1.0, &err));
    }
    const StepRecord record = ODE_SOLVER.record(state);
    for (size_t i = 0; i <= LINKS; i++) {
        omega[i] = record.omega[i];
        joints[i] = record.joints[i];
    }
    ODE_SOLVER.close(state);
}

static void check_stepping(OdeStepping stepping)
{
    Scenario scenario = make_chain(stepping);
    double omega[3][LINKS + 1];
    JointState joints[3][LINKS + 1];
    take_steps(&scenario, omega[0], joints[0]);
    scenario.ode.cfm = NO_SOFTNESS;
    take_steps(&scenario, omega[1], joints[1]);
    // control: a softness that can be seen
    scenario.ode.cfm = 1e-2;
    take_steps(&scenario, omega[2], joints[2]);
    double largest = 0.0;
    for (size_t i = 0; i <= LINKS; i++) {
        assert_near(omega[0][i], omega[1][i], 1e-8);
        assert_near(joints[0][i].force, joints[1][i].force, 1e-6);
        assert_near(joints[0][i].force_on_b.x, joints[1][i].force_on_b.x, 1e-6);
        assert_near(joints[0][i].force_on_b.y, joints[1][i].force_on_b.y, 1e-6);
        assert_near(joints[0][i].moment_on_b, joints[1][i].moment_on_b, 1e-6);
        largest = fmax(largest, fabs(omega[2][i] - omega[1][i]));
    }
    assert_true(fabs(omega[0][1]) > 0.1);
    assert_true(joints[0][1].force > 0.05);
    assert_true(largest > 1e-5);
}

static void plain_steps_are_those_of_rows_of_ode(void **state)
{
    (void)state;
    check_stepping(ODE_PLAIN);
}

static void staggered_steps_are_those_of_rows_of_ode(void **state)
{
    (void)state;
    check_stepping(ODE_STAGGERED);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(plain_steps_are_those_of_rows_of_ode),
        cmocka_unit_test(staggered_steps_are_those_of_rows_of_ode),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
