// Runs cases on an engine in a test, and holds what came of it against a truth.
#pragma once

#include "engine/driver.h"

#include "close.h"
#include "load_case.h"

#include "measure/error.h"
#include "measure/ladder.h"
#include "run/registry.h"
#include "run/run.h"
#include "run/tracer.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const RunWatch NOBODY = {NULL, NULL};
static const double LIMIT_S = 60.0; // a run takes .1 s

static inline EngineDriver engine_named(const char *name)
{
    EngineDriver driver;
    Err err = {0};
    if (!engine_find(name, &driver, &err)) {
        fail_msg("%s", err.text);
    }
    return driver;
}

typedef struct Outcome {
    TrajectoryError error;
    EngineSaid said;
    double force_ratio; // of the largest force in the first joint with play, over the reference's
} Outcome;

static inline size_t joint_with_play(const Scenario *scenario)
{
    size_t joint = 0;
    while (joint + 1 < scenario->linkage.joint_count &&
           !linkage_has_play(&scenario->linkage.joints[joint])) {
        joint++;
    }
    return joint;
}

static inline Outcome hold_against(const Scenario *scenario, Trajectory *run, BackendKind truth)
{
    Outcome outcome = {.force_ratio = 0.0};
    if (!run->is_complete) {
        fail_msg("%s", run->message);
    }
    Trajectory *reference = run_scenario(scenario, registry_solver(truth), NOBODY);
    const size_t joint = joint_with_play(scenario);
    outcome.error = error_against(run, reference, INFINITY);
    if (joint < scenario->linkage.joint_count) {
        outcome.force_ratio =
            run->joints[joint].force_max.value / reference->joints[joint].force_max.value;
    }
    trajectory_destroy(reference);
    trajectory_destroy(run);
    return outcome;
}

static inline Outcome outcome_of(const char *engine, const char *way, const Scenario *scenario,
                                 BackendKind truth)
{
    const EngineDriver driver = engine_named(engine);
    EngineSaid said;
    Trajectory *run = engine_run(&driver, way, scenario, LIMIT_S, &said);
    Outcome outcome = hold_against(scenario, run, truth);
    outcome.said = said;
    return outcome;
}

// The paper's mechanism in the motion that the figures are of: from the pin in the middle of its
// hole, one impact and its followers, in a third of a revolution.
static inline Scenario impact(double step_s)
{
    static const char *const OVERRIDES[] = {"run.start=centred", "run.revolutions=0.3",
                                            "ode.stepping=staggered", "ode.map=impulse"};
    Scenario scenario = load("cases/paper/impact-k66.yaml", OVERRIDES, 4);
    scenario.run.step = step_s;
    return scenario;
}

// Contacts within the step, as good as ODE's own up to a factor of 3: the rest of both is the same
// equations in other coordinates.
static inline void hold_kernel_against_ode(const char *engine)
{
    static const double STEPS[] = {100e-6, 50e-6, 25e-6, 10e-6, 5e-6};
    enum { COUNT = sizeof STEPS / sizeof *STEPS };
    double errors[COUNT];
    for (int i = 0; i < COUNT; i++) {
        Scenario scenario = impact(STEPS[i]);
        const Outcome kernel = outcome_of(engine, "kernel", &scenario, BACKEND_REFERENCE);
        const Outcome ode =
            hold_against(&scenario, run_scenario(&scenario, registry_solver(BACKEND_ODE), NOBODY),
                         BACKEND_REFERENCE);
        errors[i] = kernel.error.omega_max;
        if (!(errors[i] <= 3.0 * ode.error.omega_max)) {
            fail_msg("at %g us %g against ODE's %g", 1e6 * STEPS[i], errors[i],
                     ode.error.omega_max);
        }
        assert_close(kernel.force_ratio, 1.0, STEPS[i] < 11e-6 ? 1e-3 : 0.05);
    }
    // from end to end, for where samples fall in the steps changes single errors by two
    const double order = log(errors[0] / errors[COUNT - 1]) / log(STEPS[0] / STEPS[COUNT - 1]);
    assert_true(order > 2.0);
    // the control: the law as a force
    Scenario scenario = impact(10e-6);
    const Outcome force = outcome_of(engine, "force", &scenario, BACKEND_REFERENCE);
    assert_true(force.error.omega_max > 10.0 * errors[3]);
}

// As a backend, whose steps are those that the driver tells of: the contacts within them, their
// peaks and onsets, and the spikes of the accelerations are the reference's.
static inline void hold_contacts(BackendKind backend)
{
    Scenario scenario = impact(10e-6);
    Trajectory *truth =
        run_guarded(&scenario, registry_solver(BACKEND_REFERENCE), NOBODY, &TRACER_PROBE, NULL);
    scenario.engines[backend].way = ENGINE_WAY_KERNEL;
    Trajectory *run = run_guarded(&scenario, registry_solver(backend), NOBODY, &TRACER_PROBE, NULL);
    if (!run->is_complete) {
        fail_msg("%s", run->message);
    }
    const size_t joint = joint_with_play(&scenario);
    const JointExtremes *known = &truth->joints[joint];
    const JointExtremes *found = &run->joints[joint];
    assert_int_equal(found->impacts, known->impacts);
    assert_close(found->force_max.value, known->force_max.value, 1e-3);
    assert_close(found->penetration_max.value, known->penetration_max.value, 1e-3);
    assert_close(found->impulse, known->impulse, 1e-3);
    assert_int_equal(found->spike_count, known->spike_count);
    for (size_t i = 0; i < known->spike_count; i++) {
        assert_near(found->spikes[i].onset_s, known->spikes[i].onset_s, 10e-6);
        assert_near(found->spikes[i].approach_speed, known->spikes[i].approach_speed, 2e-3);
    }
    for (size_t i = 0; i < truth->body_count; i++) {
        assert_int_equal(run->alpha_spikes[i].count, truth->alpha_spikes[i].count);
        // means over local steps of some microseconds, of pulses of 100 us: (h/T)^2
        assert_close(run->bodies[i].alpha_max.value + 1.0, truth->bodies[i].alpha_max.value + 1.0,
                     2e-2);
    }
    assert_true(isnan(run->energy.drive_work) && run->engine.name[0] != '\0');
    trajectory_destroy(run);
    // the control: the law as a force, at a coarser step, misses the contact by more than that
    scenario.run.step = 50e-6;
    scenario.engines[backend].way = ENGINE_WAY_FORCE;
    run = run_guarded(&scenario, registry_solver(backend), NOBODY, &TRACER_PROBE, NULL);
    assert_true(!run->is_complete ||
                fabs(run->joints[joint].spikes[0].approach_speed -
                     known->spikes[0].approach_speed) > 2e-3 ||
                fabs(run->joints[joint].force_max.value / known->force_max.value - 1.0) > 1e-3);
    trajectory_destroy(run);
    trajectory_destroy(truth);
}

// The run of a case that is changed, against the reference's of the case as it is.
static inline double omega_error(const char *engine, const char *way, const Scenario *changed,
                                 const Scenario *scenario)
{
    const EngineDriver driver = engine_named(engine);
    Trajectory *run = engine_run(&driver, way, changed, LIMIT_S, NULL);
    return hold_against(scenario, run, BACKEND_REFERENCE).error.omega_max;
}

// The same of all speeds.
static inline double max_error(const char *engine, const char *way, const Scenario *changed,
                               const Scenario *scenario)
{
    const EngineDriver driver = engine_named(engine);
    Trajectory *run = engine_run(&driver, way, changed, LIMIT_S, NULL);
    return hold_against(scenario, run, BACKEND_REFERENCE).error.max;
}

// The errors of a case at a step and a shorter one, at which the scenario is left, and the order of
// the error between them.
typedef struct Refined {
    double coarse;
    double fine;
    double order;
} Refined;

static inline Refined refined(const char *engine, const char *way, Scenario *scenario,
                              double coarse_s, double fine_s)
{
    scenario->run.step = coarse_s;
    const double coarse = omega_error(engine, way, scenario, scenario);
    scenario->run.step = fine_s;
    const double fine = omega_error(engine, way, scenario, scenario);
    return (Refined){coarse, fine, log(coarse / fine) / log(coarse_s / fine_s)};
}

// A slider-crank without play in a way, with the most that it may be off; and with play, contacts
// within the step, where every engine has the same errors, of order 2, to steps of 1 us.
static inline void hold_slider_crank(const char *engine, const char *way, double step_s,
                                     double most)
{
    Scenario slider = load("cases/mechanisms/slider-crank.yaml", NULL, 0);
    slider.run.step = step_s;
    const Outcome ideal = outcome_of(engine, way, &slider, BACKEND_ANALYTIC);
    assert_true(ideal.error.max < most);
    // along another line, which lies in none of the world's axes
    static const char *const TURNED[] = {"slider-crank.angle=-60 deg"};
    Scenario turned = load("cases/mechanisms/slider-crank.yaml", TURNED, 1);
    turned.run.step = step_s;
    const Outcome along = outcome_of(engine, way, &turned, BACKEND_ANALYTIC);
    if (!(along.error.max < most)) {
        fail_msg("%s, slider at -60 deg: off by %g", engine, along.error.max);
    }
    Scenario pin = load_with("cases/mechanisms/slider-crank-pin.yaml", "run.revolutions=0.1");
    const Refined error = refined(engine, "kernel", &pin, 10e-6, 1e-6);
    if (!(error.order > 1.8) || !(error.fine < 1e-7)) {
        fail_msg("%s, pin of the slider: %g at 10 us, %g at 1", engine, error.coarse, error.fine);
    }
}

// A number between two, drawn from a seed.
static inline double drawn(unsigned *seed, double from, double to)
{
    *seed = *seed * 1664525u + 1013904223u;
    return from + (to - from) * (double)(*seed >> 8) / (double)(1 << 24);
}

typedef struct Turned {
    double angle; // rad, of the whole mechanism and of gravity
    char text[64];
} Turned;

static inline const char *turned_point(Turned *by, double x, double y)
{
    snprintf(by->text, sizeof by->text, "[%.15g mm, %.15g mm]",
             x * cos(by->angle) - y * sin(by->angle), x * sin(by->angle) + y * cos(by->angle));
    return by->text;
}

// Cranks that push a slider, the same for a seed at any angle of the whole: a slider-crank along a
// line of the ground, its slider's centre of mass beside the pin, or a slider on a rocker, with the
// line on either of them. There is play in the crank's pin.
static inline Scenario random_slider(unsigned seed, double angle)
{
    const bool is_swinging = seed % 2 == 1;
    const double crank = drawn(&seed, 20.0, 60.0);
    const double length = drawn(&seed, 100.0, 200.0);
    const double start = drawn(&seed, -2.0, 2.0);
    const double pin[2] = {crank * cos(start), crank * sin(start)};
    const double end = pin[0] + sqrt(length * length - pin[1] * pin[1]);
    const double beside[2] = {drawn(&seed, -30.0, 30.0), drawn(&seed, -20.0, 20.0)};
    const double line = is_swinging ? atan2(pin[1] + length, pin[0]) : 0.0;
    const double at[2] = {is_swinging ? pin[0] : end, is_swinging ? pin[1] : 0.0};
    const bool is_other = drawn(&seed, 0.0, 1.0) < 0.5;
    Turned turned[6];
    for (size_t i = 0; i < sizeof turned / sizeof *turned; i++) {
        turned[i].angle = angle;
    }
    char text[2048];
    int size = snprintf(
        text, sizeof text,
        "bodies:\n  crank: {mass: 0.3 kg, inertia: 100 kg mm^2, at: %s, angle: %.15g rad}\n"
        "  bar: {mass: %.15g kg, inertia: 250 kg mm^2, at: %s, angle: %.15g rad}\n"
        "  slider: {mass: %.15g kg, inertia: 80 kg mm^2, at: %s, angle: %.15g rad}\n"
        "joints:\n  shaft: {between: [ground, crank], at: %s}\n",
        turned_point(&turned[0], 0.5 * pin[0], 0.5 * pin[1]), angle + drawn(&seed, -3.0, 3.0),
        drawn(&seed, 0.1, 0.4),
        turned_point(&turned[1], is_swinging ? 10.0 : 0.5 * (pin[0] + end), 0.5 * pin[1]),
        angle + drawn(&seed, -3.0, 3.0), drawn(&seed, 0.05, 0.3),
        turned_point(&turned[2], at[0] + beside[0], at[1] + beside[1]),
        angle + drawn(&seed, -3.0, 3.0), turned_point(&turned[3], 0.0, 0.0));
    size += snprintf(text + size, sizeof text - (size_t)size,
                     "  pin: {between: [crank, %s], at: %s, radial-clearance: %.15g mm}\n"
                     "  other: {between: %s, at: %s}\n"
                     "  line: {between: %s, at: %s, along: %.15g rad}\n",
                     is_swinging ? "slider" : "bar", turned_point(&turned[0], pin[0], pin[1]),
                     drawn(&seed, 0.03, 0.2), is_swinging ? "[bar, ground]" : "[bar, slider]",
                     turned_point(&turned[1], is_swinging ? 0.0 : end, is_swinging ? -length : 0.0),
                     !is_swinging ? "[ground, slider]"
                     : is_other   ? "[slider, bar]"
                                  : "[bar, slider]",
                     turned_point(&turned[2], at[0], at[1]), remainder(line + angle, 2.0 * M_PI));
    snprintf(text + size, sizeof text - (size_t)size,
             "drive: {joint: shaft, speed: %.15g rpm}\n"
             "gravity: [%.15g m/s^2, %.15g m/s^2]\n"
             "contact: {stiffness: 6.6e10 N/m^1.5, restitution: 0.9}\n"
             "run: {revolutions: 0.05, samples: 2000, start: centred, step: 10 us}\n",
             drawn(&seed, 300.0, 1000.0), 9.81 * sin(angle), -9.81 * cos(angle));
    Scenario read;
    Err err = {0};
    if (!casefile_load_text("sliders", text, strlen(text), NULL, 0, &read, &err)) {
        fail_msg("%s", err.text);
    }
    return kept_instead(&read);
}

// Sliders of any direction, on the ground and on bodies, contacts within the step: in the mean as
// good as ODE's own up to a factor of 3, for single ones depend on where samples fall; and each
// turned as a whole by any angle with the same error, but for where roundings put local steps. The
// control: the line in another direction by a thousandth.
static inline void hold_random_sliders(const char *engine, unsigned seed)
{
    enum { COUNT = 6 };
    double ratios = 0.0;
    for (unsigned i = seed; i < seed + COUNT; i++) {
        const Scenario flat = random_slider(i, 0.0);
        unsigned other = i;
        const Scenario turned = random_slider(i, drawn(&other, -3.0, 3.0));
        const double ode =
            hold_against(&flat, run_scenario(&flat, registry_solver(BACKEND_ODE), NOBODY),
                         BACKEND_REFERENCE)
                .error.omega_max;
        const Outcome outcome = outcome_of(engine, "kernel", &flat, BACKEND_REFERENCE);
        const double errors[2] = {outcome.error.omega_max,
                                  omega_error(engine, "kernel", &turned, &turned)};
        // which is between the steps and local steps: these alone are low by up to 4e-3
        if (!(fabs(outcome.force_ratio - 1.0) <= 1e-5)) {
            fail_msg("slider %u: largest force off by %g", i, outcome.force_ratio - 1.0);
        }
        ratios += log(errors[0] / ode) / COUNT;
        if (!(errors[1] <= 2.0 * errors[0]) || !(errors[0] <= 2.0 * errors[1])) {
            fail_msg("slider %u: %g, turned %g", i, errors[0], errors[1]);
        }
        Scenario changed = kept_copy(&turned);
        changed.linkage.joints[3].direction += 1e-3;
        assert_true(omega_error(engine, "kernel", &changed, &turned) > 10.0 * errors[1]);
    }
    if (!(exp(ratios) <= 3.0)) {
        fail_msg("random sliders: %g times ODE's error", exp(ratios));
    }
}

// Forces of steps of a fiftieth of a contact, between which the largest is found to 1e-5: at the
// steps themselves it is low by up to an eighth of the square of half a step's phase, 5e-4.
static inline void hold_largest_force(const char *engine, const char *way)
{
    for (unsigned i = 31; i < 35; i++) {
        Scenario scenario = random_slider(i, 0.0);
        scenario.run.step = 1e-6;
        const Outcome outcome = outcome_of(engine, way, &scenario, BACKEND_REFERENCE);
        if (!(fabs(outcome.force_ratio - 1.0) <= 1e-5)) {
            fail_msg("slider %u: largest force off by %g", i, outcome.force_ratio - 1.0);
        }
    }
}

// A crank-rocker with play from rest, by a torque over time, with a spring and two dampers.
static inline Scenario sprung(double step_s)
{
    static const char *const OVERRIDES[] = {"run.duration=0.03 s", "run.samples=300",
                                            "ode.stepping=staggered", "ode.map=impulse"};
    Scenario scenario = load("cases/mechanisms/run-up.yaml", OVERRIDES, 4);
    scenario.run.step = step_s;
    return scenario;
}

// Springs, dampers and a drive's torque beside contacts within the step: as good as ODE's own up to
// a factor of 3, of its order, and without any one of them wrong.
static inline void hold_springs(const char *engine)
{
    // longer ones see the first touches from rest as single samples fall, ODE's best by chance
    static const double STEPS[] = {20e-6, 5e-6};
    double errors[2];
    for (int i = 0; i < 2; i++) {
        const Scenario scenario = sprung(STEPS[i]);
        const double ode =
            hold_against(&scenario, run_scenario(&scenario, registry_solver(BACKEND_ODE), NOBODY),
                         BACKEND_REFERENCE)
                .error.omega_max;
        errors[i] = omega_error(engine, "kernel", &scenario, &scenario);
        if (!(errors[i] <= 3.0 * ode)) {
            fail_msg("at %g us %g against ODE's %g", 1e6 * STEPS[i], errors[i], ode);
        }
    }
    if (!(log(errors[0] / errors[1]) / log(4.0) > 1.8)) {
        fail_msg("springs: %g at 20 us, %g at 5", errors[0], errors[1]);
    }
    const Scenario scenario = sprung(5e-6);
    Scenario changed = scenario;
    changed.linkage.spring_count = 0;
    assert_true(omega_error(engine, "kernel", &changed, &scenario) > 100.0 * errors[1]);
    changed = scenario;
    changed.linkage.torsion_count = 0;
    assert_true(omega_error(engine, "kernel", &changed, &scenario) > 100.0 * errors[1]);
}

// Springs, dampers and torques of any size, against ODE's errors in the mean, for single ones
// depend on where samples fall: stiffness, damping and torque change by up to 4 times.
static inline void hold_random_springs(const char *engine, unsigned seed)
{
    double ratios = 0.0;
    for (int i = 0; i < 3; i++) {
        Scenario scenario = sprung(20e-6);
        double *const numbers[] = {
            &scenario.linkage.springs[0].stiffness, &scenario.linkage.springs[0].damping,
            &scenario.linkage.torsions[0].damping, &scenario.linkage.torque.table.values[1]};
        for (size_t k = 0; k < sizeof numbers / sizeof *numbers; k++) {
            *numbers[k] *= pow(4.0, drawn(&seed, -1.0, 1.0));
        }
        const double ode =
            hold_against(&scenario, run_scenario(&scenario, registry_solver(BACKEND_ODE), NOBODY),
                         BACKEND_REFERENCE)
                .error.omega_max;
        ratios += log(omega_error(engine, "kernel", &scenario, &scenario) / ode) / 3.0;
    }
    if (!(exp(ratios) <= 3.0)) {
        fail_msg("random springs: %g times ODE's error", exp(ratios));
    }
}

// A motor and a load over the crank's angle, on ideal joints: the least order of a way, whose error
// at a step is known, and without the load a wrong result.
static inline void hold_load(const char *engine, const char *way, double step_s, double order,
                             double error)
{
    static const char *const OVERRIDES[] = {"run.duration=0.25 s", "run.samples=300"};
    Scenario scenario = load("cases/mechanisms/motor-flywheel.yaml", OVERRIDES, 2);
    const Refined found = refined(engine, way, &scenario, step_s, 0.5 * step_s);
    if (!(found.order > order - 0.3) || !(found.coarse < error)) {
        fail_msg("%s %s: order %g, error %g", engine, way, found.order, found.coarse);
    }
    Scenario changed = scenario;
    changed.linkage.load_count = 0;
    assert_true(omega_error(engine, way, &changed, &scenario) > 5.0 * found.coarse);
}

// A link on the ground's bushing that carries another by one with curves, whose axes turn with it:
// the least order of a way, whose error at a step is known, and without the dampers a wrong result.
static inline void hold_bushings(const char *engine, const char *way, double step_s, double order,
                                 double error)
{
    static const char TEXT[] =
        "bodies:\n"
        "  arm: {mass: 1 kg, inertia: 0.02 kg m^2, at: [0.2 m, 0 m]}\n"
        "  tip: {mass: 0.5 kg, inertia: 0.01 kg m^2, at: [0.4 m, -0.2 m], angle: -90 deg}\n"
        "bushings:\n"
        "  root: {between: [arm, ground], at: [0 m, 0 m], stiffness: [4e3 N/m, 9e3 N/m],\n"
        "         damping: [20 N s/m, 40 N s/m], direction: 20 deg, torsional-damping: 0.1 N m "
        "s/rad}\n"
        "  knee: {between: [arm, tip], at-a: [0.4 m, 0 m], at-b: [0.401 m, 0.001 m],\n"
        "         damping: 10 N s/m, interpolation: smooth, angle: -85 deg,\n"
        "         force-x: [[-5 mm, -30 N], [0 mm, 0 N], [5 mm, 10 N]],\n"
        "         force-y: [[-5 mm, -10 N], [0 mm, 0 N], [5 mm, 40 N]],\n"
        "         torque: [[-20 deg, -1 N m], [0 deg, 0 N m], [20 deg, 2 N m]]}\n"
        "run: {duration: 0.3 s, samples: 100}\n";
    Scenario read;
    Err err = {0};
    if (!casefile_load_text("bushings", TEXT, strlen(TEXT), NULL, 0, &read, &err)) {
        fail_msg("%s", err.text);
    }
    Scenario scenario = kept_instead(&read);
    const Refined found = refined(engine, way, &scenario, step_s, 0.5 * step_s);
    if (!(found.order > order - 0.3) || !(found.coarse < error)) {
        fail_msg("%s %s: order %g, error %g", engine, way, found.order, found.coarse);
    }
    Scenario changed = kept_copy(&scenario);
    changed.linkage.bushings[1].damping = (Vec2){0.0, 0.0};
    assert_true(omega_error(engine, way, &changed, &scenario) > 5.0 * found.coarse);
    changed.linkage.bushings[1] = scenario.linkage.bushings[1];
    changed.linkage.bushings[1].torque.count = 0;
    assert_true(omega_error(engine, way, &changed, &scenario) > 5.0 * found.coarse);
}

// Friction that sticks, at both ends of a rod: as good as in ODE, and not what creeps.
static inline void hold_stick(const char *engine)
{
    static const char TEXT[] =
        "slider-crank:\n"
        "  crank: {length: 50 mm, mass: 0.3 kg, inertia: 100 kg mm^2}\n"
        "  rod: {length: 140 mm, mass: 0.2 kg, inertia: 250 kg mm^2}\n"
        "  slider: {mass: 0.2 kg, inertia: 100 kg mm^2}\n"
        "joints:\n"
        "  crank-rod: {radial-clearance: 50 um, width: 20 mm}\n"
        "  rod-slider: {radial-clearance: 50 um, width: 20 mm}\n"
        "drive: {speed: 500 rpm}\n"
        "contact: {stiffness: 2e10 N/m^1.5, restitution: 0.3, friction: 0.15, friction-law: stick, "
        "resting-speed: none}\n"
        "run: {start: centred, revolutions: 0.2, samples: 300, step: 20 us}\n";
    static const char *const CREEPS[] = {"contact.friction-law=regularized"};
    Scenario read[2];
    Err err = {0};
    for (size_t i = 0; i < 2; i++) {
        if (!casefile_load_text("stick", TEXT, strlen(TEXT), CREEPS, i, &read[i], &err)) {
            fail_msg("%s", err.text);
        }
    }
    const Scenario scenario = kept_instead(&read[0]);
    const Scenario creeping = kept_instead(&read[1]);
    const double ode =
        hold_against(&scenario, run_scenario(&scenario, registry_solver(BACKEND_ODE), NOBODY),
                     BACKEND_REFERENCE)
            .error.max;
    const double kernel = max_error(engine, "kernel", &scenario, &scenario);
    const double control = max_error(engine, "kernel", &creeping, &scenario);
    if (!(kernel <= 3.0 * ode) || !(control > 100.0 * kernel)) {
        fail_msg("%s: sticks to %g, ODE to %g, creeping to %g", engine, kernel, ode, control);
    }
}

// Friction of 1 in the pin, contacts within the step and as a force.
static inline void hold_friction(const char *engine)
{
    hold_stick(engine);
    Scenario scenario = load_with("cases/hard/friction-1.yaml", "run.revolutions=0.1");
    const Refined error = refined(engine, "kernel", &scenario, 50e-6, 12.5e-6);
    if (!(error.order > 1.5) || !(error.fine < 1e-5)) {
        fail_msg("friction: %g at 50 us, %g at 12.5", error.coarse, error.fine);
    }
    Scenario changed = scenario;
    changed.contact.friction = 0.0;
    assert_true(omega_error(engine, "kernel", &changed, &scenario) > 100.0 * error.fine);
    // as a force: less of it, for the steps do not resolve how sticking begins
    static const char *const OVERRIDES[] = {"run.revolutions=0.05", "contact.friction=0.1"};
    scenario = load("cases/hard/friction-1.yaml", OVERRIDES, 2);
    scenario.run.step = 1e-6;
    changed = scenario;
    changed.contact.friction = 0.0;
    const double force = omega_error(engine, "force", &scenario, &scenario);
    const double without = omega_error(engine, "force", &changed, &scenario);
    if (!(without > 3.0 * force)) {
        fail_msg("friction as a force: %g, %g without", force, without);
    }
}

// A case that has what pins in holes have not, and a change of that.
typedef struct WholeCase {
    const char *path;
    const char *length; // of the run
    const char *change;
} WholeCase;

// Each of these is taken whole: contacts within the step, as good as ODE's own up to a factor of 3,
// and with one of its own numbers changed by a little far worse.
static inline void hold_whole_cases(const char *engine)
{
    static const WholeCase CASES[] = {
        {"cases/mechanisms/stop-rebound.yaml", "run.duration=0.4 s",
         "joints.hinge.stiffness=1.01e4 N m/rad"},
        {"cases/mechanisms/gear-pair.yaml", "run.duration=0.06 s", "joints.mesh.backlash=0.101 mm"},
        {"cases/mechanisms/cam-roller.yaml", "run.revolutions=0.4",
         "springs.valve-spring.stiffness=6.06 kN/m"},
        {"cases/mechanisms/planetary-gear.yaml", "run.duration=10 ms",
         "joints.outer.backlash=50.5 um"},
        {"cases/mechanisms/five-bar.yaml", "run.duration=0.1 s",
         "drives.right-pivot.profile=polynomial"},
        {"cases/mechanisms/motor-flywheel.yaml", "run.duration=0.1 s",
         "drive.no-load-speed=303 rpm"},
        {"cases/mechanisms/servo-arm.yaml", "run.duration=0.05 s", "drive.torque-limit=4.04 N m"},
        {"cases/mechanisms/rack-and-pinion.yaml", "run.duration=50 ms",
         "joints.teeth.backlash=0.101 mm"},
        {"cases/mechanisms/slider-crank-guide.yaml", "run.duration=5 ms",
         "joints.slider-guide.block=50.02 mm"},
        {"cases/mechanisms/pin-slot.yaml", "run.revolutions=0.2",
         "joints.play.slot=[40 mm, 8.21 mm]"},
    };
    for (size_t i = 0; i < sizeof CASES / sizeof *CASES; i++) {
        const WholeCase *of = &CASES[i];
        const char *const overrides[] = {of->length, "run.samples=200", "run.start=centred",
                                         of->change};
        Scenario scenario = load(of->path, overrides, 3);
        Scenario changed = load(of->path, overrides, 4);
        scenario.run.step = changed.run.step = 20e-6;
        const double ode =
            hold_against(&scenario, run_scenario(&scenario, registry_solver(BACKEND_ODE), NOBODY),
                         BACKEND_REFERENCE)
                .error.max;
        const double kernel = max_error(engine, "kernel", &scenario, &scenario);
        if (!(kernel <= 3.0 * ode)) {
            fail_msg("%s, %s: %g against ODE's %g", engine, of->path, kernel, ode);
        }
        const double control = max_error(engine, "kernel", &changed, &scenario);
        if (!(control > 10.0 * kernel)) {
            fail_msg("%s, %s: %g with %s, %g without", engine, of->path, control, of->change,
                     kernel);
        }
    }
}
