// How do mechanisms that share nothing but the ground move side by side, contacts integrated within
// the step?
//
// Each by itself (ode/impulse.c), in a world of its own: a contact of one shortens no local step of
// another, and nothing is solved for all of them together. One after the other takes its steps up
// to the time that is asked for, and hands them on in parts that tell of this mechanism alone.
// Whoever looks at them thus has no more to do than for each mechanism by itself, and memory is
// read into the cache once for several steps: a thousand mechanisms do not fit into it.
#include "ode/impulse_parts.h"

#include "base/zeroed.h"
#include "model/members.h"
#include "ode/stepping.h"

#include <math.h>

typedef struct Parts {
    const Scenario *scenario;
    const ImpulsePartsOf *of;
    size_t count;
    Member *members; // owned
    size_t now;      // the member whose steps are being handed on
    size_t taken;    // of them so far
    size_t steps;    // of each member in this round; 0: the first member is still taking them
    bool is_over;    // whether the member makes way for the next one
    bool has_begun;  // after the first round, which is one step: samples at time zero stand in it
    double elastic;  // J, of all members
    StepRecord record;
} Parts;

// Steps that a member takes at most before the next one goes on.
enum { STEPS_MOST = 16 };

static bool is_whole(const Scenario *scenario)
{
    // steps of all end together only where none is shortened
    return scenario->ode.gear > 1 || scenario->linkage.driver.speeds.count > 0;
}

size_t impulse_parts_count(const Scenario *scenario)
{
    if (is_whole(scenario) || scenario->linkage.body_count == 0) {
        return 1;
    }
    return members_count(&scenario->linkage);
}

void impulse_parts_close(void *state)
{
    Parts *parts = state;
    if (parts != NULL) {
        members_free(parts->members, parts->count, parts->of->solver);
        free(parts);
    }
}

bool impulse_parts_open(const Scenario *scenario, const ImpulsePartsOf *of, void **state, Err *err)
{
    Parts *parts = zeroed(1, sizeof *parts);
    parts->scenario = scenario;
    parts->of = of;
    parts->members = members_make(scenario, &parts->count);
    for (size_t i = 0; i < parts->count; i++) {
        Member *member = &parts->members[i];
        if (!of->solver->open(member->scenario, &member->state, err)) {
            impulse_parts_close(parts);
            return false;
        }
        // they are stepped one after the other: one working memory will do
        if (i > 0) {
            dWorldUseSharedWorkingMemory(of->world(member->state), NULL); // its own, yet empty
            dWorldUseSharedWorkingMemory(of->world(member->state),
                                         of->world(parts->members[0].state));
        }
    }
    *state = parts;
    return true;
}

// Whether the member that has just ended a step makes way for the next one.
static bool is_turn_over(const Parts *parts, double stop_s)
{
    if (parts->steps > 0) {
        return parts->taken == parts->steps;
    }
    const double last_s = fmin(stop_s, scenario_duration(parts->scenario));
    const double near_s = last_s - STEPPING_ROUNDING * parts->scenario->run.step;
    return !parts->has_begun || parts->taken == STEPS_MOST || parts->record.end_s >= near_s;
}

// Goes on to the next member.
static void turn(Parts *parts)
{
    const bool is_last = parts->now + 1 == parts->count;
    parts->steps = is_last ? 0 : parts->taken;
    parts->now = is_last ? 0 : parts->now + 1;
    parts->taken = 0;
    parts->has_begun = parts->has_begun || is_last;
    parts->is_over = false;
}

bool impulse_parts_step(void *state, double stop_s, Err *err)
{
    Parts *parts = state;
    if (parts->is_over) {
        turn(parts);
    }
    Member *member = &parts->members[parts->now];
    if (!parts->of->solver->step(member->state, stop_s, err)) {
        return false;
    }
    parts->record = parts->of->solver->record(member->state);
    if (parts->of->is_at_end(member->state)) {
        parts->taken++;
        parts->is_over = is_turn_over(parts, stop_s);
    }
    parts->elastic += parts->record.elastic - member->elastic;
    member->elastic = parts->record.elastic;
    parts->record.elastic = parts->elastic;
    parts->record.part = &member->part;
    parts->record.is_partial = !parts->is_over || parts->now + 1 < parts->count;
    parts->record.reached_s = parts->record.end_s;
    return true;
}

StepRecord impulse_parts_record(const void *state)
{
    const Parts *parts = state;
    return parts->record;
}

static void observe(const Parts *parts, Member *member, double time_s, Sample *sample)
{
    parts->of->solver->observe(member->state, time_s, &member->sample);
    member_show(member, sample);
}

static void set_time(const Parts *parts, double time_s, Sample *sample)
{
    sample->time_s = time_s;
    sample->crank_rad = linkage_crank_angle(&parts->scenario->linkage, time_s);
}

void impulse_parts_observe(const void *state, double time_s, Sample *sample)
{
    const Parts *parts = state;
    set_time(parts, time_s, sample);
    for (size_t i = 0; i < parts->count; i++) {
        observe(parts, &parts->members[i], time_s, sample);
    }
}

void impulse_parts_observe_part(const void *state, double time_s, Sample *sample)
{
    const Parts *parts = state;
    set_time(parts, time_s, sample);
    observe(parts, &parts->members[parts->now], time_s, sample);
}

// Rows, steps and evaluations are those of all members.
SolverModel impulse_parts_model(const void *state)
{
    const Parts *parts = state;
    SolverModel model = parts->of->solver->model(parts->members[0].state);
    for (size_t i = 1; i < parts->count; i++) {
        const SolverModel of = parts->of->solver->model(parts->members[i].state);
        model.constraint_rows += of.constraint_rows;
        model.contact_rows += of.contact_rows;
        model.evaluations += of.evaluations;
    }
    stepping_label(parts->scenario, "staggered", "impulse", model.label);
    return model;
}

static bool open_plane(const Scenario *scenario, void **state, Err *err)
{
    static const ImpulsePartsOf PLANE = {&STEPPING_IMPULSE, impulse_is_at_end, impulse_world};
    return impulse_parts_open(scenario, &PLANE, state, err);
}

const Solver STEPPING_IMPULSE_PARTS = {
    .name = "impulse",
    .open = open_plane,
    .step = impulse_parts_step,
    .record = impulse_parts_record,
    .observe = impulse_parts_observe,
    .observe_part = impulse_parts_observe_part,
    .model = impulse_parts_model,
    .close = impulse_parts_close,
};
