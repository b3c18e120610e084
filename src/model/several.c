// How do mechanisms that share nothing but the ground move side by side?
//
// Each by itself, in steps of its own: an event of one ends no step of another, and nothing is
// evaluated for all of them together. One after the other is stepped to the time that is asked for
// or beyond, where its sample is looked up in its last step.
#include "model/several.h"

#include "base/zeroed.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct Several {
    const Scenario *scenario;
    const Solver *solver; // of one
    double rounding;      // of a step
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

void several_close(void *state)
{
    Several *several = state;
    if (several != NULL) {
        members_free(several->members, several->count, several->solver);
        free(several->reached_s);
        free(several->width_s);
        free(several);
    }
}

bool several_open(const Scenario *scenario, const Solver *solver, double rounding, void **state,
                  Err *err)
{
    Several *several = zeroed(1, sizeof *several);
    several->scenario = scenario;
    several->solver = solver;
    several->rounding = rounding;
    several->members = members_make(scenario, &several->count);
    several->reached_s = zeroed(several->count, sizeof *several->reached_s);
    several->width_s = zeroed(several->count, sizeof *several->width_s);
    for (size_t i = 0; i < several->count; i++) {
        Member *member = &several->members[i];
        if (!solver->open(member->scenario, &member->state, err)) {
            several_close(several);
            return false;
        }
    }
    *state = several;
    return true;
}

static double several_last_time(const Several *several, double stop_s)
{
    return fmin(stop_s, scenario_duration(several->scenario));
}

// The first member from one on that is still to be stepped to a time; their number: none is.
static size_t several_next_behind(const Several *several, size_t from, double stop_s)
{
    const double last_s = several_last_time(several, stop_s);
    while (from < several->count &&
           several->reached_s[from] >= last_s - several->rounding * several->width_s[from]) {
        from++;
    }
    return from;
}

// The member that is furthest behind.
static size_t several_last_of_all(const Several *several)
{
    size_t last = 0;
    for (size_t i = 1; i < several->count; i++) {
        last = several->reached_s[i] < several->reached_s[last] ? i : last;
    }
    return last;
}

// Chooses the member to step now.
static Member *several_choose(Several *several, double stop_s)
{
    if (several->next == several->count) {
        several->next = several_next_behind(several, 0, stop_s);
    }
    several->now = several->next < several->count ? several->next : several_last_of_all(several);
    return &several->members[several->now];
}

// Notes where the step ended, and whose is next.
static void several_note_step(Several *several, double end_s, double stop_s)
{
    const size_t now = several->now;
    several->width_s[now] = end_s - several->reached_s[now];
    several->reached_s[now] = end_s;
    several->next = several->has_begun ? several_next_behind(several, now, stop_s) : now + 1;
}

// Ends a round, after which none is behind. Returns where all are.
static double several_end_round(Several *several, double stop_s)
{
    const double least_s = several->reached_s[several_last_of_all(several)];
    const double reached_s =
        several->has_begun ? fmax(least_s, several_last_time(several, stop_s)) : least_s;
    several->has_begun = true;
    return reached_s;
}

bool several_step(void *state, double stop_s, Err *err)
{
    Several *several = state;
    Member *member = several_choose(several, stop_s);
    if (!several->solver->step(member->state, stop_s, err)) {
        return false;
    }
    StepRecord *record = &several->record;
    *record = several->solver->record(member->state);
    several_note_step(several, record->end_s, stop_s);
    several->elastic += record->elastic - member->elastic;
    member->elastic = record->elastic;
    record->elastic = several->elastic;
    record->part = &member->part;
    record->is_partial = several->next < several->count;
    record->reached_s = record->is_partial ? 0.0 : several_end_round(several, stop_s);
    return true;
}

bool several_stride(void *state, double stop_s, double *end_s, Err *err)
{
    Several *several = state;
    do {
        Member *member = several_choose(several, stop_s);
        double member_end_s = 0.0;
        if (!solver_stride(several->solver, member->state, stop_s, &member_end_s, err)) {
            return false;
        }
        several_note_step(several, member_end_s, stop_s);
    } while (several->next < several->count);
    *end_s = several_end_round(several, stop_s);
    return true;
}

StepRecord several_record(const void *state)
{
    return ((const Several *)state)->record;
}

static void several_observe_member(const Several *several, Member *member, double time_s,
                                   Sample *sample)
{
    several->solver->observe(member->state, time_s, &member->sample);
    member_show(member, sample);
    sample->time_s = time_s;
    sample->crank_rad = linkage_crank_angle(&several->scenario->linkage, time_s);
}

void several_observe(const void *state, double time_s, Sample *sample)
{
    const Several *several = state;
    for (size_t i = 0; i < several->count; i++) {
        several_observe_member(several, &several->members[i], time_s, sample);
    }
}

void several_observe_part(const void *state, double time_s, Sample *sample)
{
    const Several *several = state;
    several_observe_member(several, &several->members[several->now], time_s, sample);
}

void several_glance(const void *state, double time_s, Sample *sample)
{
    const Several *several = state;
    for (size_t i = 0; i < several->count; i++) {
        Member *member = &several->members[i];
        solver_glance(several->solver, member->state, time_s, &member->sample);
        member_show_bodies(member, sample);
    }
}

void several_contacts(const void *state, ContactState (*states)[JOINT_PLACES])
{
    const Several *several = state;
    ContactState(*own)[JOINT_PLACES] = zeroed(several->scenario->linkage.joint_count, sizeof *own);
    for (size_t i = 0; i < several->count; i++) {
        const Member *member = &several->members[i];
        several->solver->contacts(member->state, own);
        for (size_t k = 0; k < member->part.joint_count; k++) {
            memcpy(states[member->joints[k]], own[k], sizeof own[k]);
        }
    }
    free(own);
}

SolverModel several_model(const void *state)
{
    const Several *several = state;
    SolverModel model = several->solver->model(several->members[0].state);
    for (size_t i = 1; i < several->count; i++) {
        const SolverModel of = several->solver->model(several->members[i].state);
        model.constraint_rows += of.constraint_rows;
        model.contact_rows += of.contact_rows;
        model.fallback_rows += of.fallback_rows;
        model.evaluations += of.evaluations;
        model.steps = of.steps > model.steps ? of.steps : model.steps;
    }
    return model;
}

const Scenario *several_scenario(const void *state)
{
    return ((const Several *)state)->scenario;
}

size_t several_count(const void *state)
{
    return ((const Several *)state)->count;
}

void *several_state(const void *state, size_t number)
{
    return ((const Several *)state)->members[number].state;
}
