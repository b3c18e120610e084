// Settles the runs of a study from the motion of their neighbours.
//
// The chain of a run is that of the values of the key that is followed, from the first one in its
// direction to its own, all else as in the run. Each scenario of it is settled from the one before;
// the first one, and one behind values that make no case, by itself. A process keeps the last chain
// that it has been along: the next run of it takes one step more.
#include "commands/study/follow.h"

#include "base/zeroed.h"
#include "run/settle.h"

#include <stdlib.h>
#include <string.h>

static const RunWatch FOLLOW_UNWATCHED = {.progress = NULL};

// How far a process has come along a chain.
typedef struct Chain {
    uint64_t print;                  // of its study
    Cell values[RECORD_SETTING_MAX]; // of its runs; 0 for the key that is followed
    uint64_t place;                  // of the last, in the chain's order
    bool is_settled;                 // whether there is a scenario there
    Scenario last;                   // owned
} Chain;

static bool is_backward(const Spec *spec, const Cell *values)
{
    const Variable *direction = spec_variable(spec, SPEC_DIRECTION_KEY);
    return direction != NULL ? strcmp(values[direction - spec->variables].word, "backward") == 0
                             : spec->direction == FOLLOW_BACKWARD;
}

// The value at a place of the chain, from 0.
static double value_at(const Variable *variable, bool backward, uint64_t place)
{
    return design_number(variable, backward ? variable->count - 1 - place : place);
}

// Keeps a scenario as the last of the chain; NULL: there is none at its place.
static void keep_last(Chain *chain, uint64_t place, const Scenario *scenario)
{
    if (chain->is_settled) {
        scenario_free(&chain->last);
    }
    chain->place = place;
    chain->is_settled = scenario != NULL;
    if (scenario != NULL) {
        chain->last = scenario_copy(scenario);
    }
}

// Settles a scenario behind the last of the chain.
static void settle_next(const Chain *chain, double before, Scenario *scenario)
{
    if (chain->is_settled && settle_follow(scenario, &chain->last, FOLLOW_UNWATCHED)) {
        scenario->settled.followed_from = before;
    } else if (!chain->is_settled) {
        settle_scenario(scenario, FOLLOW_UNWATCHED);
    }
}

// Goes along the chain to the place before a run's. `values` are the run's own.
static void go_along(const Spec *spec, const Variable *variable, Cell *value, const Cell *values,
                     uint64_t place, Chain *chain)
{
    const bool backward = is_backward(spec, values);
    const bool is_begun = chain->place < place && chain->is_settled;
    for (uint64_t at = is_begun ? chain->place + 1 : 0; at < place; at++) {
        Scenario *scenario = zeroed(1, sizeof *scenario);
        BackendKind backend;
        Err err = {ERR_NONE, ""};
        value->number = value_at(variable, backward, at);
        const bool is_made = design_scenario(spec, values, scenario, &backend, &err);
        if (is_made) {
            settle_next(chain, at > 0 ? value_at(variable, backward, at - 1) : 0.0, scenario);
        }
        keep_last(chain, at, is_made ? scenario : NULL);
        scenario_free(scenario);
        free(scenario);
    }
}

void follow_settle(const Spec *spec, uint64_t run, Scenario *scenario)
{
    static Chain chain;
    const Variable *variable = spec_variable(spec, spec->follow);
    if (variable == NULL || !scenario_lacks_start(scenario)) {
        settle_scenario(scenario, FOLLOW_UNWATCHED);
        return;
    }
    const size_t number = (size_t)(variable - spec->variables);
    Cell values[RECORD_SETTING_MAX];
    design_values(spec, run, values);
    const bool backward = is_backward(spec, values);
    uint64_t place = 0;
    while (value_at(variable, backward, place) != values[number].number) {
        place++;
    }
    Cell others[RECORD_SETTING_MAX];
    memcpy(others, values, sizeof others);
    memset(&others[number], 0, sizeof others[number]);
    if (chain.print != spec->print || memcmp(others, chain.values, sizeof others) != 0 ||
        chain.place >= place) {
        keep_last(&chain, 0, NULL);
        chain.print = spec->print;
        memcpy(chain.values, others, sizeof others);
    }
    go_along(spec, variable, &values[number], values, place, &chain);
    settle_next(&chain, place > 0 ? value_at(variable, backward, place - 1) : 0.0, scenario);
    keep_last(&chain, place, scenario);
}
