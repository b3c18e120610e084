// Runs one scenario on one solver and makes one trajectory of it.
//
// open -> (step -> record)* until the next sample -> observe -> ... -> close. The clock runs around
// the stepping loop alone: steps, contact detection, recording and samples, not the setting up.
#include "run/run.h"
#include "base/call.h"
#include "base/clock.h"
#include "base/zeroed.h"
#include "contact/law.h"
#include "contact/pin_space.h"
#include "contact/touch.h"
#include "model/forces.h"
#include "model/lock.h"
#include "model/solver.h"
#include "run/recorder.h"
#include "run/wearing.h"

#include <math.h>
#include <stdio.h>

typedef struct Turning {
    const Linkage *linkage;
    double *reported_s; // by body, the end of its last record; owned, like the next two
    double *angle;      // rad, there
    double *omega;      // rad/s, there
} Turning;

typedef struct PartSamples {
    const Scenario *scenario;
    const Solver *solver;
    const void *state; // of the solver
    Recorder *recorder;
    const Turning *turning;
    Trajectory *trajectory;   // receives the samples
    Sample sample;            // owned, as are the arrays
    const SolverPart **parts; // by number, as they are met; NULL: not yet
    size_t *next;             // by number, the sample that is its next
    size_t part_count;        // numbers so far
} PartSamples;

const double RUN_ROUNDING = 1e-9;

// A solver marks a state that the joints do not determine by omegas that are no numbers: whether
// there are none in a part of a sample (NULL: in all of it).
bool run_check_sample(const Linkage *linkage, const SolverPart *part, const Sample *sample,
                      Err *err)
{
    const size_t count = solver_body_count(part, linkage);
    for (size_t k = 0; k < count; k++) {
        const size_t i = solver_body(part, k);
        if (!isfinite(sample->bodies[i].omega)) {
            char where[LINKAGE_INSTANT_SIZE];
            linkage_describe_instant(linkage, sample->time_s, where);
            return err_set(err, ERR_SOLVER,
                           "%s: the motion of %s is not determined: the ideal joints stand at a "
                           "change point, or are redundant; give one of them play",
                           where, linkage->bodies[i].name);
        }
    }
    return true;
}

// The turn in which a body is.

static const double SAME_TURN = 3.0; // rad, less than half a turn

static Turning turning_start(const Linkage *linkage)
{
    const size_t count = linkage->body_count;
    Turning turning = {
        .linkage = linkage,
        .reported_s = zeroed(count, sizeof *turning.reported_s),
        .angle = zeroed(count, sizeof *turning.angle),
        .omega = zeroed(count, sizeof *turning.omega),
    };
    for (size_t i = 0; i < count; i++) {
        turning.angle[i] = linkage->bodies[i].start.angle;
        turning.omega[i] = linkage->bodies[i].start.omega;
    }
    return turning;
}

// The bodies where they are at time zero.
static void turning_finish(Turning *turning)
{
    free(turning->reported_s);
    free(turning->angle);
    free(turning->omega);
}

static void turning_add(Turning *turning, const StepRecord *record)
{
    const size_t count = solver_body_count(record->part, turning->linkage);
    for (size_t k = 0; k < count; k++) {
        const size_t i = solver_body(record->part, k);
        const double width_s = record->end_s - turning->reported_s[i];
        turning->angle[i] += 0.5 * width_s * (turning->omega[i] + record->omega[k]);
        turning->omega[i] = record->omega[k];
        turning->reported_s[i] = record->end_s;
    }
}

// Puts the angles of a part of a sample (NULL: of all of it), known but for whole turns, into the
// turn that the bodies are in.
static void turning_unwrap(const Turning *turning, const SolverPart *part, Sample *sample)
{
    const size_t count = solver_body_count(part, turning->linkage);
    for (size_t k = 0; k < count; k++) {
        const size_t i = solver_body(part, k);
        const double ahead = turning->omega[i] * (turning->reported_s[i] - sample->time_s);
        double *angle = &sample->bodies[i].angle;
        const double apart = turning->angle[i] - ahead - *angle;
        // hardly ever is it another turn than that of the solver, and never a driven body's
        if (!(fabs(apart) < SAME_TURN) && !linkage_is_driven(turning->linkage, (int)i)) {
            *angle += 2.0 * M_PI * round(apart / (2.0 * M_PI));
        }
    }
}

// The samples of mechanisms side by side, one mechanism after the other.
//
// All of a sample at once would fetch each mechanism into the cache once more; a thousand do not
// fit into it.

static PartSamples part_samples_start(Recorder *recorder, const Turning *turning,
                                      const Solver *solver, const void *state)
{
    const Linkage *linkage = &recorder->scenario->linkage;
    return (PartSamples){
        .scenario = recorder->scenario,
        .solver = solver,
        .state = state,
        .recorder = recorder,
        .turning = turning,
        .trajectory = recorder->trajectory,
        .sample = sample_create(linkage),
        .parts = zeroed(linkage->body_count, sizeof(const SolverPart *)),
        .next = zeroed(linkage->body_count, sizeof(size_t)),
    };
}

// The samples go into the recorder's trajectory. All arguments must outlive the result.
static void part_samples_finish(PartSamples *samples)
{
    sample_free(&samples->sample);
    free(samples->parts);
    free(samples->next);
}

static void store(const PartSamples *samples, size_t number, const SolverPart *part)
{
    Trajectory *trajectory = samples->trajectory;
    const Sample *sample = &samples->sample;
    const size_t bodies = number * trajectory->body_count;
    const size_t joints = number * trajectory->joint_count;
    trajectory->times[number] = sample->time_s;
    trajectory->crank_angles[number] = sample->crank_rad;
    for (size_t k = 0; k < part->body_count; k++) {
        const size_t i = (size_t)part->bodies[k];
        trajectory->motions[bodies + i] = sample->bodies[i];
        if (trajectory->space_motions != NULL) {
            trajectory->space_motions[bodies + i] = sample->space_bodies[i];
        }
    }
    for (size_t k = 0; k < part->joint_count; k++) {
        const size_t i = (size_t)part->joints[k];
        trajectory->states[joints + i] = sample->joints[i];
        if (trajectory->space_motions != NULL) {
            trajectory->space_states[joints + i] = sample->space_joints[i];
        }
    }
}

// Takes the next sample of a part, which has been observed.
static bool run_take(PartSamples *samples, const SolverPart *part, Err *err)
{
    Sample *sample = &samples->sample;
    if (!run_check_sample(&samples->scenario->linkage, part, sample, err)) {
        return false;
    }
    turning_unwrap(samples->turning, part, sample);
    recorder_see(samples->recorder, part, sample);
    store(samples, samples->next[part->number]++, part);
    return true;
}

// Takes the samples of a part that its last record has reached. Fails with ERR_SOLVER where one is
// not determined.
static bool part_samples_take(PartSamples *samples, const StepRecord *record, Err *err)
{
    const SolverPart *part = record->part;
    const double near_s = RUN_ROUNDING * (record->end_s - record->start_s);
    const size_t count = samples->trajectory->sample_count;
    samples->parts[part->number] = part;
    samples->part_count =
        part->number >= samples->part_count ? part->number + 1 : samples->part_count;
    for (;;) {
        const size_t next = samples->next[part->number];
        if (next == count ||
            scenario_sample_time(samples->scenario, next) > record->end_s + near_s) {
            return true;
        }
        samples->solver->observe_part(samples->state, scenario_sample_time(samples->scenario, next),
                                      &samples->sample);
        if (!run_take(samples, part, err)) {
            return false;
        }
    }
}

// Takes what rounding has left out of the samples before one that all have been stepped to.
static bool part_samples_complete(PartSamples *samples, size_t behind, Err *err)
{
    for (size_t i = 0; i < samples->part_count; i++) {
        while (samples->parts[i] != NULL && samples->next[i] < behind) {
            samples->solver->observe(samples->state,
                                     scenario_sample_time(samples->scenario, samples->next[i]),
                                     &samples->sample);
            if (!run_take(samples, samples->parts[i], err)) {
                return false;
            }
        }
    }
    return true;
}

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
    void *probe_own;  // of the probe; NULL: it has nothing to look at
    Wearing *wearing; // owned; NULL: nobody looks into the steps, or nothing wears
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

// Whether whoever called wants more of a run.
static bool is_wanted(Err *err)
{
    return !call_is_cancelled() || err_set(err, ERR_SOLVER, "%s", CALL_CANCELLED);
}

// Takes in what comes next of a step.
static bool take_record(Loop *loop, double stop_s, StepRecord *record, Err *err)
{
    if (!is_wanted(err) || !loop->solver->step(loop->state, stop_s, err)) {
        return false;
    }
    *record = loop->solver->record(loop->state);
    recorder_add(&loop->recorder, record);
    wearing_add(loop->wearing, record);
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
           linkage_potential_energy(linkage, sample->bodies, scenario_gravity(scenario)) +
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
        if (joint_is_ideal(joint->kind) || scenario->contact.model != CONTACT_IMPACT ||
            !(sample->joints[i].gap < 0.0) || !law_of_joint(scenario, joint, &law, &unused)) {
            continue;
        }
        Touch places[TOUCH_CORNERS];
        const size_t count = touch_places(&scenario->linkage, (int)i, places);
        for (size_t k = 0; k < count; k++) {
            const double gap = joint_has_hole(joint->kind)
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
    // what springs hold depends on the turn
    turning_unwrap(&loop->turning, NULL, &sample);
    loop->start_energy =
        mechanical_energy(loop->scenario, &sample) + stored_energy(loop->scenario, &sample);
}

// Takes one sample of all bodies, to which all have been stepped.
static bool take_sample(Loop *loop, Trajectory *trajectory, size_t k, double time_s, Err *err)
{
    Sample sample = loop->sample;
    loop->solver->observe(loop->state, time_s, &sample);
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

static bool run_take_samples(Loop *loop, Trajectory *trajectory, Err *err)
{
    for (size_t k = 0; k < trajectory->sample_count; k++) {
        const double time_s = scenario_sample_time(loop->scenario, k);
        if (!reach(loop, time_s, err) || !take_sample(loop, trajectory, k, time_s, err)) {
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
    if (!(loop->has_parts ? take_ahead : run_take_samples)(loop, trajectory, err)) {
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
    energy->residual = energy->drive_work + energy->load_work - energy->change -
                       energy->dissipated - energy->friction;
}

static void fill_model(const Loop *loop, Trajectory *trajectory)
{
    const SolverModel model = loop->solver->model(loop->state);
    snprintf(trajectory->label, sizeof trajectory->label, "%s", model.label);
    trajectory->step_s = model.step_s;
    trajectory->steps = model.steps;
    trajectory->stepped_s = fmax(model.stepped_s, trajectory->duration_s);
    trajectory->evaluations = model.evaluations;
    trajectory->constraint_rows = model.constraint_rows;
    trajectory->contact_rows = model.contact_rows;
    trajectory->fallback_rows = model.fallback_rows;
    trajectory->wall_s = model.wall_s > 0.0 ? model.wall_s : trajectory->wall_s;
    if (model.engine != NULL) {
        trajectory->engine = *model.engine;
    }
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
#define SHOW(name, signal, how) show_extreme(scenario, trajectory, signal, &body->name);
        BODY_EXTREMES_LIST(SHOW)
    }
}

// Up to where the driven mechanism has been stepped, which may be ahead of others, or all where
// none is driven.
static double driven_until(const Loop *loop)
{
    const int driven = linkage_driven_body(&loop->scenario->linkage);
    return driven != LINKAGE_GROUND ? loop->turning.reported_s[driven] : loop->reached_s;
}

// No solver starts anywhere but where the case asks for.
static bool run_check_start(const Scenario *scenario, Err *err)
{
    const SettledStart *settled = &scenario->settled;
    return !scenario_lacks_start(scenario) ||
           err_set(err, ERR_SOLVER, "the %s start is not known: %s",
                   OPTIONS_RUN_STARTS[scenario->run.start],
                   settled->message[0] != '\0' ? settled->message : "nobody has looked for it");
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
    if (!run_check_start(scenario, &err) || !solver->open(scenario, &loop.state, &err)) {
        snprintf(trajectory->message, sizeof trajectory->message, "%s", err.text);
        return trajectory;
    }
    loop.turning = turning_start(&scenario->linkage);
    loop.sample = sample_create(&scenario->linkage);
    loop.recorder = recorder_start(scenario, trajectory, solver, loop.state);
    loop.ahead = part_samples_start(&loop.recorder, &loop.turning, solver, loop.state);
    loop.probe_own =
        probe == NULL ? NULL
                      : probe->begin(scenario, solver, loop.state, &loop.recorder, probe->shared);
    loop.wearing = probe == NULL ? NULL : wearing_start(scenario, solver, loop.state, trajectory);
    loop.started_s = clock_now_s();
    const bool is_done = run_samples(&loop, trajectory, &err);
    trajectory->wall_s = clock_now_s() - loop.started_s;
    recorder_finish(&loop.recorder);
    wearing_finish(loop.wearing);
    trajectory->duration_s = loop.reached_s;
    fill_model(&loop, trajectory);
    if (is_done && solver->extremes != NULL) {
        solver->extremes(loop.state, trajectory->report_from_s, trajectory->bodies);
        show_extremes(scenario, trajectory);
    }
    if (is_done && solver->totals != NULL) {
        solver->totals(loop.state, trajectory->joints);
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

// The motion alone, for comparing two motions.
//
// As above, with nothing recorded at the steps.

typedef struct Way {
    const Scenario *scenario;
    const Solver *solver;
    void *state;
    RunWatch watch;
    double started_s; // by the clock
    size_t steps;
    double reached_s; // simulated
    double width_s;   // length of the last step
} Way;

static bool run_stride(Way *way, double stop_s, Err *err)
{
    double end_s = 0.0;
    if (!is_wanted(err) || !solver_stride(way->solver, way->state, stop_s, &end_s, err)) {
        return false;
    }
    way->width_s = end_s - way->reached_s;
    way->reached_s = end_s;
    way->steps++;
    if (way->watch.progress != NULL && way->steps % PROGRESS_EVERY == 0) {
        way->watch.progress(way->reached_s / scenario_duration(way->scenario),
                            clock_now_s() - way->started_s, way->watch.context);
    }
    return true;
}

static bool reach_in_motion(Way *way, double time_s, Err *err)
{
    while (way->reached_s < time_s - RUN_ROUNDING * way->width_s) {
        if (!run_stride(way, time_s, err)) {
            return false;
        }
    }
    return true;
}

static bool go(Way *way, Sample *sample, Trajectory *trajectory, Err *err)
{
    // a first step, so that the sample at zero already stands in one
    if (!run_stride(way, scenario_sample_time(way->scenario, 1), err)) {
        return false;
    }
    for (size_t k = 0; k < trajectory->sample_count; k++) {
        sample->time_s = scenario_sample_time(way->scenario, k);
        if (!reach_in_motion(way, sample->time_s, err)) {
            return false;
        }
        solver_glance(way->solver, way->state, sample->time_s, sample);
        if (!run_check_sample(&way->scenario->linkage, NULL, sample, err)) {
            return false;
        }
        trajectory_store_motion(trajectory, k, sample);
    }
    return reach_in_motion(way, scenario_duration(way->scenario), err);
}

Trajectory *run_motion(const Scenario *scenario, const Solver *solver, RunWatch watch)
{
    Trajectory *trajectory = trajectory_create_motion(scenario, solver->name);
    Err err = {ERR_NONE, ""};
    Way way = {.scenario = scenario, .solver = solver, .watch = watch, .started_s = clock_now_s()};
    if (trajectory->sample_count == 0) {
        return trajectory;
    }
    if (!run_check_start(scenario, &err) || !solver->open(scenario, &way.state, &err)) {
        snprintf(trajectory->message, sizeof trajectory->message, "%s", err.text);
        return trajectory;
    }
    Sample sample = sample_create(&scenario->linkage);
    trajectory->is_complete = go(&way, &sample, trajectory, &err);
    trajectory->duration_s = way.reached_s;
    lock_explain(scenario, way.reached_s, &err);
    snprintf(trajectory->message, sizeof trajectory->message, "%s", err.text);
    solver->close(way.state);
    sample_free(&sample);
    return trajectory;
}
