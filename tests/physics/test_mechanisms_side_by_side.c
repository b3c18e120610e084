// Do mechanisms that share nothing but the ground move as each does alone?
//
// Contacts integrated within the step, which are handed on in parts: of what is between the samples
// nothing may be lost, counted twice, or put to another time.
#include "close.h"
#include "kept.h"

#include "run/run.h"

// cmocka.h needs these before it
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>
#include <stdio.h>

enum { PENDULA = 3, LINKS = 2 };

// A double pendulum with play in both pins, level at the start; each number another mass.
static void add_pendulum(Scenario *scenario, int number)
{
    static const double LENGTH = 0.1;
    Linkage *linkage = &scenario->linkage;
    for (int k = 0; k < LINKS; k++) {
        const double x = (double)number + LENGTH * k;
        const int before = k == 0 ? LINKAGE_GROUND : (int)linkage->body_count - 1;
        Body *body = &linkage->bodies[linkage->body_count++];
        snprintf(body->name, sizeof body->name, "link-%d-%d", number, k);
        body->mass = 0.1 + 0.07 * number;
        body->inertia = body->mass * LENGTH * LENGTH / 12.0;
        body->start.position.x = x + 0.5 * LENGTH;
        Joint *joint = &linkage->joints[linkage->joint_count++];
        snprintf(joint->name, sizeof joint->name, "pin-%d-%d", number, k);
        joint->kind = JOINT_CLEARANCE;
        joint->body_a = before;
        joint->body_b = (int)linkage->body_count - 1;
        joint->anchor_a.x = before == LINKAGE_GROUND ? x : 0.5 * LENGTH;
        joint->anchor_b.x = -0.5 * LENGTH;
        joint->clearance = (Clearance){.hole_radius = 5.05e-3, .pin_radius = 5e-3, .width = 0.01};
    }
}

static Scenario make_scenario(void)
{
    Scenario scenario = kept_default();
    scenario.contact.stiffness = 6.6e10;
    scenario.contact.exponent = 1.5;
    scenario.contact.friction = 0.1;
    scenario.run.duration = 0.03;
    scenario.run.samples = 150;
    scenario.run.step = 4e-5;
    scenario.ode.stepping = ODE_STAGGERED;
    scenario.ode.map = ODE_MAP_IMPULSE;
    return scenario;
}

static Trajectory *run_ode(const Scenario *scenario)
{
    Trajectory *run = run_scenario(scenario, &ODE_SOLVER, (RunWatch){NULL, NULL});
    assert_non_null(run);
    assert_true(run->is_complete);
    return run;
}

static void assert_same_extreme(const Extreme *a, const Extreme *b)
{
    assert_true(a->value == b->value);
    assert_true(a->time_s == b->time_s);
}

static void assert_same_joint(const JointExtremes *a, const JointExtremes *b)
{
    assert_int_equal(a->impacts, b->impacts);
    assert_same_extreme(&a->force_max, &b->force_max);
    assert_same_extreme(&a->penetration_max, &b->penetration_max);
    // sums over other stretches of time
    assert_close(a->impulse, b->impulse, 1e-12);
    assert_close(a->contact_time, b->contact_time, 1e-10);
    assert_int_equal(a->spike_count, b->spike_count);
    for (size_t i = 0; i < a->spike_count; i++) {
        assert_true(a->spikes[i].onset_s == b->spikes[i].onset_s);
        assert_true(a->spikes[i].approach_speed == b->spikes[i].approach_speed);
        assert_true(a->spikes[i].force_max == b->spikes[i].force_max);
        assert_close(a->spikes[i].duration_s, b->spikes[i].duration_s, 1e-10);
        assert_close(a->spikes[i].impulse, b->spikes[i].impulse, 1e-12);
    }
}

static void each_moves_as_alone(void **state)
{
    (void)state;
    Scenario all = make_scenario();
    double lost = 0.0;
    double rubbed = 0.0;
    for (int number = 0; number < PENDULA; number++) {
        add_pendulum(&all, number);
    }
    Trajectory *together = run_ode(&all);
    for (int number = 0; number < PENDULA; number++) {
        Scenario one = make_scenario();
        add_pendulum(&one, number);
        Trajectory *alone = run_ode(&one);
        for (size_t k = 0; k < LINKS; k++) {
            const size_t at = LINKS * (size_t)number + k;
            for (size_t i = 0; i < alone->sample_count; i++) {
                const Motion *a = trajectory_motion(alone, i, k);
                const Motion *b = trajectory_motion(together, i, at);
                assert_true(a->omega == b->omega && a->alpha == b->alpha);
                assert_true(trajectory_state(alone, i, k)->force ==
                            trajectory_state(together, i, at)->force);
            }
            assert_same_extreme(&alone->bodies[k].omega_max, &together->bodies[at].omega_max);
            assert_same_extreme(&alone->bodies[k].omega_min, &together->bodies[at].omega_min);
            assert_same_extreme(&alone->bodies[k].alpha_max, &together->bodies[at].alpha_max);
            assert_same_extreme(&alone->bodies[k].alpha_min, &together->bodies[at].alpha_min);
            assert_same_joint(&alone->joints[k], &together->joints[at]);
            assert_true(alone->joints[k].impacts > 2);
        }
        lost += alone->energy.dissipated;
        rubbed += alone->energy.friction;
        // control: no two of them move alike
        const size_t next = LINKS * (size_t)((number + 1) % PENDULA);
        assert_true(together->joints[next].force_max.value != alone->joints[0].force_max.value);
        trajectory_destroy(alone);
    }
    assert_close(together->energy.dissipated, lost, 1e-12);
    assert_close(together->energy.friction, rubbed, 1e-12);
    assert_true(rubbed > 0.0);
    assert_true(fabs(together->energy.residual) < 1e-3 * lost);
    trajectory_destroy(together);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(each_moves_as_alone)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
