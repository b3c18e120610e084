// Does a motion settle by the period of loads, of a torque, and of a soft drive with its load?
//
// The truth is the one motion of a linear oscillator, m x'' + c x' + k x = f(t), that repeats with
// a force of straight pieces of slope s: between two points, with d = c / (2 m) and
// w^2 = k / m - d^2, x is the line (f_0 - c s / k) / k + s t / k and
//     y(t) = exp(-d t) (y cos w t + (y' + d y) sin w t / w)
//     y'(t) = exp(-d t) (y' cos w t - (d y' + k y / m) sin w t / w)
// and the state at the start of the period is what it is at its end: two linear equations. Of the
// stops the force k x + c x' never leaves the pressing side, so that nothing is lost of linearity.
// The controls: the largest force of the first period, the force of a load that is followed without
// inertia, and the motion under another period.
#include "load_case.h"

#include "model/common_period.h"
#include "run/registry.h"
#include "run/run.h"
#include "run/settle.h"

#include <stdio.h>

typedef struct Oscillator {
    double m, c, k;
} Oscillator;

typedef struct Phase {
    double x, v;
} Phase;

// A force that goes from `low` to `high` in `rise_s` and back until the period is over.
typedef struct Ripple {
    double low, high, rise_s, period_s;
} Ripple;

// On by a time within a piece whose force is f0 + s t.
static Phase advance(const Oscillator *of, Phase from, double f0, double s, double t)
{
    const double d = 0.5 * of->c / of->m;
    const double w = sqrt(of->k / of->m - d * d);
    const double line = (f0 - of->c * s / of->k) / of->k;
    const double y = from.x - line;
    const double v = from.v - s / of->k;
    const double fall = exp(-d * t);
    return (Phase){
        line + s * t / of->k + fall * (y * cos(w * t) + (v + d * y) / w * sin(w * t)),
        s / of->k + fall * (v * cos(w * t) - (d * v + of->k / of->m * y) / w * sin(w * t)),
    };
}

// From the start of a period to a time in it.
static Phase within(const Oscillator *of, const Ripple *ripple, Phase start, double t)
{
    const double up = (ripple->high - ripple->low) / ripple->rise_s;
    const double down = (ripple->low - ripple->high) / (ripple->period_s - ripple->rise_s);
    if (t <= ripple->rise_s) {
        return advance(of, start, ripple->low, up, t);
    }
    const Phase top = advance(of, start, ripple->low, up, ripple->rise_s);
    return advance(of, top, ripple->high, down, t - ripple->rise_s);
}

static Phase start_of(const Oscillator *of, const Ripple *ripple)
{
    const Phase b = within(of, ripple, (Phase){0.0, 0.0}, ripple->period_s);
    const Phase e1 = within(of, ripple, (Phase){1.0, 0.0}, ripple->period_s);
    const Phase e2 = within(of, ripple, (Phase){0.0, 1.0}, ripple->period_s);
    // (1 - A) z = b, A by its columns
    const double a11 = 1.0 - (e1.x - b.x);
    const double a12 = -(e2.x - b.x);
    const double a21 = -(e1.v - b.v);
    const double a22 = 1.0 - (e2.v - b.v);
    const double det = a11 * a22 - a12 * a21;
    return (Phase){(b.x * a22 - b.v * a12) / det, (b.v * a11 - b.x * a21) / det};
}

// The largest k_x x + k_v v over the period: between 20,000 looks it rises by 1e-8 of itself.
static double largest(const Oscillator *of, const Ripple *ripple, double k_x, double k_v)
{
    enum { LOOKS = 20000 };
    const Phase start = start_of(of, ripple);
    double most = -INFINITY;
    for (int i = 0; i <= LOOKS; i++) {
        const Phase at = within(of, ripple, start, ripple->period_s * i / LOOKS);
        most = fmax(most, k_x * at.x + k_v * at.v);
    }
    return most;
}

static Scenario scenario_of(const char *text)
{
    Scenario scenario;
    Err err = {0};
    if (!casefile_load_text("ripple.yaml", text, strlen(text), NULL, 0, &scenario, &err)) {
        fail_msg("%s", err.text);
    }
    settle_scenario(&scenario, (RunWatch){.progress = NULL});
    if (scenario.settled.motion_count == 0) {
        fail_msg("%s: %s", scenario.settled.message, scenario.run.centred_because);
    }
    return scenario;
}

static Trajectory *complete(const Scenario *scenario, const Solver *solver)
{
    Trajectory *run = run_scenario(scenario, solver, (RunWatch){.progress = NULL});
    if (!run->is_complete) {
        fail_msg("%s", run->message);
    }
    return run;
}

// 1: of forces of the settled motion, and of ODE at steps of 20 us
static const double TOLERANCE = 1e-4;
static const double ODE_TOLERANCE = 2e-3;

// The largest force of a stop, which must press all the time.
static double pressing_force(const Oscillator *of, const Ripple *ripple)
{
    assert_true(largest(of, ripple, -of->k, -of->c) < 0.0);
    return largest(of, ripple, of->k, of->c);
}

// A run of two periods has the largest force from its start on, by both solvers.
static void check_force(const Scenario *scenario, size_t joint, double force)
{
    assert_int_equal(scenario->settled.motions[0].period, 1);
    assert_close(scenario->settled.motions[0].joints[joint].force.headline, force, TOLERANCE);
    Trajectory *run = complete(scenario, &REFERENCE_SOLVER);
    Trajectory *ode = complete(scenario, &ODE_SOLVER);
    assert_close(run->joints[joint].force_max.value, force, TOLERANCE);
    assert_close(ode->joints[joint].force_max.value, force, ODE_TOLERANCE);
    assert_true(fabs(scenario->settled.first[joint] / force - 1.0) > 1e-2);
    trajectory_destroy(run);
    trajectory_destroy(ode);
}

// A mass of 2 kg on a stop, pressed by 19.6 N and a load that takes up to 6 N of it away or adds 4.
static void a_mass_under_a_load_that_repeats(void **state)
{
    (void)state;
    const Oscillator of = {2.0, 40.0, 2e4};
    const double weight = 2.0 * 9.8;
    // resonance is at 63 ms
    static const double PERIODS[] = {0.05, 0.08};
    double forces[2];
    for (int i = 0; i < 2; i++) {
        char text[1024];
        snprintf(text, sizeof text,
                 "gravity: 9.8 m/s^2\n"
                 "bodies:\n"
                 "  mass: {mass: 2 kg, inertia: 1 kg m^2, at: [0 m, 0 m]}\n"
                 "joints:\n"
                 "  rail: {between: [ground, mass], at: [0 m, 0 m], along: 90 deg}\n"
                 "  stop: {between: [ground, mass], at-a: [0 m, 0 m], at-b: [0 m, 0 m], normal: 90 "
                 "deg,\n"
                 "         stiffness: 2e4 N/m, viscous-coefficient: 40 N s/m}\n"
                 "loads:\n"
                 "  ripple: {joint: rail, force: [[0 s, 3 N], [0.01 s, -2 N]], period: %.17g s}\n"
                 "run: {duration: %.17g s, samples: 40, step: 20 us}\n",
                 PERIODS[i], 2.0 * PERIODS[i]);
        Scenario scenario = scenario_of(text);
        const Ripple ripple = {weight - 3.0, weight + 2.0, 0.01, PERIODS[i]};
        forces[i] = pressing_force(&of, &ripple);
        check_force(&scenario, 1, forces[i]);
        scenario_free(&scenario);
    }
    // without inertia both would be the same
    assert_true(fabs(forces[0] / forces[1] - 1.0) > 1e-2);
    assert_true(fabs(forces[0] / (weight + 2.0) - 1.0) > 1e-2);
}

// An arm that a motor presses on its stop with a torque that repeats.
static void a_motor_whose_torque_repeats(void **state)
{
    (void)state;
    const Oscillator of = {0.01, 0.8, 800.0};
    const Ripple ripple = {1.0, 1.6, 0.012, 0.03};
    Scenario scenario = scenario_of(
        "gravity: 0 m/s^2\n"
        "bodies:\n"
        "  arm: {mass: 1 kg, inertia: 0.01 kg m^2, at: [0 m, 0 m]}\n"
        "joints:\n"
        "  hinge: {between: [ground, arm], at: [0 m, 0 m], low: -90 deg, high: 0 deg,\n"
        "          stiffness: 800 N m/rad, viscous-coefficient: 0.8 N m s/rad}\n"
        "drive: {joint: hinge, torque: [[0 s, 1 N m], [12 ms, 1.6 N m], [30 ms, 1 N m]],\n"
        "        period: 30 ms}\n"
        "run: {duration: 60 ms, samples: 40, step: 20 us}\n");
    check_force(&scenario, 0, pressing_force(&of, &ripple));
    scenario_free(&scenario);
}

// A rotor that follows 120 rpm through a spring, with a torque that brakes it every three quarters
// of a second: in three periods of the drive, of 0.5 s, and two of the load. Its speed is that of
// the drive and the rate of its lag. What settles is a ball on a plate beside it.
static void a_soft_drive_and_a_load_of_another_period(void **state)
{
    (void)state;
    const Oscillator of = {0.05, 0.3, 30.0};
    const Ripple ripple = {-2.0, 0.0, 0.15, 0.75};
    Scenario scenario = scenario_of(
        "gravity: 9.8 m/s^2\n"
        "bodies:\n"
        "  rotor: {mass: 1 kg, inertia: 0.05 kg m^2, at: [0 m, 0 m]}\n"
        "  ball: {mass: 1 kg, inertia: 1 kg m^2, at: [1 m, 0 m]}\n"
        "joints:\n"
        "  pivot: {between: [ground, rotor], at: [0 m, 0 m]}\n"
        "  rail: {between: [ground, ball], at: [1 m, 0 m], along: 90 deg}\n"
        "  stop: {between: [ground, ball], at-a: [1 m, 0 m], at-b: [1 m, 0 m], normal: 90 deg, "
        "stiffness: 1e4 N/m,\n"
        "         viscous-coefficient: 100 N s/m}\n"
        "drive: {joint: pivot, speed: 120 rpm, stiffness: 30 N m/rad, damping: 0.3 N m s/rad}\n"
        "loads:\n"
        "  brake: {body: rotor, torque: [[0 s, -2 N m], [0.15 s, 0 N m]], period: 0.75 s}\n"
        "run: {revolutions: 3, samples: 100}\n");
    const double speed = 4.0 * M_PI;
    assert_close(scenario_settling_period(&scenario), 1.5, 1e-12);
    const double most = speed + largest(&of, &ripple, 0.0, 1.0);
    const double least = speed - largest(&of, &ripple, 0.0, -1.0);
    Trajectory *run = complete(&scenario, &REFERENCE_SOLVER);
    assert_close(run->bodies[0].omega_max.value, most, TOLERANCE);
    assert_close(run->bodies[0].omega_min.value, least, TOLERANCE);
    assert_true(fabs(most / speed - 1.0) > 1e-2);
    trajectory_destroy(run);
    scenario_free(&scenario);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_mass_under_a_load_that_repeats),
        cmocka_unit_test(a_motor_whose_torque_repeats),
        cmocka_unit_test(a_soft_drive_and_a_load_of_another_period),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
