// How does one scenario on one solver become one trajectory?
//
// open -> (step -> record)* until the next sample -> observe -> ... -> close. The clock runs around
// the stepping loop alone: steps, contact detection, recording and samples, not the setting up.
#include "run/run.h"

#include "base/clock.h"
#include "contact/law.h"
#include "contact/pin_space.h"
#include "contact/touch.h"
#include "model/forces.h"
#include "model/lock.h"
#include "run/part_samples.h"
#include "run/sample_check.h"

#include <stdio.h>

// steps between two looks at the clock: some 0.1 ms of ODE, up to a second of a large reference
enum { PROGRESS_EVERY = 64 };

// Samples that one mechanism may be ahead of others.
enum { AHEAD_MOST = 16 };

typedef struct Loop {
    const Scenario *scenario;
    const Solver *solver;
    void *state;
    Recorder recorder;
    const RunProbe *probe;
    void *probe_own; // of the probe; NULL: it has nothing to look at
    RunWatch watch;
    const RunGuard *guard; // NULL: none
    bool is_stopped;       // by the guard
    double started_s;      // by the clock
    size_t steps;
    double reached_s; // simulated
    double width_s;   // length of the last step
    Turning turning;
    Sample sample;       // the last one; owned
    bool has_parts;      // whether records tell of one mechanism at a time
    PartSamples ahead;   // samples of these
    double elastic;      // J, stored in the contacts there
    double start_energy; // J, kinetic, potential and elastic, at time zero
} Loop;

// Takes in what comes next of a step.
static bool take_record(Loop *loop, double stop_s, StepRecord *record, Err *err)
{
    if (!loop->solver->step(loop->state, stop_s, err)) {
        return false;
    }
    *record = loop->solver->record(loop->state);
    recorder_add(&loop->recorder, record);
    if (loop->probe_own != NULL) {
        loop->probe->look(loop->probe_own, record);
    }
    turning_add(&loop->turning, record);
    loop->has_parts = record->part != NULL;
    if (loop->has_parts && !part_samples_take(&loop->ahead, record, err)) {
        return false;
    }
    loop->steps++;
    if (loop->watch.progress != NULL && loop->steps % PROGRESS_EVERY == 0) {
        loop->watch.progress(loop->reached_s / scenario_duration(loop->scenario),
                             clock_now_s() - loop->started_s, loop->watch.context);
    }
    return true;
}

static bool take_step(Loop *loop, double stop_s, Err *err)
{
    StepRecord record;
    do {
        if (!take_record(loop, stop_s, &record, err)) {
            return false;
        }
    } while (record.is_partial);
    const double reached_s = solver_reached(&record);
    loop->width_s = reached_s - loop->reached_s;
    loop->reached_s = reached_s;
    loop->elastic = record.elastic;
    return true;
}

static double mechanical_energy(const Scenario *scenario, const Sample *sample)
{
    const Linkage *linkage = &scenario->linkage;
    if (linkage->is_spatial) {
        return space_kinetic_energy(linkage, sample->space_bodies) +
               space_potential_energy(linkage, sample->space_bodies, scenario->gravity);
    }
    return linkage_kinetic_energy(linkage, sample->bodies) +
           linkage_potential_energy(linkage, sample->bodies, scenario->gravity) +
           forces_energy(linkage, sample->bodies);
}

// What contacts that are pressed at the start have stored, J.
static double stored_energy(const Scenario *scenario, const Sample *sample)
{
    double sum = 0.0;
    for (size_t i = 0; i < scenario->linkage.joint_count; i++) {
        const Joint *joint = &scenario->linkage.joints[i];
        ForceLaw law;
        Err unused;
        if (scenario->linkage.is_spatial) {
            sum += pin_space_stored(scenario, i, &sample->space_joints[i]);
            continue;
        }
        // what the contacts of the velocity-level model press with, they never store
        if (linkage_kind_is_ideal(joint->kind) || scenario->contact.model != CONTACT_IMPACT ||
            !(sample->joints[i].gap < 0.0) || !law_of_joint(scenario, joint, &law, &unused)) {
            continue;
        }
        Touch places[TOUCH_CORNERS];
        const size_t count = touch_places(joint, (int)i, places);
        for (size_t k = 0; k < count; k++) {
            const double gap = joint->kind == JOINT_CLEARANCE
                                   ? sample->joints[i].gap
                                   : touch_pose(&scenario->linkage, &places[k], sample->bodies).gap;
            sum += gap < 0.0 ? force_law_energy(&law, -gap) : 0.0;
        }
    }
    return sum;
}

// Steps until a time is reached. A step that ends short of it by rounding has reached it.
static bool reach(Loop *loop, double time_s, Err *err)
{
    while (loop->reached_s < time_s - RUN_ROUNDING * loop->width_s) {
        if (!take_step(loop, time_s, err)) {
            return false;
        }
    }
    return true;
}

static bool may_go_on(Loop *loop, const Trajectory *trajectory, size_t sample, Err *err)
{
    const RunGuard *guard = loop->guard;
    loop->is_stopped = guard != NULL && !guard->may_go_on(trajectory, sample, guard->context, err);
    return !loop->is_stopped;
}

// Looks where the run begins, which the first step has to tell.
static void note_start(Loop *loop)
{
    Sample sample = loop->sample;
    loop->solver->observe(loop->state, 0.0, &sample);
    loop->start_energy =
        mechanical_energy(loop->scenario, &sample) + stored_energy(loop->scenario, &sample);
}

// Takes one sample of all bodies, to which all have been stepped.
static bool take_sample(Loop *loop, Trajectory *trajectory, size_t k, Err *err)
{
    Sample sample = loop->sample;
    loop->solver->observe(loop->state, scenario_sample_time(loop->scenario, k), &sample);
    if (!run_check_sample(&loop->scenario->linkage, NULL, &sample, err)) {
        return false;
    }
    turning_unwrap(&loop->turning, NULL, &sample);
    recorder_see(&loop->recorder, NULL, &sample);
    trajectory_store(trajectory, k, &sample);
    return may_go_on(loop, trajectory, k, err);
}

// Takes all samples, of each mechanism while its steps come: the first step may hold several.
static bool take_ahead(Loop *loop, Trajectory *trajectory, Err *err)
{
    for (size_t k = 0; k < trajectory->sample_count;) {
        const size_t left = trajectory->sample_count - k;
        const size_t behind = k + (left < AHEAD_MOST ? left : AHEAD_MOST);
        if (!reach(loop, scenario_sample_time(loop->scenario, behind - 1), err) ||
            !part_samples_complete(&loop->ahead, behind, err)) {
            return false;
        }
        for (; k < behind; k++) {
            if (!may_go_on(loop, trajectory, k, err)) {
                return false;
            }
        }
    }
    return true;
}

static bool take_samples(Loop *loop, Trajectory *trajectory, Err *err)
{
    for (size_t k = 0; k < trajectory->sample_count; k++) {
        if (!reach(loop, scenario_sample_time(loop->scenario, k), err) ||
            !take_sample(loop, trajectory, k, err)) {
            return false;
        }
    }
    return true;
}

static bool run_samples(Loop *loop, Trajectory *trajectory, Err *err)
{
    // a first step, so that the sample at zero already stands in one
    if (!take_step(loop, scenario_sample_time(loop->scenario, 1), err)) {
        return false;
    }
    note_start(loop);
    if (!(loop->has_parts ? take_ahead : take_samples)(loop, trajectory, err)) {
        return false;
    }
    // what is left after the last whole sample interval
    return reach(loop, scenario_duration(loop->scenario), err);
}

// The balance over the run, from its first instant to the last one reached.
static void close_energy(const Loop *loop, Trajectory *trajectory)
{
    Sample last = loop->sample;
    last.time_s = loop->reached_s;
    loop->solver->observe(loop->state, loop->reached_s, &last);
    turning_unwrap(&loop->turning, NULL, &last);
    Energy *energy = &trajectory->energy;
    energy->change = mechanical_energy(loop->scenario, &last) - loop->start_energy + loop->elastic;
    energy->residual = energy->drive_work - energy->change - energy->dissipated - energy->friction;
}

static void fill_model(const Loop *loop, Trajectory *trajectory)
{
    const SolverModel model = loop->solver->model(loop->state);
    snprintf(trajectory->label, sizeof trajectory->label, "%s", model.label);
    trajectory->step_s = model.step_s;
    trajectory->steps = model.steps;
    trajectory->evaluations = model.evaluations;
    trajectory->constraint_rows = model.constraint_rows;
    trajectory->contact_rows = model.contact_rows;
    trajectory->fallback_rows = model.fallback_rows;
}

// Puts an extreme into the ranges wherever it returns, turn by turn.
static void show_extreme(const Scenario *scenario, Trajectory *trajectory, size_t signal,
                         const Extreme *extreme)
{
    const double end_s = trajectory->duration_s;
    const double turn_s =
        drive_is_steady(&scenario->linkage.driver) ? linkage_period(&scenario->linkage) : INFINITY;
    for (double time_s = extreme->time_s; time_s <= end_s; time_s += turn_s) {
        ranges_add(&trajectory->ranges, signal, time_s, extreme->value);
    }
}

static void show_extremes(const Scenario *scenario, Trajectory *trajectory)
{
    for (size_t i = 0; trajectory->ranges.count > 0 && i < trajectory->body_count; i++) {
        const BodyExtremes *body = &trajectory->bodies[i];
        const size_t omega = ranges_of_body(i, RANGES_OMEGA);
        const size_t alpha = ranges_of_body(i, RANGES_ALPHA);
        show_extreme(scenario, trajectory, omega, &body->omega_max);
        show_extreme(scenario, trajectory, omega, &body->omega_min);
        show_extreme(scenario, trajectory, alpha, &body->alpha_max);
        show_extreme(scenario, trajectory, alpha, &body->alpha_min);
    }
}

// Up to where the driven mechanism has been stepped, which may be ahead of others, or all where
// none is driven.
static double driven_until(const Loop *loop)
{
    const int driven = linkage_driven_body(&loop->scenario->linkage);
    return driven != LINKAGE_GROUND ? loop->turning.told_s[driven] : loop->reached_s;
}

Trajectory *run_scenario(const Scenario *scenario, const Solver *solver, RunWatch watch)
{
    return run_guarded(scenario, solver, watch, NULL, NULL);
}

Trajectory *run_guarded(const Scenario *scenario, const Solver *solver, RunWatch watch,
                        const RunProbe *probe, const RunGuard *guard)
{
    Trajectory *trajectory = trajectory_create(scenario, solver->name);
    Err err = {ERR_NONE, ""};
    Loop loop = {
        .scenario = scenario, .solver = solver, .watch = watch, .probe = probe, .guard = guard};
    if (probe != NULL && scenario->run.keeps_ranges) {
        trajectory_keep_ranges(trajectory, scenario);
    }
    if (trajectory->sample_count == 0) {
        return trajectory;
    }
    if (!solver->open(scenario, &loop.state, &err)) {
        snprintf(trajectory->message, sizeof trajectory->message, "%s", err.text);
        return trajectory;
    }
    loop.turning = turning_start(&scenario->linkage);
    loop.sample = sample_create(&scenario->linkage);
    loop.recorder = recorder_start(scenario, trajectory);
    loop.ahead = part_samples_start(&loop.recorder, &loop.turning, solver, loop.state);
    loop.probe_own =
        probe == NULL ? NULL : probe->begin(scenario, solver, loop.state, &loop.recorder);
    loop.started_s = clock_now_s();
    const bool is_done = run_samples(&loop, trajectory, &err);
    trajectory->wall_s = clock_now_s() - loop.started_s;
    recorder_finish(&loop.recorder);
    fill_model(&loop, trajectory);
    trajectory->duration_s = loop.reached_s;
    if (is_done && solver->extremes != NULL) {
        solver->extremes(loop.state, trajectory->report_from_s, trajectory->bodies);
        show_extremes(scenario, trajectory);
    }
    if (is_done) {
        close_energy(&loop, trajectory);
    }
    trajectory->is_complete = is_done;
    if (!loop.is_stopped) {
        lock_explain(scenario, driven_until(&loop), &err);
    }
    if (loop.probe_own != NULL) {
        probe->end(loop.probe_own, trajectory);
    }
    snprintf(trajectory->message, sizeof trajectory->message, "%s", err.text);
    solver->close(loop.state);
    part_samples_finish(&loop.ahead);
    turning_finish(&loop.turning);
    sample_free(&loop.sample);
    return trajectory;
}
