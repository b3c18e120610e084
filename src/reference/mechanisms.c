// How do mechanisms that share nothing but the ground move side by side?
//
// Each by itself, in steps of its own: an event of one ends no step of another, and nothing is
// evaluated for all of them together. One after the other is stepped to the time that is asked for
// or beyond, where its sample is looked up in its last step.
#include "reference/mechanisms.h"

#include "base/zeroed.h"
#include "model/members.h"

#include <math.h>

typedef struct Several {
    const Scenario *scenario;
    size_t count;
    Member *members;   // owned
    double *reached_s; // by member; owned, like the next
    double *width_s;   // of its last step
    size_t now;        // the member whose step was taken last
    size_t next;       // whose step is next; their number: all are where they were asked to be
    bool has_begun;    // after the first step of each: a sample at time zero stands in it
    double elastic;    // J, of all members
    StepRecord record;
} Several;

// Of a step: one that ends short of a time by so little has reached it.
static const double ROUNDING = 1e-9;

static void several_close(void *state)
{
    Several *several = state;
    if (several != NULL) {
        members_free(several->members, several->count, &REFERENCE_ONE);
        free(several->reached_s);
        free(several->width_s);
        free(several);
    }
}

static bool several_open(const Scenario *scenario, void **state, Err *err)
{
    Several *several = zeroed(1, sizeof *several);
    several->scenario = scenario;
    several->members = members_make(scenario, &several->count);
    several->reached_s = zeroed(several->count, sizeof *several->reached_s);
    several->width_s = zeroed(several->count, sizeof *several->width_s);
    for (size_t i = 0; i < several->count; i++) {
        Member *member = &several->members[i];
        if (!REFERENCE_ONE.open(member->scenario, &member->state, err)) {
            several_close(several);
            return false;
        }
    }
    *state = several;
    return true;
}

static double last_time(const Several *several, double stop_s)
{
    return fmin(stop_s, scenario_duration(several->scenario));
}

// The first member from one on that is still to be stepped to a time; their number: none is.
static size_t next_behind(const Several *several, size_t from, double stop_s)
{
    const double last_s = last_time(several, stop_s);
    while (from < several->count &&
           several->reached_s[from] >= last_s - ROUNDING * several->width_s[from]) {
        from++;
    }
    return from;
}

// The member that is furthest behind.
static size_t last_of_all(const Several *several)
{
    size_t last = 0;
    for (size_t i = 1; i < several->count; i++) {
        last = several->reached_s[i] < several->reached_s[last] ? i : last;
    }
    return last;
}

// Chooses the member to step now.
static Member *choose(Several *several, double stop_s)
{
    if (several->next == several->count) {
        several->next = next_behind(several, 0, stop_s);
    }
    several->now = several->next < several->count ? several->next : last_of_all(several);
    return &several->members[several->now];
}

// Notes where the step ended, and whose is next.
static void note_step(Several *several, double end_s, double stop_s)
{
    const size_t now = several->now;
    several->width_s[now] = end_s - several->reached_s[now];
    several->reached_s[now] = end_s;
    several->next = several->has_begun ? next_behind(several, now, stop_s) : now + 1;
}

// Ends a round, after which none is behind. Returns where all are.
static double end_round(Several *several, double stop_s)
{
    const double least_s = several->reached_s[last_of_all(several)];
    const double reached_s =
        several->has_begun ? fmax(least_s, last_time(several, stop_s)) : least_s;
    several->has_begun = true;
    return reached_s;
}

static bool several_step(void *state, double stop_s, Err *err)
{
    Several *several = state;
    Member *member = choose(several, stop_s);
    if (!REFERENCE_ONE.step(member->state, stop_s, err)) {
        return false;
    }
    StepRecord *record = &several->record;
    *record = REFERENCE_ONE.record(member->state);
    note_step(several, record->end_s, stop_s);
    several->elastic += record->elastic - member->elastic;
    member->elastic = record->elastic;
    record->elastic = several->elastic;
    record->part = &member->part;
    record->is_partial = several->next < several->count;
    record->reached_s = record->is_partial ? 0.0 : end_round(several, stop_s);
    return true;
}

static bool several_stride(void *state, double stop_s, double *end_s, Err *err)
{
    Several *several = state;
    do {
        Member *member = choose(several, stop_s);
        double member_end_s = 0.0;
        if (!REFERENCE_ONE.stride(member->state, stop_s, &member_end_s, err)) {
            return false;
        }
        note_step(several, member_end_s, stop_s);
    } while (several->next < several->count);
    *end_s = end_round(several, stop_s);
    return true;
}

static StepRecord several_record(const void *state)
{
    return ((const Several *)state)->record;
}

static void observe(const Several *several, Member *member, double time_s, Sample *sample)
{
    REFERENCE_ONE.observe(member->state, time_s, &member->sample);
    member_show(member, sample);
    sample->time_s = time_s;
    sample->crank_rad = linkage_crank_angle(&several->scenario->linkage, time_s);
}

static void several_observe(const void *state, double time_s, Sample *sample)
{
    const Several *several = state;
    for (size_t i = 0; i < several->count; i++) {
        observe(several, &several->members[i], time_s, sample);
    }
}

static void several_observe_part(const void *state, double time_s, Sample *sample)
{
    const Several *several = state;
    observe(several, &several->members[several->now], time_s, sample);
}

static void several_glance(const void *state, double time_s, Sample *sample)
{
    const Several *several = state;
    for (size_t i = 0; i < several->count; i++) {
        Member *member = &several->members[i];
        REFERENCE_ONE.glance(member->state, time_s, &member->sample);
        member_show_bodies(member, sample);
    }
}

// All numbers are sums: an evaluation is one of one mechanism.
static SolverModel several_model(const void *state)
{
    const Several *several = state;
    SolverModel model = {.steps = 0};
    size_t coordinates = 0;
    for (size_t i = 0; i < several->count; i++) {
        const SolverModel of = REFERENCE_ONE.model(several->members[i].state);
        model.constraint_rows += of.constraint_rows;
        model.contact_rows += of.contact_rows;
        model.steps += of.steps;
        model.evaluations += of.evaluations;
        coordinates += reference_coordinates(several->members[i].state);
    }
    reference_label(several->scenario, coordinates, model.label);
    return model;
}

const Solver REFERENCE_SEVERAL = {
    .name = "reference",
    .open = several_open,
    .step = several_step,
    .stride = several_stride,
    .record = several_record,
    .observe = several_observe,
    .observe_part = several_observe_part,
    .glance = several_glance,
    .model = several_model,
    .close = several_close,
};
