// Do mechanisms that share nothing but the ground move as each does alone, and long chains with
// play in all pins as the reference says?
//
// Contacts integrated within ODE's step, and the reference: both hand on one mechanism after the
// other. Of what is between the samples nothing may be lost, counted twice, or put to another time.
#include "close.h"
#include "complete_run.h"
#include "kept.h"
#include "mechanism.h"

#include "base/lcg.h"
#include "run/tracer.h"

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
    scenario.run.keeps_ranges = true;
    return scenario;
}

static Trajectory *run_ode(const Scenario *scenario)
{
    Trajectory *run = run_scenario(scenario, &ODE_SOLVER, (RunWatch){NULL, NULL});
    assert_non_null(run);
    assert_true(run->is_complete);
    return run;
}

// The same, and its spikes are looked for.
static Trajectory *trace(const Scenario *scenario, const Solver *solver)
{
    Trajectory *run = tracer_run(scenario, solver, (RunWatch){NULL, NULL});
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
    assert_true(a->impulse == b->impulse);
    assert_true(a->contact_time == b->contact_time);
    assert_int_equal(a->spike_count, b->spike_count);
    for (size_t i = 0; i < a->spike_count; i++) {
        assert_true(a->spikes[i].onset_s == b->spikes[i].onset_s);
        assert_true(a->spikes[i].approach_speed == b->spikes[i].approach_speed);
        assert_true(a->spikes[i].force_max == b->spikes[i].force_max);
        assert_true(a->spikes[i].duration_s == b->spikes[i].duration_s);
        assert_true(a->spikes[i].impulse == b->spikes[i].impulse);
    }
}

// Spikes of a signal. Where they name a joint, its numbers are so far apart.
static void assert_same_spikes(const SignalSpikes *a, const SignalSpikes *b, int apart)
{
    assert_true(a->threshold == b->threshold);
    assert_int_equal(a->count, b->count);
    assert_int_equal(a->kept, b->kept);
    for (size_t i = 0; i < a->kept; i++) {
        assert_true(a->spikes[i].time_s == b->spikes[i].time_s);
        assert_true(a->spikes[i].value == b->spikes[i].value);
        assert_true(a->spikes[i].impulse == b->spikes[i].impulse);
        assert_int_equal(a->spikes[i].joint >= 0 ? a->spikes[i].joint + apart : -1,
                         b->spikes[i].joint);
    }
}

static void assert_same_range(const Trajectory *alone, const Trajectory *together, size_t own,
                              size_t signal)
{
    const size_t count = alone->ranges.count;
    assert_int_equal(count, together->ranges.count);
    for (size_t i = 0; i < count; i++) {
        const Range a = ranges_over(&alone->ranges, own, i, i + 1);
        const Range b = ranges_over(&together->ranges, signal, i, i + 1);
        assert_true(a.least == b.least && a.most == b.most);
    }
}

// What was seen between the samples: the ranges and the spikes of a link and of its pin.
static void assert_same_between(const Trajectory *alone, const Trajectory *together, size_t k,
                                size_t at)
{
    const Ranges *ranges = &alone->ranges;
    const int apart = (int)(at - k);
    assert_true(ranges->count > 0);
    for (int i = 0; i < RANGES_OF_BODY; i++) {
        assert_same_range(alone, together, ranges_of_body(k, (RangesOfBody)i),
                          ranges_of_body(at, (RangesOfBody)i));
    }
    for (int i = 0; i < RANGES_OF_JOINT; i++) {
        assert_same_range(alone, together, ranges_of_joint(ranges, k, (RangesOfJoint)i),
                          ranges_of_joint(&together->ranges, at, (RangesOfJoint)i));
    }
    assert_same_spikes(&alone->alpha_spikes[k], &together->alpha_spikes[at], apart);
    assert_same_spikes(&alone->force_spikes[k], &together->force_spikes[at], apart);
    assert_true(alone->force_spikes[k].count > 2);
}

// A gear of 2 halves steps of ODE where contacts want it: each mechanism its own.
static void check_alone(const Solver *solver, int gear)
{
    Scenario all = make_scenario();
    all.ode.gear = gear;
    double lost = 0.0;
    double rubbed = 0.0;
    for (int number = 0; number < PENDULA; number++) {
        add_pendulum(&all, number);
    }
    Trajectory *together = trace(&all, solver);
    for (int number = 0; number < PENDULA; number++) {
        Scenario one = make_scenario();
        one.ode.gear = gear;
        add_pendulum(&one, number);
        Trajectory *alone = trace(&one, solver);
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
            assert_same_between(alone, together, k, at);
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

static void each_moves_as_alone_in_ode(void **state)
{
    (void)state;
    check_alone(&ODE_SOLVER, 1);
    check_alone(&ODE_SOLVER, 2);
}

static void each_moves_as_alone_in_the_reference(void **state)
{
    (void)state;
    check_alone(&REFERENCE_SOLVER, 1);
}

// Without records, as certification runs it.
static void each_moves_as_alone_where_motions_alone_are_asked_for(void **state)
{
    (void)state;
    Scenario all = make_scenario();
    for (int number = 0; number < PENDULA; number++) {
        add_pendulum(&all, number);
    }
    Trajectory *together = run_motion(&all, &REFERENCE_SOLVER, (RunWatch){NULL, NULL});
    assert_true(together->is_complete);
    assert_true(together->duration_s == all.run.duration);
    for (int number = 0; number < PENDULA; number++) {
        Scenario one = make_scenario();
        add_pendulum(&one, number);
        Trajectory *alone = run_motion(&one, &REFERENCE_SOLVER, (RunWatch){NULL, NULL});
        for (size_t k = 0; k < alone->sample_count * LINKS; k++) {
            const size_t at = LINKS * (size_t)number + k % LINKS;
            const Motion *a = trajectory_motion(alone, k / LINKS, k % LINKS);
            const Motion *b = trajectory_motion(together, k / LINKS, at);
            assert_true(a->omega == b->omega && a->angle == b->angle);
            assert_true(a->position.x == b->position.x && a->velocity.y == b->velocity.y);
        }
        trajectory_destroy(alone);
    }
    trajectory_destroy(together);
}

// Links in a row, hung up at one end, each with a little speed of its own; the pins start in the
// middle of their holes, of which no two are alike.
static Scenario make_chain(size_t count)
{
    Scenario scenario = make_scenario();
    uint64_t seed = lcg_stirred(1);
    scenario.linkage = mechanism_chain(count, 0.1, 0.1);
    for (size_t i = 0; i < count; i++) {
        Body *body = &scenario.linkage.bodies[i];
        body->start.velocity = (Vec2){0.02 * lcg_draw(&seed), 0.02 * lcg_draw(&seed)};
        body->start.omega = 0.2 * lcg_draw(&seed);
        Joint *joint = &scenario.linkage.joints[i];
        joint->kind = JOINT_CLEARANCE;
        joint->clearance = (Clearance){
            .hole_radius = 5.01e-3 + 5e-6 * lcg_draw(&seed), .pin_radius = 5e-3, .width = 0.01};
    }
    scenario.run.duration = 2e-3;
    scenario.run.samples = 20;
    return scenario;
}

// The largest difference of speeds at any sample, m/s.
static double difference(const Trajectory *a, const Trajectory *b)
{
    double largest = 0.0;
    for (size_t i = 0; i < a->sample_count; i++) {
        for (size_t k = 0; k < a->body_count; k++) {
            const Vec2 apart = vec2_sub(trajectory_motion(a, i, k)->velocity,
                                        trajectory_motion(b, i, k)->velocity);
            largest = fmax(largest, vec2_length(apart));
        }
    }
    return largest;
}

// Compares a chain with the reference in three steps; every pin touches so many times at least.
static void check_chain(Scenario scenario, size_t least)
{
    enum { RUNS = 3 };
    const size_t count = scenario.linkage.body_count;
    scenario.reference.tolerance = 1e-12;
    Trajectory *truth = complete_run(&scenario, BACKEND_REFERENCE);
    double errors[RUNS];
    for (int i = 0; i < RUNS; i++) {
        scenario.run.step = 4e-5 / (1 << i);
        Trajectory *run = run_ode(&scenario);
        errors[i] = difference(run, truth);
        const double residual = fabs(run->energy.residual);
        print_message("# %zu links, step %g us: error %.2g m/s, energy %.2g of %.2g J\n", count,
                      1e6 * scenario.run.step, errors[i], residual, run->energy.dissipated);
        assert_int_equal(run_impacts(run), run_impacts(truth));
        assert_true(run_impacts(run) >= least * count);
        assert_close(run->energy.dissipated, truth->energy.dissipated, 1e-4);
        assert_close(run->energy.friction, truth->energy.friction, 1e-4);
        assert_true(residual < 1e-5 * run->energy.dissipated);
        trajectory_destroy(run);
    }
    // order 2 in the step: 16 from the first to the last; speeds are some 0.02 m/s
    assert_true(errors[0] < 1e-5);
    assert_true(errors[RUNS - 1] < errors[0] / 8.0);
    // control: a pin with a micron more of play shows
    scenario.linkage.joints[count / 2].clearance.hole_radius += 1e-6;
    Trajectory *other = run_ode(&scenario);
    assert_true(difference(other, truth) > 100.0 * errors[0]);
    trajectory_destroy(other);
    trajectory_destroy(truth);
    linkage_free(&scenario.linkage);
}

static void a_chain_with_play_in_all_pins_follows_the_reference(void **state)
{
    (void)state;
    check_chain(make_chain(40), 2);
    check_chain(make_chain(200), 2);
}

// The same, but that every pin meets its wall at a time of its own within 20 us, by turns above and
// below: all of them are one island then.
static Scenario make_meeting(size_t count)
{
    Scenario scenario = make_chain(count);
    uint64_t seed = lcg_stirred(2);
    double offset = 0.0;
    double speed = 0.0;
    for (size_t i = 0; i < count; i++) {
        Body *body = &scenario.linkage.bodies[i];
        const Clearance *clearance = &scenario.linkage.joints[i].clearance;
        const double sign = i % 2 == 0 ? -1.0 : 1.0;
        const double closing = 0.02 * (1.0 + lcg_draw(&seed));
        const double left_s = 4e-5 + 2e-5 * lcg_draw(&seed);
        offset += sign * (clearance->hole_radius - clearance->pin_radius - closing * left_s);
        speed += sign * closing;
        body->start.position.y = offset;
        body->start.velocity = (Vec2){0.0, speed};
        body->start.omega = 0.0;
    }
    scenario.run.duration = 3.2e-4;
    return scenario;
}

static void many_pins_that_meet_their_walls_at_once_follow_the_reference(void **state)
{
    (void)state;
    check_chain(make_meeting(60), 1);
    check_chain(make_meeting(150), 1);
}

// The largest force of a joint, and the largest angular acceleration of a body, at any sample.
static double sampled_force(const Trajectory *run, size_t joint)
{
    double largest = 0.0;
    for (size_t i = 0; i < run->sample_count; i++) {
        largest = fmax(largest, trajectory_state(run, i, joint)->force);
    }
    return largest;
}

static double sampled_alpha(const Trajectory *run, size_t body)
{
    double largest = -INFINITY;
    for (size_t i = 0; i < run->sample_count; i++) {
        largest = fmax(largest, trajectory_motion(run, i, body)->alpha);
    }
    return largest;
}

// Whether an extreme is what samples say that may have missed it by so much, and nothing more.
static void check_top(double extreme, double sampled, double missed)
{
    assert_true(extreme >= sampled - 1e-12 * fabs(sampled));
    assert_true(extreme <= sampled + missed);
}

static void extremes_of_many_pins_are_found_between_two_samples(void **state)
{
    (void)state;
    enum { COUNT = 40 };
    Scenario scenario = make_meeting(COUNT);
    scenario.run.samples = 2;
    Trajectory *coarse = trace(&scenario, &REFERENCE_SOLVER);
    // a tenth of a microsecond
    scenario.run.samples = 3201;
    Trajectory *fine = trace(&scenario, &REFERENCE_SOLVER);
    double hidden = 0.0;
    for (size_t k = 0; k < COUNT; k++) {
        const double force = coarse->joints[k].force_max.value;
        const double alpha = coarse->bodies[k].alpha_max.value;
        const double next = k + 1 < COUNT ? coarse->joints[k + 1].force_max.value : 0.0;
        const Body *body = &scenario.linkage.bodies[k];
        // swings of 50 us and more: (0.05 us * 2 pi / 50 us)^2 / 2 = 2e-5 of forces, and of what
        // they do to a body, on whose ends they may pull against each other
        check_top(force, sampled_force(fine, k), 2e-5 * force);
        check_top(alpha, sampled_alpha(fine, k), 2e-5 * (force + next) * 0.05 / body->inertia);
        assert_close(force, fine->joints[k].force_max.value, 1e-9);
        assert_close(alpha, fine->bodies[k].alpha_max.value, 1e-9);
        assert_true(coarse->joints[k].impacts >= 1);
        hidden = fmax(hidden, 1.0 - sampled_force(coarse, k) / force);
    }
    // control: the samples of the first run alone do not know
    assert_true(hidden > 0.5);
    trajectory_destroy(coarse);
    trajectory_destroy(fine);
    linkage_free(&scenario.linkage);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_moves_as_alone_in_ode),
        cmocka_unit_test(each_moves_as_alone_in_the_reference),
        cmocka_unit_test(each_moves_as_alone_where_motions_alone_are_asked_for),
        cmocka_unit_test(many_pins_that_meet_their_walls_at_once_follow_the_reference),
        cmocka_unit_test(extremes_of_many_pins_are_found_between_two_samples),
        cmocka_unit_test(a_chain_with_play_in_all_pins_follows_the_reference),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
