// Lists what draws change of a case: numbers with tolerances, and numbers that no drawing is as
// sure of as it looks.
#include "base/hash.h"
#include "base/lcg.h"
#include "base/zeroed.h"
#include "casefile/schema.h"
#include "contact/law.h"
#include "run/spread.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// What is assumed of a key that has no tolerance, where it applies.
typedef struct Assumed {
    const char *path;
    double share;    // of the number to either side
    double distance; // or that far, SI
} Assumed;

// docs/spread.md says why.
static const Assumed ASSUMED[] = {
    {"contact.restitution", 0.0, 0.02},
    {"joints.*.restitution", 0.0, 0.02},
    {"material.youngs-modulus", 0.1, 0.0},
    {"contact.stiffness", 0.1, 0.0},
    {"joints.*.stiffness", 0.1, 0.0},
    {"contact.friction", 0.2, 0.0},
    {"joints.*.friction", 0.2, 0.0},
    {"contact.viscous-coefficient", 0.1, 0.0},
    {"joints.*.viscous-coefficient", 0.1, 0.0},
    {"contact.dissipation", 0.1, 0.0},
    {"joints.*.dissipation", 0.1, 0.0},
    {"drive.speed", 0.01, 0.0},
    {"joints.*.radial-clearance", 0.05, 0.0},
    {"joints.*.backlash", 0.05, 0.0},
};

// 1: of the play, by which a hole or a guide is assumed to be off where neither it nor its partner
// has a tolerance
static const double PLAY_SHARE = 0.05;

// A size of which play is what is left of another.
static const char *const PARTNERS[][2] = {
    {"joints.*.hole", "joints.*.pin"},
    {"joints.*.guide", "joints.*.block"},
};

static bool is_given(const Scenario *scenario, const SchemaRow *row, size_t member)
{
    for (size_t i = 0; i < scenario->key_count; i++) {
        const ScenarioKey *key = &scenario->keys[i];
        if (&SCHEMA_ROWS[key->row] == row && key->member == member) {
            return true;
        }
    }
    return false;
}

// Whether a joint's stiffness is one that was given by the depth that it is for.
static bool is_given_for(const Scenario *scenario, const SchemaRow *row, size_t member)
{
    const Joint *joint = schema_member(scenario, SCHEMA_JOINT, member);
    return row->type == SCHEMA_STIFFNESS && row->family == SCHEMA_JOINT &&
           joint->contact.for_depth > 0.0;
}

static bool has_tolerance(const Scenario *scenario, const char *path, size_t member)
{
    for (size_t i = 0; i < scenario->tolerance_count; i++) {
        const ScenarioTolerance *given = &scenario->tolerances[i];
        if (given->member == member && strcmp(SCHEMA_ROWS[given->row].path, path) == 0) {
            return true;
        }
    }
    return false;
}

static SpreadInput *add(SpreadInputs *inputs)
{
    inputs->inputs = memory_grown(inputs->inputs, inputs->count + 1, sizeof *inputs->inputs);
    SpreadInput *added = &inputs->inputs[inputs->count++];
    *added = (SpreadInput){.item_count = 1};
    return added;
}

static void set_items(SpreadInput *input, const CasefileSetting *setting)
{
    input->item_count = setting->number_count;
    text_copy(input->item_unit, sizeof input->item_unit, setting->unit);
    for (size_t i = 0; i < setting->number_count && i < 3; i++) {
        input->items[i] = setting->numbers[i];
    }
}

// A tolerance that the case gives; nothing of a key that the case makes no use of.
static void add_given(const Scenario *scenario, const CasefileWalk *walk,
                      const CasefileSetting *setting, SpreadInputs *inputs)
{
    for (size_t i = 0; i < scenario->tolerance_count; i++) {
        const ScenarioTolerance *given = &scenario->tolerances[i];
        if (given->row != walk->row || given->member + 1 != walk->member ||
            !(given->lower < given->upper)) {
            continue;
        }
        SpreadInput *input = add(inputs);
        text_copy(input->key, sizeof input->key, setting->key);
        input->item = given->item;
        input->nominal = given->nominal;
        input->lower = given->lower;
        input->upper = given->upper;
        input->is_given = true;
        text_copy(input->unit, sizeof input->unit, given->unit);
        if (setting->kind == CASEFILE_NUMBER && setting->number_count > 1) {
            set_items(input, setting);
        }
    }
}

static void add_assumed(const CasefileSetting *setting, const SchemaRow *row, double distance,
                        SpreadInputs *inputs)
{
    const double nominal = setting->numbers[0];
    const double scale = row->type == SCHEMA_DIAMETER ? 2.0 : 1.0;
    const double low = fmax(nominal - distance, scale * row->low);
    const double high = fmin(nominal + distance, scale * row->high);
    if (!(low < high)) {
        return;
    }
    SpreadInput *input = add(inputs);
    text_copy(input->key, sizeof input->key, setting->key);
    text_copy(input->unit, sizeof input->unit, setting->unit);
    input->nominal = nominal;
    input->lower = low - nominal;
    input->upper = high - nominal;
}

// Half of what is assumed of a row's number, SI; 0: nothing is.
static double assumed_distance(const Scenario *scenario, const SchemaRow *row, size_t member,
                               const CasefileSetting *setting)
{
    const bool is_star = strchr(setting->key, '*') != NULL;
    // a joint without a value of its own has that of the contact
    const bool is_own = row->family == SCHEMA_SINGLE || is_given(scenario, row, member) ||
                        is_given_for(scenario, row, member);
    if (is_star || !is_own || setting->kind != CASEFILE_NUMBER || setting->number_count != 1) {
        return 0.0;
    }
    if (strcmp(row->path, "material.youngs-modulus") == 0 && !law_is_asked(scenario)) {
        return 0.0;
    }
    for (size_t i = 0; i < sizeof ASSUMED / sizeof *ASSUMED; i++) {
        if (strcmp(row->path, ASSUMED[i].path) == 0) {
            return ASSUMED[i].share * fabs(setting->numbers[0]) + ASSUMED[i].distance;
        }
    }
    for (size_t i = 0; i < sizeof PARTNERS / sizeof *PARTNERS; i++) {
        if (strcmp(row->path, PARTNERS[i][0]) == 0 &&
            !has_tolerance(scenario, PARTNERS[i][1], member)) {
            const Joint *joint = schema_member(scenario, SCHEMA_JOINT, member);
            return 2.0 * PLAY_SHARE * linkage_radial_clearance(joint);
        }
    }
    return 0.0;
}

SpreadInputs spread_inputs(const Scenario *scenario)
{
    SpreadInputs inputs = {.count = 0};
    CasefileSetting setting;
    CasefileWalk walk = casefile_walk(scenario);
    while (casefile_next(&walk, &setting)) {
        if (!setting.applies) {
            continue;
        }
        const SchemaRow *row = &SCHEMA_ROWS[walk.row];
        const size_t before = inputs.count;
        const size_t member = walk.member - 1;
        add_given(scenario, &walk, &setting, &inputs);
        if (inputs.count == before) {
            const double distance = assumed_distance(scenario, row, member, &setting);
            if (distance > 0.0) {
                add_assumed(&setting, row, distance, &inputs);
            }
        }
    }
    return inputs;
}

void spread_inputs_free(SpreadInputs *inputs)
{
    free(inputs->inputs);
    *inputs = (SpreadInputs){.count = 0};
}

double spread_drawn(const SpreadInput *input, unsigned draw)
{
    uint64_t seed = hash_bytes(HASH_START, input->key, strlen(input->key));
    seed = hash_word(hash_word(seed, input->item), draw);
    seed = hash_word(seed, lcg_stirred(draw));
    const double share = 0.5 * (lcg_draw(&seed) + 1.0);
    return input->nominal + input->lower + share * (input->upper - input->lower);
}
