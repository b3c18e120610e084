// Holds a key or a value of another file against a case.
//
// The key is taken as an override of the case, and the value is stored into a scratch
// scenario: so the words of a mistake are those of a mistake in the case itself.
#include "casefile/probe.h"
#include "casefile/quantity.h"

#include "casefile/assemble.h"
#include "casefile/check.h"
#include "casefile/input.h"
#include "casefile/joint_kind.h"
#include "casefile/keys.h"
#include "casefile/limits.h"
#include "casefile/store.h"
#include "casefile/target.h"
#include "casefile/tolerance.h"
#include "casefile/waves.h"

#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct Probe {
    Source source;
    Node *root;
    Entries entries;
};

Probe *probe_open(const char *name, const char *text, size_t size, Err *err)
{
    Probe *probe = calloc(1, sizeof *probe);
    assert(probe != NULL);
    if (!input_parse("case", name, text, size, &probe->source, &probe->root, err) ||
        !entries_read(&probe->entries, probe->root, &probe->source, err)) {
        probe_close(probe);
        return NULL;
    }
    return probe;
}

void probe_close(Probe *probe)
{
    if (probe != NULL) {
        document_destroy(probe->root);
        entries_finish(&probe->entries);
        free(probe);
    }
}

bool probe_set(Probe *probe, const Source *source, const Node *value, Err *err)
{
    return entries_override(&probe->entries, value->key->text, keys_text_start(value), value,
                            source, err);
}

static ProbeKind kind_of(SchemaType type)
{
    switch (type) {
    case SCHEMA_INTEGER:
        return PROBE_WHOLE;
    case SCHEMA_CHOICE:
    case SCHEMA_STIFFNESS_FOR:
    case SCHEMA_BODY_NAME:
    case SCHEMA_JOINT_NAME:
        return PROBE_WORD;
    case SCHEMA_BACKENDS:
    case SCHEMA_TEXT:
    case SCHEMA_VECTOR:
    case SCHEMA_DIRECTION:
    case SCHEMA_START:
    case SCHEMA_DISCS:
    case SCHEMA_SLOT:
    case SCHEMA_ANCHOR:
    case SCHEMA_BETWEEN:
    case SCHEMA_CURVE:
    case SCHEMA_SIGNAL:
    case SCHEMA_EXPECT:
        return PROBE_OTHER;
    default:
        return PROBE_NUMBER;
    }
}

// A group is no key; its keys are what is allowed.
static bool refuse_group(const Probe *probe, const Source *source, const Node *value, Err *err)
{
    return source_error(source, keys_span(value), "the path of a key, such as drive.speed", err,
                        "'%.60s' is a group of keys in a case with %s", value->key->text,
                        schema_form(probe->entries.form)->key);
}

// What a part of a sinusoid takes, by its dimension.
#define PROBE_PART_ROW(id, ...)                                                                    \
    [id] = {.path = "signals.*",                                                                   \
            .type = SCHEMA_QUANTITY,                                                               \
            .dimension = id,                                                                       \
            .low = -INFINITY,                                                                      \
            .high = INFINITY},
static const SchemaRow PART_ROWS[DIMENSION_COUNT] = {UNITS_DIMENSION_LIST(PROBE_PART_ROW)};

// The row of a part.
static const SchemaRow *part_row(const Entries *entries, const ProbeKey *key)
{
    const Entry own = {.row = key->row, .index = key->index};
    return &PART_ROWS[waves_dimension(entries, &own, key->part)];
}

bool probe_key(const Probe *probe, const Source *source, const Node *value, ProbeKey *key, Err *err)
{
    // a name that is new must not stay
    Entries entries = entries_copy(&probe->entries);
    ProbeKey found = {0};
    bool is_good = entries_key(&entries, value->key->text, keys_text_start(value), source,
                               &found.row, &found.index, &found.part, err);
    if (is_good && found.row == NULL) {
        is_good = refuse_group(probe, source, value, err);
    }
    if (is_good) {
        text_copy(found.path, sizeof found.path, value->key->text);
        found.row = found.part == ENTRY_WHOLE ? found.row : part_row(&entries, &found);
        found.kind = kind_of(found.row->type);
        if (found.row->family == SCHEMA_JOINT) {
            found.joint_kind = joint_kind_find(&entries, found.index);
        }
        *key = found;
    }
    entries_finish(&entries);
    return is_good;
}

// A scenario that has the member of a key, and of each other family as many.
static Scenario *scratch_scenario(const ProbeKey *key)
{
    Scenario *scratch = malloc(sizeof *scratch);
    assert(scratch != NULL);
    *scratch = scenario_default();
    const size_t room = key->row->member + key->index + 1;
    Linkage *linkage = &scratch->linkage;
    *linkage = linkage_create((LinkageRoom){room, room, room, room, room, room, room, room});
    linkage->body_count = linkage->joint_count = room;
    linkage->spring_count = linkage->torsion_count = linkage->load_count = room;
    linkage->further_count = linkage->bushing_count = room;
    scratch->point_count = SCENARIO_POINT_MAX;
    return scratch;
}

bool probe_check(const Probe *probe, const Source *source, const ProbeKey *key, const Node *value,
                 Err *err)
{
    const Entry entry = {key->row, key->index, value, source, NULL};
    ProbeNumber number;
    if (key->part != ENTRY_WHOLE || key->row->type == SCHEMA_SIGNAL) {
        // what it is of says what it may be
        return key->part == ENTRY_WHOLE || probe_number(source, key, value, &number, err);
    }
    Scenario *scratch = scratch_scenario(key);
    if (key->row->family == SCHEMA_JOINT) {
        Joint *joint = &scratch->linkage.joints[key->index];
        joint->kind = joint_kind_find(&probe->entries, key->index);
        joint->limits = limits_prepare(&probe->entries, key->index);
    }
    const bool is_good = store_value(&probe->entries, &entry, scratch, err);
    scenario_free(scratch);
    free(scratch);
    return is_good;
}

bool probe_number(const Source *source, const ProbeKey *key, const Node *value, ProbeNumber *number,
                  Err *err)
{
    const SchemaRow own = limits_row(key->row, key->joint_kind, value);
    const SchemaRow *row = &own;
    TargetNumber read;
    Complaint complaint = {0};
    if (value->kind != NODE_SCALAR || value->text[0] == '\0') {
        return source_error(source, keys_span(value), units_example(row->dimension), err,
                            "expected a single value");
    }
    Tolerated cut;
    if (!tolerance_read(row, value->text, &cut, &complaint) ||
        (!cut.is_there && !target_read(row, value->text, &read, &complaint))) {
        return source_error(source, value->span, complaint.allowed, err, "%s", complaint.text);
    }
    if (cut.is_there) {
        return source_error(source, value->span, "a length alone", err,
                            "this value has a tolerance");
    }
    double si;
    const Unit *given = NULL;
    const bool has_given =
        quantity_parse_unit(value->text, row->dimension, &si, &given, &(Complaint){0});
    number->value = read.value;
    number->given = has_given ? given : NULL;
    text_copy(number->unit, sizeof number->unit,
              row->type != SCHEMA_SPAN ? units_si(row->dimension)
              : read.is_in_turns       ? "revolutions"
                                       : "s");
    if (row->type == SCHEMA_STIFFNESS) {
        const bool is_torsional = row->dimension == DIMENSION_TORSION_SPRING;
        const char *linear = units_si(is_torsional ? row->dimension : DIMENSION_SPRING);
        snprintf(number->unit, sizeof number->unit, read.exponent == 1.0 ? "%s" : "%s^%.17g",
                 linear, read.exponent);
    }
    return true;
}

bool probe_is_whole(const Probe *probe, Err *err)
{
    return check_required(&probe->entries, err);
}

JointKind probe_joint_kind(const Probe *probe, size_t joint)
{
    return joint_kind_find(&probe->entries, joint);
}

bool probe_scenario(const Probe *probe, Scenario *scenario, Err *err)
{
    return assemble_scenario(&probe->entries, scenario, err);
}
