// Do mechanisms that have nothing to do with one another move as each would alone, though all their
// contacts begin and end at one instant? The truth: one alone. Positions of the copies differ in
// their last bits, by where each stands, so no two of their events fall on the same double.
#include "complete_run.h"

#include "mechanism.h"

#include "kept.h"
#include "model/kinematics.h"
#include "run/registry.h"

#include <stdio.h>
#include <string.h>

enum { COPIES_MAX = 5 };

static const double APART = 0.6; // m, from one copy to the next

// Adds a linkage once more, moved to the right.
static void add_copy(Linkage *linkage, const Linkage *one, double right, int number)
{
    const int first = (int)linkage->body_count;
    for (size_t i = 0; i < one->body_count; i++) {
        Body *body = &linkage->bodies[linkage->body_count++];
        *body = one->bodies[i];
        body->start.position.x += right;
        snprintf(body->name, sizeof body->name, "body-%d-%zu", number, i);
    }
    for (size_t i = 0; i < one->joint_count; i++) {
        Joint *joint = &linkage->joints[linkage->joint_count++];
        *joint = one->joints[i];
        snprintf(joint->name, sizeof joint->name, "joint-%d-%zu", number, i);
        if (joint->body_a == LINKAGE_GROUND) {
            joint->anchor_a.x += right;
        } else {
            joint->body_a += first;
        }
        if (joint->body_b == LINKAGE_GROUND) {
            joint->anchor_b.x += right;
        } else {
            joint->body_b += first;
        }
    }
}

static Scenario copies(const Scenario *one, int count)
{
    Scenario scenario = kept_copy(one);
    scenario.has_fourbar = false;
    for (int i = 1; i < count; i++) {
        add_copy(&scenario.linkage, &one->linkage, APART * i, i);
    }
    return scenario;
}

// A rod with play in its pivot, let go level.
static Scenario pendulum(void)
{
    Scenario scenario = mechanism_pin(0.1, 5e-5);
    Linkage *linkage = &scenario.linkage;
    linkage->bodies[0].inertia = 1e-4;
    linkage->bodies[0].start.position = (Vec2){0.05, 0.0};
    linkage->joints[0].anchor_b = (Vec2){-0.05, 0.0};
    scenario.gravity = scenario_downward(9.80665);
    scenario.contact.stiffness = 6.6e10;
    scenario.run.duration = 0.03;
    scenario.run.samples = 60;
    return scenario;
}

// The paper's four-bar, its crank let go at 60 deg.
static Scenario four_bar(void)
{
    Scenario scenario = mechanism_paper();
    Linkage *linkage = &scenario.linkage;
    Motion motions[KINEMATICS_BODY_MAX];
    Err err = {ERR_NONE, ""};
    linkage_start(linkage, motions);
    for (int degree = 1; degree <= 60; degree++) {
        assert_true(kinematics_solve(linkage, degree * M_PI / 180.0, motions, &err));
    }
    for (size_t i = 0; i < linkage->body_count; i++) {
        linkage->bodies[i].start =
            (Motion){.position = motions[i].position, .angle = motions[i].angle};
    }
    mechanism_loosen(&scenario, "crank-coupler");
    linkage->driver.is_present = false;
    scenario.has_fourbar = false;
    scenario.contact.stiffness = 6.6e10;
    scenario.run.duration = 0.01;
    scenario.run.samples = 50;
    return scenario;
}

// The largest difference of any angular velocity of the copies from that of the one alone, as a
// share of the largest there.
static double difference(const Scenario *one, const Trajectory *many, const Trajectory *alone)
{
    const size_t bodies = one->linkage.body_count;
    double largest = 0.0;
    double worst = 0.0;
    for (size_t k = 0; k < alone->sample_count; k++) {
        for (size_t i = 0; i < many->body_count; i++) {
            const double omega = trajectory_motion(alone, k, i % bodies)->omega;
            largest = fmax(largest, fabs(omega));
            worst = fmax(worst, fabs(trajectory_motion(many, k, i)->omega - omega));
        }
    }
    return worst / largest;
}

static void check_copies(const Scenario *one, BackendKind backend, int count, double most)
{
    const Scenario scenario = copies(one, count);
    Trajectory *alone = complete_run(one, backend);
    Trajectory *many = complete_run(&scenario, backend);
    for (size_t i = 0; i < many->joint_count; i++) {
        assert_int_equal(many->joints[i].impacts,
                         alone->joints[i % one->linkage.joint_count].impacts);
    }
    const double found = difference(one, many, alone);
    if (!(found <= most)) {
        fail_msg("%d copies: %.3g", count, found);
    }
    // the control: a run to compare with that has other impacts is far off
    Scenario other = kept_copy(one);
    other.contact.restitution = 0.89;
    Trajectory *different = complete_run(&other, backend);
    assert_true(difference(one, many, different) > 1e3 * most);
    trajectory_destroy(different);
    trajectory_destroy(many);
    trajectory_destroy(alone);
}

// What rounding makes: 2e-16 m of 1e-6 m of depth, times what some impacts make of it. One impact
// more or less would be some 1e-2.
static const double PENDULUM_ROUNDING = 1e-8;
static const double FOUR_BAR_ROUNDING = 1e-6;

static void equal_pendula_swing_as_one_alone(void **state)
{
    (void)state;
    const Scenario one = pendulum();
    for (int count = 2; count <= COPIES_MAX; count++) {
        check_copies(&one, BACKEND_REFERENCE, count, PENDULUM_ROUNDING);
    }
}

static void equal_four_bars_move_as_one_alone(void **state)
{
    (void)state;
    const Scenario one = four_bar();
    check_copies(&one, BACKEND_REFERENCE, 3, FOUR_BAR_ROUNDING);
    check_copies(&one, BACKEND_REFERENCE, 5, FOUR_BAR_ROUNDING);
}

// The same in ODE with contacts integrated within the step.
static void equal_mechanisms_move_as_one_alone_in_ode(void **state)
{
    (void)state;
    const Scenario hanging = pendulum();
    const Scenario linked = four_bar();
    const Scenario pendula = scenario_with_step(&hanging, 1e-5);
    const Scenario bars = scenario_with_step(&linked, 1e-5);
    for (int count = 2; count <= COPIES_MAX; count++) {
        check_copies(&pendula, BACKEND_ODE, count, PENDULUM_ROUNDING);
    }
    check_copies(&bars, BACKEND_ODE, 3, FOUR_BAR_ROUNDING);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(equal_pendula_swing_as_one_alone),
        cmocka_unit_test(equal_four_bars_move_as_one_alone),
        cmocka_unit_test(equal_mechanisms_move_as_one_alone_in_ode),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
