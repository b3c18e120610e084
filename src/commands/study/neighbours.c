// Settles the groups of a block one from another, and keeps them for its runs.
#include "commands/study/neighbours.h"

#include "base/zeroed.h"
#include "commands/study/worker.h"
#include "run/settle.h"

#include <math.h>
#include <stdlib.h>

static const RunWatch NEIGHBOURS_UNWATCHED = {.progress = NULL};

// A group of the block, and its scenario once that is settled.
typedef struct Place {
    bool is_settled;
    Scenario scenario; // owned
} Place;

// What a process knows of the block whose runs it makes.
typedef struct Block {
    const Spec *spec;
    uint64_t print; // of the study
    uint64_t first; // number of its first group
    size_t count;   // groups; 0: no block is known
    double limit_s; // of what settles one of them
    Place places[DESIGN_BLOCK_GROUPS];
} Block;

// Fewer are not worth two that find their motion by themselves.
enum { COUNT_LEAST = 5 };

static void forget(Place *place)
{
    if (place->is_settled) {
        scenario_free(&place->scenario);
    }
    place->is_settled = false;
}

static void keep_settled(Place *place, Scenario scenario)
{
    forget(place);
    place->scenario = scenario;
    place->is_settled = true;
}

static void block_begin(const Spec *spec, uint64_t group, double limit_s, Block *block)
{
    const uint64_t groups = design_run_count(spec) / design_group_size(spec);
    for (size_t i = 0; i < block->count; i++) {
        forget(&block->places[i]);
    }
    block->spec = spec;
    block->print = spec->print;
    block->first = group - group % DESIGN_BLOCK_GROUPS;
    const uint64_t count = groups - block->first;
    block->count = (size_t)(count < DESIGN_BLOCK_GROUPS ? count : DESIGN_BLOCK_GROUPS);
    block->limit_s = limit_s;
}

// Number of the first run of a place.
static uint64_t run_of(const Block *block, size_t place)
{
    return (block->first + place) * design_group_size(block->spec);
}

// The scenario of a place, by the first of its runs that makes a case.
static bool make_scenario(const Block *block, size_t place, Scenario *scenario)
{
    const uint64_t first = run_of(block, place);
    bool is_made = false;
    for (uint64_t k = 0; k < design_group_size(block->spec) && !is_made; k++) {
        Cell values[RECORD_SETTING_MAX];
        BackendKind backend;
        Err err = {ERR_NONE, ""};
        design_values(block->spec, first + k, values);
        is_made = design_scenario(block->spec, values, scenario, &backend, &err);
    }
    return is_made;
}

// Settles a place by itself.
static bool settle_alone(Block *block, size_t place)
{
    Scenario scenario;
    const bool is_case = make_scenario(block, place, &scenario);
    if (is_case) {
        slot_limit_again(block->limit_s);
        settle_scenario(&scenario, NEIGHBOURS_UNWATCHED);
        keep_settled(&block->places[place], scenario);
    }
    return is_case;
}

// Settles the places behind one to another, either way, each from the one before it; those whose
// values make no case are passed over. False where one of the others cannot be.
static bool settle_along(Block *block, size_t from, size_t to)
{
    size_t last = from;
    for (size_t i = from; i != to;) {
        i += to > from ? 1 : (size_t)-1;
        Scenario scenario;
        if (!make_scenario(block, i, &scenario)) {
            continue;
        }
        slot_limit_again(block->limit_s);
        if (!settle_beside_neighbour(&scenario, &block->places[last].scenario,
                                     NEIGHBOURS_UNWATCHED)) {
            scenario_free(&scenario);
            return false;
        }
        scenario.settled.neighbour = run_of(block, last);
        keep_settled(&block->places[i], scenario);
        last = i;
    }
    return true;
}

// Goes along to a place, and settles it by itself too. False where that is another motion.
static bool settle_twice(Block *block, size_t from, size_t to)
{
    if (!settle_along(block, from, to) || !block->places[to].is_settled) {
        return false;
    }
    Scenario followed = scenario_copy(&block->places[to].scenario);
    settle_alone(block, to);
    SettledStart *own = &block->places[to].scenario.settled;
    own->is_checked = true;
    const bool is_same =
        settle_is_same(&followed, &block->places[to].scenario, &own->apart_from_followed);
    scenario_free(&followed);
    return is_same;
}

// Settles all of the block from two of its places, where that can be and is right; else only what
// is settled by itself is kept.
static void settle_block(Block *block)
{
    const size_t a = block->count / 4;
    const size_t b = 3 * block->count / 4;
    const bool is_right = settle_alone(block, a) && settle_is_clear(&block->places[a].scenario) &&
                          settle_twice(block, a, b) && settle_along(block, a, 0) &&
                          settle_along(block, b, block->count - 1);
    for (size_t i = 0; i < block->count && !is_right; i++) {
        if (block->places[i].is_settled && block->places[i].scenario.settled.is_followed) {
            forget(&block->places[i]);
        }
    }
}

void neighbours_settle(const Spec *spec, uint64_t run, double limit_s, Scenario *scenario)
{
    static Block block;
    if (!scenario_lacks_start(scenario)) {
        return;
    }
    const uint64_t group = design_group(spec, run);
    const bool is_known = block.count > 0 && block.print == spec->print && group >= block.first &&
                          group - block.first < block.count;
    if (!is_known) {
        block_begin(spec, group, limit_s, &block);
        if (block.count >= COUNT_LEAST) {
            settle_block(&block);
        }
    }
    const size_t place = group - block.first;
    if (block.places[place].is_settled || settle_alone(&block, place)) {
        settle_take(scenario, &block.places[place].scenario);
    }
    slot_limit_again(limit_s);
}
