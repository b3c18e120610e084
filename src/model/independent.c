// Steps mechanisms side by side that share nothing but the ground.
//
// Each by itself, in steps of its own: an event of one ends no step of another, and nothing is
// evaluated for all of them together. One after the other is stepped to the time that is asked for
// or beyond, where its sample is looked up in its last step.
#include "model/independent.h"

#include "base/zeroed.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct Independent {
    const Scenario *scenario;
    const Solver *solver; // of one
    double rounding;      // of a step
    size_t count;
    Component *components; // owned
    double *reached_s;     // by component; owned, like the next
    double *width_s;       // of its last step
    size_t now;            // the component whose step was taken last
    size_t next;           // whose step is next; their number: all are where they were asked to be
    bool has_begun;        // after the first step of each: a sample at time zero stands in it
    double elastic;        // J, of all components
    StepRecord record;
} Independent;

void independent_close(void *state)
{
    Independent *independent = state;
    if (independent != NULL) {
        components_free(independent->components, independent->count, independent->solver);
        free(independent->reached_s);
        free(independent->width_s);
        free(independent);
    }
}

bool independent_open(const Scenario *scenario, const Solver *solver, double rounding, void **state,
                      Err *err)
{
    Independent *independent = zeroed(1, sizeof *independent);
    independent->scenario = scenario;
    independent->solver = solver;
    independent->rounding = rounding;
    independent->components = components_make(scenario, &independent->count);
    independent->reached_s = zeroed(independent->count, sizeof *independent->reached_s);
    independent->width_s = zeroed(independent->count, sizeof *independent->width_s);
    for (size_t i = 0; i < independent->count; i++) {
        Component *component = &independent->components[i];
        if (!solver->open(component->scenario, &component->state, err)) {
            independent_close(independent);
            return false;
        }
    }
    *state = independent;
    return true;
}

static double independent_last_time(const Independent *independent, double stop_s)
{
    return fmin(stop_s, scenario_duration(independent->scenario));
}

// The first component from one on that is still to be stepped to a time; their number: none is.
static size_t independent_next_behind(const Independent *independent, size_t from, double stop_s)
{
    const double last_s = independent_last_time(independent, stop_s);
    while (from < independent->count &&
           independent->reached_s[from] >=
               last_s - independent->rounding * independent->width_s[from]) {
        from++;
    }
    return from;
}

// The component that is furthest behind.
static size_t independent_last_of_all(const Independent *independent)
{
    size_t last = 0;
    for (size_t i = 1; i < independent->count; i++) {
        last = independent->reached_s[i] < independent->reached_s[last] ? i : last;
    }
    return last;
}

// Chooses the component to step now.
static Component *independent_choose(Independent *independent, double stop_s)
{
    if (independent->next == independent->count) {
        independent->next = independent_next_behind(independent, 0, stop_s);
    }
    independent->now = independent->next < independent->count
                           ? independent->next
                           : independent_last_of_all(independent);
    return &independent->components[independent->now];
}

// Notes where the step ended, and whose is next.
static void independent_note_step(Independent *independent, double end_s, double stop_s)
{
    const size_t now = independent->now;
    independent->width_s[now] = end_s - independent->reached_s[now];
    independent->reached_s[now] = end_s;
    independent->next =
        independent->has_begun ? independent_next_behind(independent, now, stop_s) : now + 1;
}

// Ends a round, after which none is behind. Returns where all are.
static double independent_end_round(Independent *independent, double stop_s)
{
    const double least_s = independent->reached_s[independent_last_of_all(independent)];
    const double reached_s = independent->has_begun
                                 ? fmax(least_s, independent_last_time(independent, stop_s))
                                 : least_s;
    independent->has_begun = true;
    return reached_s;
}

bool independent_step(void *state, double stop_s, Err *err)
{
    Independent *independent = state;
    Component *component = independent_choose(independent, stop_s);
    if (!independent->solver->step(component->state, stop_s, err)) {
        return false;
    }
    StepRecord *record = &independent->record;
    *record = independent->solver->record(component->state);
    independent_note_step(independent, record->end_s, stop_s);
    independent->elastic += record->elastic - component->elastic;
    component->elastic = record->elastic;
    record->elastic = independent->elastic;
    record->part = &component->part;
    record->is_partial = independent->next < independent->count;
    record->reached_s = record->is_partial ? 0.0 : independent_end_round(independent, stop_s);
    return true;
}

bool independent_stride(void *state, double stop_s, double *end_s, Err *err)
{
    Independent *independent = state;
    do {
        Component *component = independent_choose(independent, stop_s);
        double member_end_s = 0.0;
        if (!solver_stride(independent->solver, component->state, stop_s, &member_end_s, err)) {
            return false;
        }
        independent_note_step(independent, member_end_s, stop_s);
    } while (independent->next < independent->count);
    *end_s = independent_end_round(independent, stop_s);
    return true;
}

StepRecord independent_record(const void *state)
{
    return ((const Independent *)state)->record;
}

static void independent_observe_component(const Independent *independent, Component *component,
                                          double time_s, Sample *sample)
{
    independent->solver->observe(component->state, time_s, &component->sample);
    component_show(component, sample);
    sample->time_s = time_s;
    sample->crank_rad = linkage_crank_angle(&independent->scenario->linkage, time_s);
}

void independent_observe(const void *state, double time_s, Sample *sample)
{
    const Independent *independent = state;
    for (size_t i = 0; i < independent->count; i++) {
        independent_observe_component(independent, &independent->components[i], time_s, sample);
    }
}

void independent_observe_part(const void *state, double time_s, Sample *sample)
{
    const Independent *independent = state;
    independent_observe_component(independent, &independent->components[independent->now], time_s,
                                  sample);
}

void independent_observe_some(const void *state, double time_s, const SolverSome *some,
                              Sample *sample)
{
    const Independent *independent = state;
    Component *component = &independent->components[independent->now];
    independent->solver->observe_some(component->state, time_s, some, &component->sample);
    component_show_some(component, some, sample);
    sample->time_s = time_s;
}

void independent_sketch(const void *state, double time_s, double *omega, double *alpha,
                        double *force)
{
    const Independent *independent = state;
    const Component *component = &independent->components[independent->now];
    independent->solver->sketch(component->state, time_s, omega, alpha, force);
}

void independent_glance(const void *state, double time_s, Sample *sample)
{
    const Independent *independent = state;
    for (size_t i = 0; i < independent->count; i++) {
        Component *component = &independent->components[i];
        solver_glance(independent->solver, component->state, time_s, &component->sample);
        component_show_bodies(component, sample);
    }
}

void independent_contacts(const void *state, ContactState (*states)[JOINT_PLACES])
{
    const Independent *independent = state;
    ContactState(*own)[JOINT_PLACES] =
        zeroed(independent->scenario->linkage.joint_count, sizeof *own);
    for (size_t i = 0; i < independent->count; i++) {
        const Component *component = &independent->components[i];
        independent->solver->contacts(component->state, own);
        for (size_t k = 0; k < component->part.joint_count; k++) {
            memcpy(states[component->joints[k]], own[k], sizeof own[k]);
        }
    }
    free(own);
}

bool independent_carry(void *state, Carry *carry)
{
    Independent *independent = state;
    for (size_t i = 0; i < independent->count; i++) {
        Component *component = &independent->components[i];
        if (!independent->solver->carry(component->state, carry)) {
            return false;
        }
        CARRY(carry, component->elastic);
    }
    CARRY_ARRAY(carry, independent->reached_s, independent->count);
    CARRY_ARRAY(carry, independent->width_s, independent->count);
    CARRY(carry, independent->now);
    CARRY(carry, independent->next);
    CARRY(carry, independent->has_begun);
    CARRY(carry, independent->elastic);
    return true;
}

SolverModel independent_model(const void *state)
{
    const Independent *independent = state;
    SolverModel model = independent->solver->model(independent->components[0].state);
    for (size_t i = 1; i < independent->count; i++) {
        const SolverModel of = independent->solver->model(independent->components[i].state);
        model.constraint_rows += of.constraint_rows;
        model.contact_rows += of.contact_rows;
        model.fallback_rows += of.fallback_rows;
        model.evaluations += of.evaluations;
        model.steps = of.steps > model.steps ? of.steps : model.steps;
    }
    return model;
}

const Scenario *independent_scenario(const void *state)
{
    return ((const Independent *)state)->scenario;
}

size_t independent_count(const void *state)
{
    return ((const Independent *)state)->count;
}

void *independent_state(const void *state, size_t number)
{
    return ((const Independent *)state)->components[number].state;
}
