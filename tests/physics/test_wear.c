// Do the sums of what wears a pin agree with the closed form of a journal, and with the energy that
// friction takes in a run?
//
// A weight hangs with its hole on the pin of a crank that turns about the pin's own middle. The
// wall carries m g in all, its normal part m g / sqrt(1 + mu^2); the pin slides with omega R
// everywhere.
#include "close.h"
#include "complete_run.h"
#include "load_case.h"
#include "sample.h"

#include "measure/wear.h"

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
    Scenario scenario;
    Err err = {0};
    if (!casefile_load_text("case.yaml", text, strlen(text), NULL, 0, &scenario, &err)) {
        fail_msg("%s", err.text);
    }
    return kept_instead(&scenario);
}

static Wear wear_of_pin(double friction, BackendKind backend, double *friction_energy)
{
    const Scenario scenario = hanging_weight(friction);
    Trajectory *run = complete_run(&scenario, backend);
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
        cmocka_unit_test(without_friction_no_work_is_told),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
