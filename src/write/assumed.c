// Lists what a case leaves open and its runs depend on.
#include "write/assumed.h"

#include "casefile/casefile.h"
#include "casefile/schema.h"
#include "contact/law.h"
#include "write/json_value.h"
#include "write/units.h"

#include <string.h>

// A key and its word in the sentence; NULL of one that is for programs alone: it keeps a division
// from 0.
typedef struct Assumption {
    const char *key;
    const char *word;
} Assumption;

static const Assumption ASSUMPTIONS[] = {
    {"contact.model", "contact model"},
    {"contact.law", "law"},
    {"material.youngs-modulus", "E"},
    {"material.poisson-ratio", "nu"},
    {"contact.damping", "damping"},
    {"contact.restitution", "restitution"},
    {"contact.resting-speed", "resting speed"},
    {"contact.restitution-speed", "at"},
    {"contact.friction", "friction"},
    {"contact.friction-speed", "friction speed"},
    {"contact.presliding", "presliding"},
    {"contact.impact-speed-floor", NULL},
    {"contact.penalty", "penalty"},
    {"gravity", "gravity"},
    {"run.start", "start"},
};

static const Assumption *assumption_of(const char *key)
{
    for (size_t i = 0; i < sizeof ASSUMPTIONS / sizeof *ASSUMPTIONS; i++) {
        if (strcmp(ASSUMPTIONS[i].key, key) == 0) {
            return &ASSUMPTIONS[i];
        }
    }
    return NULL;
}

static bool is_given(const Scenario *scenario, const char *key)
{
    for (size_t i = 0; i < scenario->key_count; i++) {
        if (strcmp(SCHEMA_ROWS[scenario->keys[i].row].path, key) == 0) {
            return true;
        }
    }
    return false;
}

// The laws that auto stands for.
static void append_laws(const Scenario *scenario, Text *text)
{
    bool has_law[LAW_COUNT] = {false};
    for (size_t i = 0; i < scenario->linkage.joint_count; i++) {
        const Joint *joint = &scenario->linkage.joints[i];
        const ContactOptions own = law_options(&scenario->contact, joint);
        if (joint_has_hole(joint->kind) && own.stiffness == 0.0) {
            has_law[own.law] = true;
        }
    }
    const char *between = "";
    for (int i = 0; i < LAW_COUNT; i++) {
        if (has_law[i]) {
            text_append(text, "%s%s", between, OPTIONS_LAWS[i]);
            between = " and ";
        }
    }
}

static void append_value(const Scenario *scenario, const CasefileSetting *setting, Text *text)
{
    if (strcmp(setting->key, "contact.law") == 0 && scenario->contact.law == LAW_AUTO) {
        append_laws(scenario, text);
    } else if (setting->number_count == 0 || setting->kind == CASEFILE_WORD) {
        text_append(text, "%s", setting->text);
    } else if (setting->unit[0] == '\0') {
        text_append(text, "%.4g", setting->numbers[0]);
    } else if (strcmp(setting->unit, "m/s^2") == 0) {
        text_append(text, "%.3g %s", setting->numbers[0], setting->unit);
    } else {
        units_append(text, setting->numbers[0], setting->unit);
    }
}

static const char PIN[] = "joints.*.pin";

// Whether a key of a member is given.
static bool is_given_of(const Scenario *scenario, const SchemaRow *row, size_t member)
{
    bool is = false;
    for (size_t i = 0; i < scenario->key_count; i++) {
        const ScenarioKey *key = &scenario->keys[i];
        is = is || (&SCHEMA_ROWS[key->row] == row && key->member == member);
    }
    // a fit of both gives the pin, too
    for (size_t i = 0; i < scenario->tolerance_count; i++) {
        const ScenarioTolerance *given = &scenario->tolerances[i];
        is = is || (&SCHEMA_ROWS[given->row] == row && given->member == member);
    }
    return is;
}

// A pin whose diameter nobody gave, beside a radial clearance: it says how deep a contact may be.
static bool is_assumed_pin(const Scenario *scenario, const CasefileWalk *walk)
{
    const SchemaRow *row = &SCHEMA_ROWS[walk->row];
    const size_t member = walk->member - 1;
    return strcmp(row->path, PIN) == 0 && member < schema_member_count(scenario, SCHEMA_JOINT) &&
           joint_has_hole(scenario->linkage.joints[member].kind) &&
           !is_given_of(scenario, row, member);
}

// Whether some pin presses on an eye whose size nobody gave.
static bool has_assumed_eye(const Scenario *scenario)
{
    for (size_t i = 0; i < scenario->linkage.joint_count; i++) {
        const Joint *joint = &scenario->linkage.joints[i];
        const ContactOptions own = law_options(&scenario->contact, joint);
        if (joint_has_hole(joint->kind) && own.model == CONTACT_IMPACT && own.stiffness == 0.0 &&
            own.law == LAW_ELASTIC && joint->clearance.eye_radius == 0.0) {
            return true;
        }
    }
    return false;
}

// Whether some ideal joint has a bristle whose presliding nobody gave, nor any contact with one.
static bool has_assumed_bend(const Scenario *scenario)
{
    bool has_any = false;
    for (size_t i = 0; i < scenario->linkage.joint_count; i++) {
        const Joint *joint = &scenario->linkage.joints[i];
        const bool is_ideal = joint_is_ideal(joint->kind);
        if (!is_ideal && joint->friction.law != BRISTLE_REGULARIZED) {
            return false; // contact.presliding
        }
        has_any = has_any || (is_ideal && joint->friction.law != BRISTLE_REGULARIZED &&
                              joint->friction.presliding == 0.0);
    }
    return has_any;
}

// Calls back with each assumption.
static void each_assumption(const Scenario *scenario,
                            void (*take)(const Scenario *, const CasefileSetting *,
                                         const char *word, void *),
                            void *context)
{
    const unsigned met = schema_met(scenario);
    bool has_pin = false;
    CasefileSetting setting;
    CasefileWalk walk = casefile_walk(scenario);
    while (casefile_next(&walk, &setting)) {
        if (is_assumed_pin(scenario, &walk)) {
            // the same diameter of all of them
            if (!has_pin) {
                text_copy(setting.key, sizeof setting.key, PIN);
                take(scenario, &setting, "pins", context);
            }
            has_pin = true;
            continue;
        }
        const Assumption *assumption = assumption_of(setting.key);
        if (assumption == NULL || !setting.applies || is_given(scenario, setting.key)) {
            continue;
        }
        SchemaLack lack;
        if (!schema_lacks(schema_find(setting.key), scenario, 0, met, &lack)) {
            take(scenario, &setting, assumption->word, context);
        }
    }
    if (has_assumed_eye(scenario)) {
        CasefileSetting eye = {.kind = CASEFILE_WORD};
        text_copy(eye.key, sizeof eye.key, "joints.*.eye-radius");
        text_copy(eye.text, sizeof eye.text, "twice their holes");
        take(scenario, &eye, "eyes", context);
    }
    if (has_assumed_bend(scenario)) {
        CasefileSetting bend = {
            .kind = CASEFILE_NUMBER, .number_count = 1, .numbers = {scenario->contact.presliding}};
        text_copy(bend.key, sizeof bend.key, "joints.*.presliding");
        text_copy(bend.unit, sizeof bend.unit, "m");
        take(scenario, &bend, "presliding", context);
    }
}

static void take_text(const Scenario *scenario, const CasefileSetting *setting, const char *word,
                      void *context)
{
    Text *text = context;
    // how the motion settled is said where its start is assumed
    const bool is_said =
        strcmp(setting->key, "run.start") == 0 && scenario->settled.motion_count > 0;
    if (word == NULL || is_said) {
        return;
    }
    text_append(text, "%s%s ", text->length > 0 ? ", " : "", word);
    append_value(scenario, setting, text);
}

void assumed_text(const Scenario *scenario, Text *text)
{
    Text own;
    text_init(&own);
    each_assumption(scenario, take_text, &own);
    text_append(text, "%s", own.data != NULL ? own.data : "");
    text_finish(&own);
}

static void take_json(const Scenario *scenario, const CasefileSetting *setting, const char *word,
                      void *context)
{
    (void)word;
    Text value;
    text_init(&value);
    append_value(scenario, setting, &value);
    json_object_set_new(context, setting->key, json_value_text(value.data));
    text_finish(&value);
}

void assumed_json(json_t *object, const Scenario *scenario)
{
    json_t *assumed = json_object();
    each_assumption(scenario, take_json, assumed);
    json_object_set_new(object, "assumed", assumed);
}
