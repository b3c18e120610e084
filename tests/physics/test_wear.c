// Do the sums of what wears a pin agree with the closed forms of a journal and of an impact, and
// with the energy that friction takes in a run?
//
// A weight hangs with its hole on the pin of a crank that turns about the pin's own middle. The
// wall carries m g in all, its normal part m g / sqrt(1 + mu^2); the pin slides with omega R
// everywhere.
// A pin that spins flies at the wall of its hole, with nothing else acting. The normal impulse of
// its impact is P = m (1 + e) v. While it slides friction is mu N, and the sliding speed u falls by
// mu P / m_t in all, with 1 / m_t = 1 / m + R^2 / I: friction takes mu P (u - mu P / (2 m_t)).
#include "close.h"
#include "load_case.h"
#include "sample.h"

#include "contact/touch.h"
#include "measure/wear.h"
#include "run/registry.h"
#include "run/tracer.h"

#include <stdio.h>
#include <string.h>

static const double MASS = 2.0;               // kg
static const double GRAVITY = 9.81;           // m/s^2
static const double RADIUS = 10e-3;           // m, of the pin
static const double WIDTH = 15e-3;            // m
static const double OMEGA = 2.0 * M_PI * 5.0; // rad/s

// The radii of pin and hole differ by so much: a sum with the other is off by it. Friction excites
// a small whirl, which adds 3e-4 to the mean force at 0.03, and 3e-3 at 0.3.
static const double WEAR_NEAR = 2e-3;
static const double WEAR_NEAR_ROUGH = 5e-3;

// A run that is complete, with what wears in it.
static Trajectory *looked_into(const Scenario *scenario, BackendKind backend)
{
    Trajectory *run = tracer_run(scenario, registry_solver(backend), (RunWatch){NULL, NULL});
    if (!run->is_complete) {
        fail_msg("%s", run->message);
    }
    return run;
}

static Scenario case_of(const char *text)
{
    Scenario scenario;
    Err err = {0};
    if (!casefile_load_text("case.yaml", text, strlen(text), NULL, 0, &scenario, &err)) {
        fail_msg("%s", err.text);
    }
    return kept_instead(&scenario);
}

static Scenario hanging_weight(double friction)
{
    char text[2048];
    snprintf(text, sizeof text,
             "bodies:\n  crank: {mass: 1 kg, inertia: 1000 kg mm^2, at: [0 mm, 0 mm]}\n"
             "  weight: {mass: 2 kg, inertia: 5000 kg mm^2, at: [0 mm, -200 mm]}\n"
             "joints:\n  shaft: {between: [ground, crank], at: [0 mm, 0 mm]}\n"
             "  pin: {between: [weight, crank], at: [0 mm, 0 mm], "
             "hole: 20.04 mm, pin: 20 mm, width: 15 mm, start: [0 mm, 0.02 mm]}\n"
             "drive: {joint: shaft, speed: 300 rpm}\n"
             "gravity: 9.81 m/s^2\n"
             "contact: {law: johnson, friction: %g, restitution: 0.2}\n"
             "run: {revolutions: 8, report-from: 4 revolutions, samples: 720, step: 50 us}\n",
             friction);
    return case_of(text);
}

static Wear wear_of_pin(double friction, BackendKind backend, double *friction_energy)
{
    const Scenario scenario = hanging_weight(friction);
    Trajectory *run = looked_into(&scenario, backend);
    const Wear wear = wear_of(run, 1);
    *friction_energy = run->energy.friction;
    trajectory_destroy(run);
    return wear;
}

static void a_journal_wears_as_its_closed_form(void **state)
{
    (void)state;
    const double mu = 0.03;
    double energy;
    const Wear wear = wear_of_pin(mu, BACKEND_REFERENCE, &energy);
    const double normal = MASS * GRAVITY / sqrt(1.0 + mu * mu);
    const double pressure = MASS * GRAVITY / (WIDTH * 2.0 * RADIUS);
    assert_true(wear.is_known);
    assert_close(wear.distance, 2.0 * M_PI * RADIUS, WEAR_NEAR);
    assert_close(wear.pressure, pressure, WEAR_NEAR);
    assert_close(wear.pressure_speed, pressure * OMEGA * RADIUS, WEAR_NEAR);
    assert_close(wear.friction_work, mu * normal * 2.0 * M_PI * RADIUS, WEAR_NEAR);
    // it presses the top of the hole, beside it by the angle of friction and the weight's tilt
    assert_true(fabs(wear.angle - 0.5 * M_PI) < 2.0 * M_PI / WEAR_SECTORS);
    assert_true(wear.share > 0.5);
    // the control: the force is not its normal part alone, where friction is large
    const double rough = 0.3;
    const Wear other = wear_of_pin(rough, BACKEND_REFERENCE, &energy);
    const double whole = rough * MASS * GRAVITY * 2.0 * M_PI * RADIUS;
    assert_close(other.friction_work, whole / sqrt(1.0 + rough * rough), WEAR_NEAR_ROUGH);
    assert_true(fabs(other.friction_work - whole) > 5.0 * WEAR_NEAR_ROUGH * whole);
}

// Of eight revolutions, of which the sums have the last four.
static void works_of_friction_are_the_energy_that_it_takes(void **state)
{
    (void)state;
    double energy;
    const Wear wear = wear_of_pin(0.03, BACKEND_REFERENCE, &energy);
    assert_close(8.0 * wear.friction_work, energy, WEAR_NEAR);
    const Wear ode = wear_of_pin(0.03, BACKEND_ODE, &energy);
    assert_close(ode.friction_work, wear.friction_work, WEAR_NEAR);
    assert_close(8.0 * ode.friction_work, energy, WEAR_NEAR);
}

// An impact of some 0.2 ms, of which the spinning pin's speed and friction are given.
static const double IMPACT_SPEED = 0.1;  // m/s
static const double IMPACT_SPIN = 100.0; // rad/s
static const double IMPACT_FRICTION = 0.1;
static const double IMPACT_RESTITUTION = 0.6;
static const double IMPACT_INERTIA = 400e-6; // kg m^2

// The pin is pressed into the wall by 3e-4 of its radius, which is the arm of friction.
static const double IMPACT_NEAR = 1e-3;

// Of sums over the steps in place of integrals.
static const double SUMS_NEAR = 1e-4;

// The same of ODE in space, where Simpson's rule meets the corners at both ends of an impact.
static const double SUMS_NEAR_AT_ENDS = 5e-4;

static Scenario spinning_pin(const char *space)
{
    char text[2048];
    snprintf(text, sizeof text,
             "%sbodies:\n  pin: {mass: 2 kg, inertia: %g kg m^2, at: [0 mm, 0 mm], "
             "velocity: [%g m/s, 0 m/s], spin: %g rad/s}\n"
             "joints:\n  hole: {between: [ground, pin], at: [0 mm, 0 mm], "
             "hole: 30 mm, pin: 20 mm, width: 15 mm, start: [4.99 mm, 0 mm]}\n"
             "gravity: 0 m/s^2\n"
             "contact: {law: johnson, friction: %g, restitution: %g}\n"
             "run: {duration: 4 ms, samples: 2, step: 20 us}\n",
             space, IMPACT_INERTIA, IMPACT_SPEED, IMPACT_SPIN, IMPACT_FRICTION, IMPACT_RESTITUTION);
    return case_of(text);
}

// What friction takes of the pin, as a sum over its samples has it.
static double work_at_samples(const Trajectory *run)
{
    Touch places[TOUCH_CORNERS];
    double sum = 0.0;
    touch_places(&run->linkage, 0, places);
    for (size_t k = 1; k < run->sample_count; k++) {
        const JointState *state = trajectory_state(run, k, 0);
        const Motion *motions = trajectory_motion(run, k, 0);
        const TouchPose pose = touch_pose(&run->linkage, &places[0], motions);
        if (state->is_touching && pose.has_normal) {
            sum += (run->times[k] - run->times[k - 1]) *
                   fabs(vec2_dot(vec2_perp(pose.normal), state->force_on_b) *
                        touch_sliding(&run->linkage, &places[0], &pose, motions));
        }
    }
    return sum;
}

static double work_of_impact(void)
{
    const double pushed = IMPACT_FRICTION * MASS * (1.0 + IMPACT_RESTITUTION) * IMPACT_SPEED;
    const double mobility = 1.0 / MASS + RADIUS * RADIUS / IMPACT_INERTIA;
    return pushed * (RADIUS * IMPACT_SPIN - 0.5 * pushed * mobility);
}

// In the plane and in space, where the pin presses at both ends of its hole.
static void an_impact_between_two_samples_wears_as_its_closed_form(void **state)
{
    (void)state;
    static const char *const SPACES[] = {"", "space: spatial\n"};
    static const BackendKind BACKENDS[] = {BACKEND_REFERENCE, BACKEND_ODE};
    for (size_t i = 0; i < 4; i++) {
        const BackendKind backend = BACKENDS[i / 2];
        const Scenario scenario = spinning_pin(SPACES[i % 2]);
        Trajectory *run = looked_into(&scenario, backend);
        const Wear wear = wear_of(run, 0);
        const Spike *impact = &run->joints[0].spikes[0];
        assert_int_equal(run->joints[0].impacts, 1);
        assert_close(wear.friction_work, work_of_impact(), IMPACT_NEAR);
        assert_close(wear.friction_work, run->energy.friction, SUMS_NEAR);
        // what wears is N sqrt(1 + mu^2) times the way, and friction took mu N times it
        const double mu = IMPACT_FRICTION;
        assert_close(wear.pressure_speed * run->duration_s * WIDTH * 2.0 * RADIUS,
                     work_of_impact() * sqrt(1.0 + mu * mu) / mu, IMPACT_NEAR);
        // the pin slides with what friction leaves of its speed, and presses with its impulse
        assert_close(wear.pressure * impact->duration_s * WIDTH * 2.0 * RADIUS, impact->impulse,
                     i == 3 ? SUMS_NEAR_AT_ENDS : SUMS_NEAR);
        assert_true(wear.distance < impact->duration_s * RADIUS * IMPACT_SPIN);
        assert_true(wear.distance > 0.9 * impact->duration_s * RADIUS * IMPACT_SPIN);
        // the control: a sum over the samples does not know of the impact
        assert_true(work_at_samples(run) == 0.0);
        trajectory_destroy(run);
    }
}

static void without_friction_no_work_is_told(void **state)
{
    (void)state;
    double energy;
    const Wear wear = wear_of_pin(0.0, BACKEND_REFERENCE, &energy);
    assert_true(isnan(wear.friction_work));
    assert_close(wear.pressure, MASS * GRAVITY / (WIDTH * 2.0 * RADIUS), WEAR_NEAR);
    double sum = 0.0;
    for (size_t i = 0; i < WEAR_SECTORS; i++) {
        sum += wear.sectors[i];
    }
    assert_close(sum, 1.0, 1e-12);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_journal_wears_as_its_closed_form),
        cmocka_unit_test(works_of_friction_are_the_energy_that_it_takes),
        cmocka_unit_test(an_impact_between_two_samples_wears_as_its_closed_form),
        cmocka_unit_test(without_friction_no_work_is_told),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
