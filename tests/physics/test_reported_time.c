// Is a contact that is under way at run.report-from cut there?
//
// Two truths in closed form. A mass m that lies on a spring presses on it with m g all the time:
//     share of contact 1,  impulse m g (end - from)
// A mass that flies onto a spring of stiffness k with the speed v is in contact for half a period
// of w = sqrt(k / m), with the force m v w sin(phase). Cut at a phase c, what is left is
//     duration (pi - c) / w,  impulse m v (1 + cos c),  largest force m v w, or m v w sin c behind
//     the peak
// The control is the same run reported from its start.
#include "complete_run.h"
#include "load_case.h"

#include "run/registry.h"
#include "run/run.h"

#include <stdio.h>

static const double MASS = 2.0;    // kg
static const double GRAVITY = 9.8; // m/s^2
static const double STIFFNESS = 2e4;
static const double RATE = 100.0; // rad/s, sqrt(STIFFNESS / MASS)
static const double SPEED = 0.5;  // m/s
static const double FLIGHT_S = 0.01;
enum { STOP = 1 }; // the joint's number
static const double END_S = 0.06;

// How it is computed, and how far its impulses may be off, 1: rows of a whole step see a contact of
// 31 ms begin up to two steps of 20 us late, and end as late.
typedef struct Way {
    const Solver *solver;
    const char *settings[3];
    size_t count;
    double tolerance;
} Way;

static const Way WAYS[] = {
    {&REFERENCE_SOLVER, {"run.start=centred"}, 1, 1e-9},
    {&ODE_SOLVER, {"run.step=100us"}, 1, 1e-6},
    {&ODE_SOLVER, {"run.step=20us", "ode.stepping=staggered", "ode.map=midpoint"}, 3, 5e-3},
    {&ODE_SOLVER, {"run.step=20us", "ode.stepping=plain", "ode.map=textbook"}, 3, 5e-3},
};
enum { WAY_COUNT = sizeof WAYS / sizeof *WAYS };

// A mass above a spring, or on it, and the run of it that is reported from a time on.
static Trajectory *run_mass(const Way *way, bool is_resting, double from_s)
{
    const double height = is_resting ? 0.0 : SPEED * FLIGHT_S;
    char text[1024];
    const int length = snprintf(
        text, sizeof text,
        "gravity: %.17g m/s^2\n"
        "bodies:\n"
        "  mass: {mass: %.17g kg, inertia: 1 kg m^2, at: [0 m, %.17g m], velocity: [0 m/s, %.17g "
        "m/s]}\n"
        "joints:\n"
        "  rail: {between: [ground, mass], at: [0 m, 0 m], along: 90 deg}\n"
        "  stop: {between: [ground, mass], at-a: [0 m, 0 m], at-b: [0 m, %.17g m], normal: 90 "
        "deg,\n"
        "         stiffness: %.17g N/m, viscous-coefficient: %.17g N s/m}\n"
        "run: {duration: %.17g s, samples: 7, report-from: %.17g s}\n",
        is_resting ? GRAVITY : 0.0, MASS, height, is_resting ? 0.0 : -SPEED, height, STIFFNESS,
        is_resting ? 2.0 * MASS * RATE : 1e-9, is_resting ? 0.5 : END_S, from_s);
    Scenario scenario;
    Err err = {0};
    if (!casefile_load_text("mass.yaml", text, (size_t)length, way->settings, way->count, &scenario,
                            &err)) {
        fail_msg("%s", err.text);
    }
    scenario.run.keeps_contacts = true;
    Trajectory *run = run_scenario(&scenario, way->solver, (RunWatch){.progress = NULL});
    if (!run->is_complete) {
        fail_msg("%s", run->message);
    }
    scenario_free(&scenario);
    return run;
}

static void what_rests_is_in_contact_all_the_time(void **state)
{
    (void)state;
    for (size_t i = 0; i < WAY_COUNT; i++) {
        // of what the start has stirred exp(-40) is left
        const double from_s = 0.41237;
        Trajectory *run = run_mass(&WAYS[i], true, from_s);
        const JointExtremes *joint = &run->joints[STOP];
        const double force = MASS * GRAVITY;
        assert_true(trajectory_contact_share(run, STOP) <= 1.0);
        assert_close(trajectory_contact_share(run, STOP), 1.0, 1e-12);
        assert_close(joint->impulse, force * (run->duration_s - from_s), WAYS[i].tolerance);
        assert_close(joint->force_max.value, force, WAYS[i].tolerance);
        assert_int_equal(joint->impacts, 0);
        assert_int_equal(run->contact_count, 0);
        trajectory_destroy(run);
    }
}

// Against the half of a sine, with the largest force of the time after the cut.
static void check_cut(const Way *way, double phase)
{
    Trajectory *run = run_mass(way, false, FLIGHT_S + phase / RATE);
    const JointExtremes *joint = &run->joints[STOP];
    const double momentum = MASS * SPEED;
    const double step_s = run->step_s;
    const double most = momentum * RATE * (phase < 0.5 * M_PI ? 1.0 : sin(phase));
    // which a run of steps sees begin and end at a step

    assert_true(fabs(joint->contact_time - (M_PI - phase) / RATE) <= 2.0 * step_s + 1e-10);
    assert_close(joint->impulse, momentum * (1.0 + cos(phase)), way->tolerance);
    assert_close(joint->force_max.value, most, way->tolerance);
    assert_true(joint->force_max.time_s >= FLIGHT_S + phase / RATE);
    assert_close(joint->penetration_max.value, most / STIFFNESS, way->tolerance);
    assert_int_equal(joint->impacts, 0);
    assert_int_equal(joint->spike_count, 0);
    assert_int_equal(run->contact_count, 0);
    trajectory_destroy(run);
}

static void a_contact_is_cut_where_the_reported_time_begins(void **state)
{
    (void)state;
    for (size_t i = 0; i < WAY_COUNT; i++) {
        check_cut(&WAYS[i], 0.31234 * M_PI);
        check_cut(&WAYS[i], 0.71234 * M_PI);
    }
}

static void from_the_start_on_it_is_whole(void **state)
{
    (void)state;
    for (size_t i = 0; i < WAY_COUNT; i++) {
        Trajectory *run = run_mass(&WAYS[i], false, 0.0);
        const JointExtremes *joint = &run->joints[STOP];
        assert_close(joint->impulse, 2.0 * MASS * SPEED, WAYS[i].tolerance);
        assert_close(joint->force_max.value, MASS * SPEED * RATE, WAYS[i].tolerance);
        assert_int_equal(joint->impacts, 1);
        assert_int_equal(run->contact_count, 1);
        trajectory_destroy(run);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_rests_is_in_contact_all_the_time),
        cmocka_unit_test(a_contact_is_cut_where_the_reported_time_begins),
        cmocka_unit_test(from_the_start_on_it_is_whole),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
