// Other engines as solvers: opening one runs the case by its driver, and its steps are those that
// the driver tells of.
//
// Accelerations are means over the records of the driver's steps, from the velocities at their
// ends. A driver that tells of samples alone is taken at its samples; largest forces and depths and
// the number of contacts are then its totals, and when they were is not known. What no driver
// tells, energies and the forces of ideal joints, is no number.
#include "base/text.h"
#include "base/zeroed.h"
#include "engine/driver.h"
#include "engine/engine_records.h"
#include "model/solver.h"

#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// of a run, at most: finer steps than that are taken together
enum { RECORDS_WANTED = 1 << 16 };

// of a time: a record that ends so little before the last sample has reached it
static const double TIME_ROUNDING = 1e-9;

// s: a driver that takes longer hangs, as --time-limit of the commands has it
static const double RUN_LIMIT_S = 600.0;

typedef struct EngineState {
    const Scenario *scenario;
    EngineDriver driver;
    EngineSaid said;
    Trajectory *answer; // its samples
    EngineRecords records;
    size_t next; // record, or sample where there are none
    double start_s;
    double end_s;
    Vec2 *velocity; // by body, at the last step's end; owned, as all arrays
    double *omega;
    double *alpha;
    JointState *joints; // by joint
    JointPeak *peaks;
    double *impulse;
    double *approach;
    TrajectoryEngine engine;
} EngineState;

// The driver of an engine, and what it says of itself.
static bool find_driver(const Scenario *scenario, BackendKind backend, EngineDriver *driver,
                        Err *err)
{
    const char *given = scenario->engines[backend].driver;
    if (given != NULL) {
        return engine_given(given, driver, err);
    }
    return backend != BACKEND_DRIVER
               ? engine_find(OPTIONS_BACKENDS[backend], driver, err)
               : err_set(err, ERR_USAGE, "--driver NAME=PROGRAM says which driver is meant");
}

// The ways to try, in their order: that which is asked for, or of the best all that are known, and
// the driver's first. Returns how many there are.
static size_t list_ways(const EngineDriver *driver, EngineWay wanted,
                        const char *ways[ENGINE_WAY_COUNT])
{
    size_t count = 0;
    for (int way = ENGINE_WAY_BEST + 1; way < ENGINE_WAY_COUNT; way++) {
        for (size_t i = 0; i < driver->way_count; i++) {
            if ((wanted == ENGINE_WAY_BEST || (int)wanted == way) &&
                strcmp(driver->ways[i], OPTIONS_ENGINE_WAYS[way]) == 0) {
                ways[count++] = driver->ways[i];
            }
        }
    }
    if (wanted == ENGINE_WAY_BEST && count == 0) {
        ways[count++] = driver->ways[0];
    }
    return count;
}

static bool check_engine(const Scenario *scenario, BackendKind backend, Err *err)
{
    EngineDriver driver;
    const char *ways[ENGINE_WAY_COUNT];
    Err other = {0};
    if (!engine_check(OPTIONS_BACKENDS[backend], scenario, err)) {
        return false;
    }
    // a driver that is missing is a run that fails
    if (!find_driver(scenario, backend, &driver, &other)) {
        return true;
    }
    const size_t count = list_ways(&driver, scenario->engines[backend].way, ways);
    return engine_takes(&driver, ways, count, scenario, scenario->engines[backend].time_limit_s,
                        err);
}

// Runs the case in one way.
static bool run_way(EngineState *state, BackendKind backend, const char *way, Err *err)
{
    const Scenario *scenario = state->scenario;
    const double asked_s = scenario->engines[backend].time_limit_s;
    trajectory_destroy(state->answer);
    engine_records_finish(&state->records);
    state->records = engine_records_start(
        scenario->linkage.body_count, scenario->linkage.joint_count,
        scenario_duration(scenario) / RECORDS_WANTED, scenario_duration(scenario));
    state->answer =
        engine_run_recorded(&state->driver, way, scenario, asked_s > 0.0 ? asked_s : RUN_LIMIT_S,
                            &state->said, &state->records);
    return state->answer->is_complete || err_set(err, ERR_SOLVER, "%s", state->answer->message);
}

static void note_engine(EngineState *state, const char *way)
{
    const EngineDriver *driver = &state->driver;
    TrajectoryEngine *engine = &state->engine;
    text_copy(engine->name, sizeof engine->name, driver->engine);
    text_copy(engine->version, sizeof engine->version, driver->version);
    text_copy(engine->precision, sizeof engine->precision, driver->precision);
    text_copy(engine->way, sizeof engine->way, way);
    text_copy(engine->settings, sizeof engine->settings, state->said.settings);
}

static void engine_close(void *of)
{
    EngineState *state = of;
    trajectory_destroy(state->answer);
    engine_records_finish(&state->records);
    free(state->velocity);
    free(state->omega);
    free(state->alpha);
    free(state->joints);
    free(state->peaks);
    free(state->impulse);
    free(state->approach);
    free(state);
}

static void begin_steps(EngineState *state)
{
    const size_t bodies = state->answer->body_count;
    const size_t joints = state->answer->joint_count;
    state->velocity = zeroed(bodies, sizeof *state->velocity);
    state->omega = zeroed(bodies, sizeof *state->omega);
    state->alpha = zeroed(bodies, sizeof *state->alpha);
    state->joints = zeroed(joints, sizeof *state->joints);
    state->peaks = zeroed(joints, sizeof *state->peaks);
    state->impulse = zeroed(joints, sizeof *state->impulse);
    state->approach = zeroed(joints, sizeof *state->approach);
    for (size_t i = 0; i < bodies; i++) {
        const Motion *start = trajectory_motion(state->answer, 0, i);
        state->velocity[i] = start->velocity;
        state->omega[i] = start->omega;
    }
}

static bool engine_open(const Scenario *scenario, BackendKind backend, void **opened, Err *err)
{
    const EngineWay wanted = scenario->engines[backend].way;
    EngineState *state = zeroed(1, sizeof *state);
    state->scenario = scenario;
    const char *ways[ENGINE_WAY_COUNT];
    if (!find_driver(scenario, backend, &state->driver, err)) {
        engine_close(state);
        return false;
    }
    const size_t count = list_ways(&state->driver, wanted, ways);
    bool is_run = count > 0 || err_set(err, ERR_SOLVER, "the driver '%s' has no way '%s'",
                                       state->driver.name, OPTIONS_ENGINE_WAYS[wanted]);
    size_t way = 0;
    if (is_run) {
        Err own = {0};
        is_run = run_way(state, backend, ways[way], &own);
        // what it does not take in its best way it may in another
        while (!is_run && state->said.is_refused && way + 1 < count) {
            own = (Err){0};
            is_run = run_way(state, backend, ways[++way], &own);
        }
        is_run = is_run || err_set(err, ERR_SOLVER, "%s", own.text);
    }
    if (!is_run) {
        engine_close(state);
        return false;
    }
    note_engine(state, ways[way]);
    begin_steps(state);
    *opened = state;
    return true;
}

// The bodies at the end of a step.
static void end_body(EngineState *state, size_t body, EngineRates rates, double length_s)
{
    state->alpha[body] = (rates.omega - state->omega[body]) / length_s;
    state->omega[body] = rates.omega;
    state->velocity[body] = rates.velocity;
}

static bool has_play(const EngineState *state, size_t joint)
{
    return linkage_has_play(&state->scenario->linkage.joints[joint]);
}

// A joint of which nothing is known but that it holds.
static void hold_joint(EngineState *state, size_t joint)
{
    state->joints[joint] = (JointState){.is_touching = true};
    state->peaks[joint] = (JointPeak){0};
    state->impulse[joint] = 0.0;
}

static double or_zero(double value)
{
    return isfinite(value) ? value : 0.0;
}

static void take_touch(EngineState *state, size_t joint, const EngineTouch *touch)
{
    if (!has_play(state, joint) || !isfinite(touch->force.x)) {
        hold_joint(state, joint);
        return;
    }
    const Joint *of = &state->scenario->linkage.joints[joint];
    const double gap = joint_has_hole(of->kind)
                           ? linkage_radial_clearance(of) - vec2_length(touch->eccentricity)
                           : touch->eccentricity.x;
    const double force = vec2_length(touch->force);
    const bool is_torque = linkage_is_torsional(of);
    const double length_s = state->end_s - state->start_s;
    state->peaks[joint] =
        (JointPeak){.force = or_zero(touch->force_max), .depth = or_zero(touch->depth_max)};
    state->joints[joint] = (JointState){
        .eccentricity = joint_has_hole(of->kind) ? touch->eccentricity : (Vec2){0.0, 0.0},
        .gap = gap,
        .force_on_b = is_torque ? (Vec2){0.0, 0.0} : touch->force,
        .moment_on_b = is_torque ? touch->force.x : 0.0,
        .force = force,
        // at the instant of its onset a pin is in the wall by rounding
        .is_touching =
            isfinite(touch->force_max) ? touch->force_max > 0.0 : gap < 0.0 || force > 0.0,
    };
    state->impulse[joint] = isfinite(touch->impulse) ? touch->impulse : force * length_s;
    state->approach[joint] = or_zero(touch->approach);
}

// A step that the driver tells of.
static void take_record(EngineState *state)
{
    const EngineRecords *records = &state->records;
    const double duration_s = scenario_duration(state->scenario);
    const size_t record = state->next++;
    const double whole_s =
        engine_records_end(records, record) - engine_records_begin(records, record);
    state->start_s = engine_records_begin(records, record);
    state->end_s = fmin(engine_records_end(records, record), duration_s);
    for (size_t i = 0; i < records->body_count; i++) {
        end_body(state, i, engine_records_body(records, record, i), whole_s);
    }
    for (size_t i = 0; i < records->joint_count; i++) {
        const EngineTouch touch = engine_records_joint(records, record, i);
        take_touch(state, i, &touch);
        // of the last one, which goes on after the run, the part that belongs to it
        state->impulse[i] *= (state->end_s - state->start_s) / whole_s;
    }
}

// From a sample to the next, or to the end of the run.
static void take_interval(EngineState *state)
{
    const Trajectory *answer = state->answer;
    const size_t last = answer->sample_count - 1;
    const size_t sample = state->next++ < last ? state->next : last;
    state->start_s = state->end_s;
    state->end_s = state->next <= last ? answer->times[sample] : scenario_duration(state->scenario);
    const double length_s = state->end_s - state->start_s;
    for (size_t i = 0; i < answer->body_count; i++) {
        const Motion *motion = trajectory_motion(answer, sample, i);
        end_body(state, i, (EngineRates){motion->velocity, motion->omega}, length_s);
    }
    for (size_t i = 0; i < answer->joint_count; i++) {
        const JointState *joint = trajectory_state(answer, sample, i);
        const Joint *of = &state->scenario->linkage.joints[i];
        const Vec2 torque = {joint->moment_on_b, 0.0};
        const Vec2 gap = {joint->gap, 0.0};
        const EngineTouch touch = {.eccentricity =
                                       joint_has_hole(of->kind) ? joint->eccentricity : gap,
                                   .force = linkage_is_torsional(of) ? torque : joint->force_on_b,
                                   .impulse = length_s * joint->force,
                                   .approach = NAN,
                                   .force_max = NAN,
                                   .depth_max = NAN};
        take_touch(state, i, &touch);
    }
}

// What is left behind the last sample, of which nothing is known: all goes on as it was.
static void take_rest(EngineState *state)
{
    state->start_s = state->end_s;
    state->end_s = scenario_duration(state->scenario);
    for (size_t i = 0; i < state->answer->joint_count; i++) {
        state->impulse[i] = state->joints[i].force * (state->end_s - state->start_s);
    }
}

static bool engine_solver_step(void *of, double stop_s, Err *err)
{
    EngineState *state = of;
    const bool has_records = state->records.count > 0;
    if (has_records && state->next == state->records.count) {
        const Trajectory *answer = state->answer;
        if (state->end_s >= answer->times[answer->sample_count - 1] * (1.0 - TIME_ROUNDING)) {
            take_rest(state);
            return true;
        }
        return err_set(err, ERR_SOLVER, "%s: the records of its steps end at %.9g s, before %.9g s",
                       state->answer->label, state->end_s, stop_s);
    }
    (has_records ? take_record : take_interval)(state);
    return true;
}

static StepRecord engine_record(const void *of)
{
    const EngineState *state = of;
    return (StepRecord){
        .start_s = state->start_s,
        .end_s = state->end_s,
        .joint_s = 0.5 * (state->start_s + state->end_s),
        .omega = state->omega,
        .is_mean = true,
        .alpha = state->alpha,
        .joints = state->joints,
        .peaks = state->records.count > 0 ? state->peaks : NULL,
        .impulse = state->impulse,
        .approach = state->approach,
        .drive_work = NAN,
        .load_work = NAN,
        .dissipated = NAN,
        .friction = NAN,
        .elastic = NAN,
    };
}

// The sample that is nearest to a time.
static size_t sample_at(const Trajectory *answer, double time_s)
{
    size_t low = 0;
    size_t high = answer->sample_count;
    while (low + 1 < high) {
        const size_t middle = low + (high - low) / 2;
        *(answer->times[middle] <= time_s ? &low : &high) = middle;
    }
    const bool is_next = low + 1 < answer->sample_count &&
                         answer->times[low + 1] - time_s < time_s - answer->times[low];
    return is_next ? low + 1 : low;
}

// Mean accelerations of a body in the record that a time lies in.
static void accelerate(const EngineState *state, double time_s, size_t body, Motion *motion)
{
    const EngineRecords *records = &state->records;
    motion->alpha = NAN;
    motion->acceleration = (Vec2){NAN, NAN};
    if (records->count == 0) {
        return;
    }
    const size_t record = engine_records_find(records, time_s);
    const Motion *start = trajectory_motion(state->answer, 0, body);
    const EngineRates before = record > 0 ? engine_records_body(records, record - 1, body)
                                          : (EngineRates){start->velocity, start->omega};
    const EngineRates after = engine_records_body(records, record, body);
    const double per_s =
        1.0 / (engine_records_end(records, record) - engine_records_begin(records, record));
    motion->alpha = per_s * (after.omega - before.omega);
    motion->acceleration = vec2_scale(per_s, vec2_sub(after.velocity, before.velocity));
}

static void engine_observe(const void *of, double time_s, Sample *sample)
{
    const EngineState *state = of;
    const Trajectory *answer = state->answer;
    const size_t index = sample_at(answer, time_s);
    sample->time_s = time_s;
    sample->crank_rad = answer->crank_angles[index];
    for (size_t i = 0; i < answer->body_count; i++) {
        sample->bodies[i] = *trajectory_motion(answer, index, i);
        accelerate(state, time_s, i, &sample->bodies[i]);
    }
    for (size_t i = 0; i < answer->joint_count; i++) {
        sample->joints[i] = *trajectory_state(answer, index, i);
        if (!has_play(state, i)) {
            sample->joints[i].force = NAN;
            sample->joints[i].force_on_b = (Vec2){NAN, NAN};
        }
    }
}

static SolverModel engine_model(const void *of)
{
    const EngineState *state = of;
    const TrajectoryEngine *engine = &state->engine;
    SolverModel model = {
        .step_s = state->answer->step_s,
        .steps = state->answer->steps,
        .stepped_s = state->answer->duration_s,
        .wall_s = state->answer->wall_s,
        .engine = engine,
    };
    snprintf(model.label, sizeof model.label, "%.31s %.12s, %.16s %.12s, %.8s", state->driver.name,
             engine->way, engine->name, engine->version, engine->precision);
    return model;
}

// Of joints that are ideal no driver knows the force; where there are no records, it knows of the
// others how much, and not when.
static void engine_totals(const void *of, JointExtremes *joints)
{
    const EngineState *state = of;
    for (size_t i = 0; i < state->answer->joint_count; i++) {
        JointExtremes *joint = &joints[i];
        const JointExtremes *totals = &state->answer->joints[i];
        if (!has_play(state, i)) {
            joint->force_max = (Extreme){NAN, NAN, NAN};
        } else if (state->records.count == 0) {
            joint->force_max = (Extreme){totals->force_max.value, NAN, NAN};
            joint->penetration_max = (Extreme){totals->penetration_max.value, NAN, NAN};
            joint->impacts = totals->impacts;
            joint->impulse = NAN;
            joint->spike_count = 0;
        }
    }
}

#define ENGINE_SOLVER(id, word, solver, is)                                                        \
    static bool check_##id(const Scenario *scenario, Err *err)                                     \
    {                                                                                              \
        return check_engine(scenario, id, err);                                                    \
    }                                                                                              \
    static bool open_##id(const Scenario *scenario, void **state, Err *err)                        \
    {                                                                                              \
        return engine_open(scenario, id, state, err);                                              \
    }                                                                                              \
    const Solver solver = {                                                                        \
        .name = word,                                                                              \
        .check = check_##id,                                                                       \
        .open = open_##id,                                                                         \
        .step = engine_solver_step,                                                                \
        .record = engine_record,                                                                   \
        .observe = engine_observe,                                                                 \
        .model = engine_model,                                                                     \
        .totals = engine_totals,                                                                   \
        .close = engine_close,                                                                     \
    };
OPTIONS_ENGINE_LIST(ENGINE_SOLVER)
