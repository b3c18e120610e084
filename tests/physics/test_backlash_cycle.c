// Does a torque that comes and goes move what has backlash as piecewise closed forms say?
//
// An inertia I between two flanks g to either side of 0, each a spring k with a damper c that does
// not pull, under a torque M(t) that is linear from bend to bend. With s = +-1 the side, d = s
// theta
// - g the depth and M = m + n t:
//     free or slack   I theta'' = m + n t
//     pressing        I d'' + c d' + k d = s (m + n t)
//                     d = p + q t + exp(-a t) (A cos w t + B sin w t),
//                     q = s n / k, p = (s m - c q) / k
// Pressing ends where k d + c d' = 0, slack where d = 0. The times are found by bisection in long
// double; the periodic motion by following it until it repeats.
#include "complete_run.h"
#include "kept.h"

#include <stdio.h>

typedef long double Real;

static const Real INERTIA = 0.01L;
static const Real STIFFNESS = 1e4L;
static const Real DAMPER = 10.0L;
static const Real HALF_GAP = 0.01L;
static const Real TORQUE = 1.0L;
static const Real PERIOD = 0.06L;

typedef enum Phase { FREE, PRESSING, SLACK } Phase;

typedef struct Lever {
    Real time;
    Real angle;
    Real speed;
    Phase phase;
    Real side; // of a contact
} Lever;

// A triangle: up from 0 for a quarter, down for a half, up again.
static Real torque_at(Real time, Real *slope)
{
    const Real turns = time / PERIOD;
    const Real share = turns - floorl(turns);
    const Real rise = 4.0L * TORQUE / PERIOD;
    *slope = share >= 0.25L && share < 0.75L ? -rise : rise;
    return share < 0.25L   ? rise * share * PERIOD
           : share < 0.75L ? rise * (0.5L - share) * PERIOD
                           : rise * (share - 1.0L) * PERIOD;
}

// The state a time later within one phase and one piece of the torque.
static Lever later(const Lever *lever, Real by)
{
    // the piece of the torque is that of the middle: at a bend rounding could take the one before
    Real n;
    const Real middle = torque_at(lever->time + 0.5L * by, &n);
    const Real m = middle - 0.5L * n * by;
    Lever moved = *lever;
    moved.time += by;
    if (lever->phase != PRESSING) {
        moved.angle += lever->speed * by + by * by * (m / 2.0L + n * by / 6.0L) / INERTIA;
        moved.speed += by * (m + n * by / 2.0L) / INERTIA;
        return moved;
    }
    const Real s = lever->side;
    const Real a = DAMPER / (2.0L * INERTIA);
    const Real w = sqrtl(STIFFNESS / INERTIA - a * a);
    const Real q = s * n / STIFFNESS;
    const Real p = (s * m - DAMPER * q) / STIFFNESS;
    const Real depth = s * lever->angle - HALF_GAP;
    const Real first = depth - p;
    const Real second = (s * lever->speed - q + a * first) / w;
    const Real fade = expl(-a * by);
    const Real c = cosl(w * by);
    const Real i = sinl(w * by);
    const Real now = p + q * by + fade * (first * c + second * i);
    moved.angle = s * (now + HALF_GAP);
    moved.speed = s * (q + fade * ((second * w - a * first) * c - (first * w + a * second) * i));
    return moved;
}

// Above 0 while the phase lasts.
static Real margin(const Lever *lever)
{
    if (lever->phase == FREE) {
        return HALF_GAP - fabsl(lever->angle);
    }
    const Real depth = lever->side * lever->angle - HALF_GAP;
    return lever->phase == SLACK ? depth : STIFFNESS * depth + DAMPER * lever->side * lever->speed;
}

static void change(Lever *lever)
{
    if (lever->phase == FREE) {
        lever->side = lever->angle > 0.0L ? 1.0L : -1.0L;
        lever->phase = PRESSING;
    } else {
        lever->phase = lever->phase == PRESSING ? SLACK : FREE;
    }
}

// Goes on to a time, in steps that see every change of the phase and end at bends of the torque.
static Lever follow(Lever lever, Real until)
{
    const Real look = PERIOD / 4000.0L;
    long steps = (long)floorl(lever.time / look + 1e-9L);
    while (lever.time < until - 1e-17L) {
        Real end = look * (Real)(steps + 1);
        end = end > until ? until : end;
        const Lever next = later(&lever, end - lever.time);
        if (margin(&next) >= 0.0L) {
            lever = next;
            lever.time = end;
            steps++;
            continue;
        }
        Real low = 0.0L;
        Real high = end - lever.time;
        for (int i = 0; i < 80; i++) {
            const Real middle = 0.5L * (low + high);
            const Lever at = later(&lever, middle);
            *(margin(&at) > 0.0L ? &low : &high) = middle;
        }
        lever = later(&lever, high);
        change(&lever);
    }
    return lever;
}

// The periodic motion, where it crosses the middle of the gap upwards.
static Lever find_cycle(void)
{
    Lever lever = {.phase = FREE};
    for (int i = 1; i <= 400; i++) {
        lever = follow(lever, PERIOD * (Real)i);
    }
    Lever before = lever;
    while (!(before.angle < 0.0L && lever.angle >= 0.0L)) {
        before = lever;
        lever = follow(lever, lever.time + PERIOD / 4000.0L);
    }
    const Real over = lever.angle / lever.speed;
    return follow(before, lever.time - over);
}

enum { PERIODS = 12 };

// The same lever as a scenario that begins at the cycle's time, under a torque that does.
static Scenario scenario_of(const Lever *start)
{
    Scenario scenario = kept_default();
    scenario.gravity = scenario_downward(0.0);
    scenario.run.backend_count = 1;
    scenario.run.backends[0] = BACKEND_REFERENCE;
    scenario.run.duration = (double)(PERIOD * (Real)PERIODS);
    scenario.run.samples = 40 * PERIODS;
    scenario.reference.tolerance = 1e-13;
    Linkage *linkage = &scenario.linkage;
    linkage->body_count = 1;
    linkage->bodies[0] = (Body){
        .name = "lever",
        .mass = 1.0,
        .inertia = (double)INERTIA,
        .start = {.angle = (double)start->angle, .omega = (double)start->speed},
    };
    linkage->joint_count = 1;
    linkage->joints[0] = (Joint){
        .name = "hinge",
        .body_a = LINKAGE_GROUND,
        .body_b = 0,
        .held_angle = (double)start->angle,
        .limits = {.kind = LIMIT_BACKLASH, .backlash = 2.0 * (double)HALF_GAP},
        .contact = {.stiffness = (double)STIFFNESS, .exponent = 1.0, .viscous = (double)DAMPER},
    };
    TimeTable *table = &linkage->torque.table;
    Real slope;
    table->times[0] = 0.0;
    table->values[0] = (double)torque_at(start->time, &slope);
    table->count = 1;
    const long first = (long)floorl(start->time / PERIOD * 2.0L - 0.5L) + 1;
    for (long bend = first; table->count < 2 * PERIODS + 2; bend++) {
        const Real time = (0.25L + 0.5L * (Real)bend) * PERIOD;
        table->times[table->count] = (double)(time - start->time);
        table->values[table->count++] = (double)(bend % 2 == 0 ? TORQUE : -TORQUE);
    }
    return scenario;
}

static void a_flank_chatters_in_the_periodic_motion_that_shooting_finds(void **state)
{
    (void)state;
    const Lever start = find_cycle();
    const Lever again = follow(start, start.time + PERIOD);
    assert_near((double)(again.angle - start.angle), 0.0, 1e-15);
    assert_near((double)(again.speed - start.speed), 0.0, 1e-12);
    assert_true(start.phase == FREE && start.speed > 0.1L);
    const Scenario scenario = scenario_of(&start);
    Trajectory *run = complete_run(&scenario, BACKEND_REFERENCE);
    double angle_error = 0.0;
    double speed_error = 0.0;
    double other = 0.0;
    Lever lever = start;
    for (size_t k = 0; k < run->sample_count; k++) {
        lever = follow(lever, start.time + (Real)run->times[k]);
        const Motion *motion = trajectory_motion(run, k, 0);
        angle_error = fmax(angle_error, fabs(motion->angle - (double)lever.angle));
        speed_error = fmax(speed_error, fabs(motion->omega - (double)lever.speed));
        // the control: the motion a thousandth of a period later
        const Lever late = follow(lever, lever.time + 1e-3L * PERIOD);
        other = fmax(other, fabs(motion->omega - (double)late.speed));
    }
    const Motion *last = trajectory_motion(run, run->sample_count - 1, 0);
    print_message("# off by %.3g rad, %.3g rad/s over %d periods, %zu impacts\n", angle_error,
                  speed_error, PERIODS, run->joints[0].impacts);
    assert_true(angle_error < 1e-12 && speed_error < 1e-9);
    assert_true(other > 1e-3);
    assert_near(last->omega, (double)start.speed, 1e-9);
    // the same impacts in each period
    assert_int_equal(run->joints[0].impacts % PERIODS, 0);
    trajectory_destroy(run);
}

// Constants by a torque to one side and then to the other, what has backlash moves by the gap and
// twice what the flanks give way.
static void a_reversed_torque_moves_a_hinge_by_its_gap_and_what_the_flanks_give(void **state)
{
    (void)state;
    const Lever rest = {.phase = FREE};
    Scenario scenario = scenario_of(&rest);
    const double torque = 0.8;
    TimeTable *table = &scenario.linkage.torque.table;
    *table = (TimeTable){
        .count = 4,
        .times = {0.5, 1.0, 1.5, 2.0},
        .values = {torque, torque, -torque, -torque},
    };
    scenario.linkage.torsion_count = 1;
    scenario.linkage.torsions[0] = (TorsionSpring){.name = "grease", .damping = 1.0};
    scenario.run.duration = 3.0;
    scenario.run.samples = 300;
    for (int i = 0; i < 2; i++) {
        const double gap = i == 0 ? 0.02 : 0.0;
        scenario.linkage.joints[0].limits.backlash = gap;
        Trajectory *run = complete_run(&scenario, BACKEND_REFERENCE);
        const double to = trajectory_motion(run, 100, 0)->angle;
        const double fro = trajectory_motion(run, 300, 0)->angle;
        const double lost = to - fro - 2.0 * torque / (double)STIFFNESS;
        assert_near(lost, gap, 1e-12);
        // the control: what is lost without load
        assert_true(fabs(to - fro - gap) > 1e-4);
        trajectory_destroy(run);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_flank_chatters_in_the_periodic_motion_that_shooting_finds),
        cmocka_unit_test(a_reversed_torque_moves_a_hinge_by_its_gap_and_what_the_flanks_give),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
