// Reads the numbers that a case sets limits for.
//
//     path = [backend .] bodies . NAME . number | [backend .] joints . NAME . number
//          | [backend .] error . number | [backend .] energy . number | [backend .] section .
//          number | [backend .] cost . number | settled . number
//          | settled . joints . NAME . number
//
// How its runs end is read in expect_outcome.c.
#include "casefile/expect.h"

#include "casefile/expect_outcome.h"
#include "casefile/keys.h"

#include "base/zeroed.h"

#include <stdio.h>
#include <string.h>

enum { SEGMENT_MAX = 4, CHOICE_MAX = EXPECTED_NUMBER_COUNT };

const char *const EXPECT_GROUPS[EXPECT_GROUP_COUNT] = {
    [EXPECT_BODIES] = "bodies",
    [EXPECT_JOINTS] = "joints",
    [EXPECT_ERROR] = "error",
    [EXPECT_ENERGY] = "energy",
    [EXPECT_SECTION] = "section",
    [EXPECT_SETTLED] = "settled",
    [EXPECT_SETTLED_JOINTS] = "settled.joints",
    [EXPECT_COST] = "cost",
};

// clang-format off
#define NUMBER(id, of, word, unit, words) \
    [id] = {.group = of, .name = word, .number = id, .dimension = unit, .doc = words}
#define WHOLE(id, of, word, words) \
    [id] = {.group = of, .name = word, .number = id, .is_count = true, .doc = words}
#define OF_SETTLED_JOINT(id, word, words) \
    [id] = {.group = EXPECT_SETTLED_JOINTS, .name = word, .number = id, .dimension = DIMENSION_FORCE, \
            .needs_play = true, .doc = words}
// by the kind of a number of a joint
#define DIMENSION_OF_COUNT   DIMENSION_NONE
#define DIMENSION_OF_SHARE   DIMENSION_NONE
#define DIMENSION_OF_FORCE   DIMENSION_FORCE
#define DIMENSION_OF_IMPULSE DIMENSION_IMPULSE
#define DIMENSION_OF_DEPTH   DIMENSION_LENGTH
#define OF_JOINT(id, word, of, words, play) \
    [EXPECTED_##id] = {.group = EXPECT_JOINTS, .name = word, .number = EXPECTED_##id, \
                       .dimension = DIMENSION_OF_##of, .is_count = JOINT_NUMBER_OF_##of == JOINT_NUMBER_OF_COUNT, \
                       .needs_play = play, .doc = words},
#define OF_ANY_JOINT(id, word, of, title, turned, format, detail, timed, value, words) \
    OF_JOINT(id, word, of, words, false)
#define OF_JOINT_WITH_PLAY(id, word, of, title, turned, format, detail, timed, value, words) \
    OF_JOINT(id, word, of, words, true)

const ExpectRow EXPECT_ROWS[EXPECTED_NUMBER_COUNT] = {
    NUMBER(EXPECTED_OMEGA_MAX, EXPECT_BODIES, "omega_max", DIMENSION_ANGULAR_SPEED,
           "largest angular velocity"),
    NUMBER(EXPECTED_OMEGA_MIN, EXPECT_BODIES, "omega_min", DIMENSION_ANGULAR_SPEED,
           "smallest angular velocity"),
    NUMBER(EXPECTED_ALPHA_MAX, EXPECT_BODIES, "alpha_max", DIMENSION_ANGULAR_ACCELERATION,
           "largest angular acceleration"),
    NUMBER(EXPECTED_ALPHA_MIN, EXPECT_BODIES, "alpha_min", DIMENSION_ANGULAR_ACCELERATION,
           "smallest angular acceleration"),
    WHOLE(EXPECTED_ALPHA_SPIKES, EXPECT_BODIES, "alpha_spikes",
          "number of spikes of the angular acceleration"),
    NUMBER(EXPECTED_OMEGA_ORDER_1, EXPECT_BODIES, "omega_order_1", DIMENSION_ANGULAR_SPEED,
           "amplitude of the angular velocity at once the crank's speed"),
    NUMBER(EXPECTED_OMEGA_ORDER_2, EXPECT_BODIES, "omega_order_2", DIMENSION_ANGULAR_SPEED,
           "the same at twice its speed"),
    NUMBER(EXPECTED_OMEGA_BETWEEN_ORDERS, EXPECT_BODIES, "omega_between_orders",
           DIMENSION_ANGULAR_SPEED,
           "its largest amplitude between whole multiples of the crank's speed"),
    NUMBER(EXPECTED_OMEGA_SECTION, EXPECT_BODIES, "omega_section", DIMENSION_ANGULAR_SPEED,
           "angular velocity at the end of the last whole revolution"),
    JOINT_NUMBERS_OF_ANY_LIST(OF_ANY_JOINT)
    WHOLE(EXPECTED_FORCE_SPIKES, EXPECT_JOINTS, "force_spikes", "number of spikes of the force"),
    JOINT_NUMBERS_OF_PLAY_LIST(OF_JOINT_WITH_PLAY)
    NUMBER(EXPECTED_ERROR_MAX, EXPECT_ERROR, "max", DIMENSION_NONE,
           "largest error of any velocity of bodies and pins, over its own largest"),
    NUMBER(EXPECTED_ERROR_OMEGA_MAX, EXPECT_ERROR, "omega_max", DIMENSION_NONE,
           "largest error of omega, over each body's largest omega"),
    NUMBER(EXPECTED_ERROR_OMEGA_RMS, EXPECT_ERROR, "omega_rms", DIMENSION_NONE,
           "root mean square of the errors of omega"),
    NUMBER(EXPECTED_ERROR_ALPHA_MAX, EXPECT_ERROR, "alpha_max", DIMENSION_NONE,
           "largest error of alpha, relative to each body's largest alpha"),
    NUMBER(EXPECTED_ERROR_FORCE_MAX, EXPECT_ERROR, "force_max", DIMENSION_NONE,
           "largest error of a contact force at samples, over the joint's largest"),
    NUMBER(EXPECTED_ERROR_PEAK_FORCE_MAX, EXPECT_ERROR, "peak_force_max", DIMENSION_NONE,
           "largest error of the peak force of a contact, over the joint's largest"),
    NUMBER(EXPECTED_ERROR_PEAK_ALPHA_MAX, EXPECT_ERROR, "peak_alpha_max", DIMENSION_NONE,
           "largest error of a body's extremes of alpha, over the larger of them"),
    NUMBER(EXPECTED_DRIVE_WORK, EXPECT_ENERGY, "drive_work", DIMENSION_ENERGY,
           "work of the drive"),
    NUMBER(EXPECTED_DISSIPATED, EXPECT_ENERGY, "dissipated", DIMENSION_ENERGY,
           "lost in the damping of contacts and dampers"),
    NUMBER(EXPECTED_CHANGE, EXPECT_ENERGY, "change", DIMENSION_ENERGY,
           "change of kinetic, potential and elastic energy"),
    NUMBER(EXPECTED_RESIDUAL, EXPECT_ENERGY, "residual", DIMENSION_ENERGY,
           "what the balance leaves unexplained: the solver's error"),
    WHOLE(EXPECTED_SECTION_PERIOD, EXPECT_SECTION, "period",
          "revolutions after which the run repeats; 0: it has not"),
    NUMBER(EXPECTED_SECTION_CHANGE, EXPECT_SECTION, "change", DIMENSION_NONE,
           "by how much the sections of the last period differ from those before, of the fastest "
           "point"),
    WHOLE(EXPECTED_SETTLED_PERIOD, EXPECT_SETTLED, "period",
          "revolutions after which the settled motion repeats; 0: it does not"),
    WHOLE(EXPECTED_SETTLED_MOTIONS, EXPECT_SETTLED, "motions",
          "different motions that starts settle in"),
    NUMBER(EXPECTED_SETTLED_SHARE, EXPECT_SETTLED, "share", DIMENSION_NONE,
           "share of the starts that come to the settled motion, of those whose motion is known"),
    NUMBER(EXPECTED_SETTLED_GROWTH, EXPECT_SETTLED, "growth", DIMENSION_NONE,
           "by what a small change of the settled motion is multiplied in a revolution, or its "
           "bound where it is gone"),
    OF_SETTLED_JOINT(EXPECTED_SETTLED_FORCE_MAX, "force_max",
                     "settled motion's largest force; 95 % quantile where it does not repeat"),
    OF_SETTLED_JOINT(EXPECTED_SETTLED_FORCE_MEDIAN, "force_median",
                     "median of the largest force in a revolution of the settled motion"),
    OF_SETTLED_JOINT(EXPECTED_SETTLED_FORCE_LARGEST, "force_largest",
                     "largest force in all revolutions that were counted"),
    WHOLE(EXPECTED_STEPS, EXPECT_COST, "steps", "steps of the solver"),
    WHOLE(EXPECTED_EVALUATIONS, EXPECT_COST, "evaluations",
          "evaluations of the equations of motion"),
};
// clang-format on

// A path cut at its dots, and where it stands.
typedef struct Path {
    const Source *source;
    const Node *node;
    size_t count;
    char segments[SEGMENT_MAX][LINKAGE_NAME_SIZE];
    size_t starts[SEGMENT_MAX]; // in characters, from the start of the key
    size_t first;               // segment behind the backend
    size_t member;              // segment of the name of a body or joint
} Path;

static Span segment_span(const Path *path, size_t segment)
{
    const size_t start = keys_text_start(path->node) + path->starts[segment];
    const char *name = path->segments[segment];
    return (Span){start, start + source_count(name, strlen(name))};
}

static bool refuse_path(const Path *path, Err *err)
{
    return source_error(
        path->source, keys_span(path->node),
        "joints.NAME.NUMBER, bodies.NAME.NUMBER, error.NUMBER, energy.NUMBER, "
        "section.NUMBER, cost.NUMBER, outcome, each with a backend before it or none; "
        "settled.NUMBER, settled.joints.NAME.NUMBER",
        err, "'%.60s' is not the path of a number", path->node->key->text);
}

static bool cut_path(Path *path, Err *err)
{
    const char *rest = path->node->key->text;
    for (;;) {
        const size_t length = strcspn(rest, ".");
        if (path->count == SEGMENT_MAX || length == 0 || length >= LINKAGE_NAME_SIZE) {
            return refuse_path(path, err);
        }
        const size_t before = (size_t)(rest - path->node->key->text);
        path->starts[path->count] = source_count(path->node->key->text, before);
        memcpy(path->segments[path->count], rest, length);
        path->segments[path->count++][length] = '\0';
        if (rest[length] == '\0') {
            return true;
        }
        rest += length + 1;
    }
}

static int find_word(const char *word, const char *const *words, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        if (strcmp(word, words[i]) == 0) {
            return (int)i;
        }
    }
    return -1;
}

// The backend in front, if there is one.
static void take_backend(Path *path, Expectation *expectation)
{
    expectation->backend = find_word(path->segments[0], OPTIONS_BACKENDS, BACKEND_COUNT);
    path->first = expectation->backend >= 0 ? 1 : 0;
}

// The words that a path can begin with.
static size_t first_words(bool has_backend, const char *choices[EXPECT_GROUP_COUNT + BACKEND_COUNT])
{
    size_t count = 0;
    for (int i = 0; i < EXPECT_GROUP_COUNT; i++) {
        if (i != EXPECT_SETTLED_JOINTS) {
            choices[count++] = EXPECT_GROUPS[i];
        }
    }
    for (int i = 0; !has_backend && i < BACKEND_COUNT; i++) {
        choices[count++] = OPTIONS_BACKENDS[i];
    }
    return count;
}

static bool find_group(Path *path, ExpectGroup *group, Err *err)
{
    if (path->first == path->count) {
        return refuse_path(path, err);
    }
    const int found = find_word(path->segments[path->first], EXPECT_GROUPS, EXPECT_GROUP_COUNT);
    if (found < 0) {
        const char *choices[EXPECT_GROUP_COUNT + BACKEND_COUNT];
        const size_t count = first_words(path->first > 0, choices);
        return keys_refuse(path->source, segment_span(path, path->first), "part of a path",
                           path->segments[path->first], choices, count, err);
    }
    *group = (ExpectGroup)found;
    path->member = path->first + 1;
    if (*group == EXPECT_SETTLED && path->first > 0) {
        return refuse_path(path, err);
    }
    if (*group == EXPECT_SETTLED && path->count > 2 && strcmp(path->segments[1], "joints") == 0) {
        *group = EXPECT_SETTLED_JOINTS;
        path->member++;
    }
    return path->count == path->member + (expect_has_member(*group) ? 2 : 1) ||
           refuse_path(path, err);
}

static bool find_member(const Path *path, const Entries *entries, ExpectGroup group,
                        Expectation *expectation, Err *err)
{
    if (!expect_has_member(group)) {
        expectation->member = 0;
        return true;
    }
    const SchemaFamily family = group == EXPECT_BODIES ? SCHEMA_BODY : SCHEMA_JOINT;
    const EntryNames *names = &entries->names[family];
    const char *name = path->segments[path->member];
    expectation->member = entries_number(entries, family, name);
    if (expectation->member >= 0) {
        return true;
    }
    const char **choices = zeroed(names->count, sizeof *choices);
    for (size_t i = 0; i < names->count; i++) {
        choices[i] = names->names[i];
    }
    keys_refuse(path->source, segment_span(path, path->member), SCHEMA_FAMILIES[family].what, name,
                choices, names->count, err);
    free(choices);
    return false;
}

static bool has_joint(ExpectGroup group)
{
    return expect_has_member(group) && group != EXPECT_BODIES;
}

static bool find_number(const Path *path, ExpectGroup group, const Scenario *scenario,
                        Expectation *expectation, Err *err)
{
    const size_t last = path->count - 1;
    const bool is_ideal =
        has_joint(group) && !linkage_has_play(&scenario->linkage.joints[expectation->member]);
    const char *choices[CHOICE_MAX];
    size_t count = 0;
    for (int i = 0; i < EXPECTED_NUMBER_COUNT; i++) {
        const ExpectRow *row = &EXPECT_ROWS[i];
        const bool is_it = row->group == group && strcmp(row->name, path->segments[last]) == 0;
        if (row->group == group && !(row->needs_play && is_ideal)) {
            choices[count++] = row->name;
        }
        if (is_it && !(row->needs_play && is_ideal)) {
            expectation->number = row->number;
            return true;
        }
        if (is_it) {
            return source_error(
                path->source, segment_span(path, last),
                group == EXPECT_JOINTS ? "force_max, force_spikes" : "a joint with play", err,
                "%s has no play, and so no %s", path->segments[last - 1], row->name);
        }
    }
    return keys_refuse(path->source, segment_span(path, last), "number", path->segments[last],
                       choices, count, err);
}

// The row of a number: of a joint whose limits turn it forces are torques and lengths angles.
static ExpectRow row_of(const Scenario *scenario, ExpectGroup group, const Expectation *expectation)
{
    ExpectRow row = EXPECT_ROWS[expectation->number];
    if (has_joint(group) && linkage_is_torsional(&scenario->linkage.joints[expectation->member])) {
        row.dimension = row.dimension == DIMENSION_FORCE     ? DIMENSION_TORQUE
                        : row.dimension == DIMENSION_IMPULSE ? DIMENSION_ANGULAR_IMPULSE
                        : row.dimension == DIMENSION_LENGTH  ? DIMENSION_ANGLE
                                                             : row.dimension;
    }
    return row;
}

// A limit; what is wrong with it is shown where it stands, if the text is that of the file.
static bool read_limit(const Path *path, const ExpectRow *row, Expectation *expectation, Err *err)
{
    const Node *node = path->node;
    if (node->kind != NODE_SCALAR || node->text[0] == '\0') {
        return source_error(path->source, node->kind != NODE_SCALAR ? node->span : keys_span(node),
                            EXPECT_FORMS, err, "%.100s %s", node->key->text,
                            node->kind != NODE_SCALAR ? "takes one limit" : "has no limit");
    }
    Complaint complaint = {.allowed = ""};
    size_t start = 0;
    size_t length = 0;
    if (expect_limit_read(node->text, row, expectation, &complaint, &start, &length)) {
        return true;
    }
    Span span = node->span;
    if (span.end - span.start == source_count(node->text, strlen(node->text))) {
        const size_t before = source_count(node->text, start);
        span.start += before;
        span.end = span.start + source_count(node->text + start, length);
    }
    return source_error(path->source, span, complaint.allowed, err, "%s", complaint.text);
}

static bool read_one(const Entries *entries, const Entry *entry, const Node *node,
                     Scenario *scenario, Err *err)
{
    Path path = {.source = entry->source, .node = node};
    Expectation read = {.backend = EXPECTATION_ANY_BACKEND};
    ExpectGroup group = EXPECT_BODIES;
    if (!cut_path(&path, err)) {
        return false;
    }
    take_backend(&path, &read);
    if (!find_group(&path, &group, err) || !find_member(&path, entries, group, &read, err) ||
        !find_number(&path, group, scenario, &read, err)) {
        return false;
    }
    const ExpectRow row = row_of(scenario, group, &read);
    if (!read_limit(&path, &row, &read, err)) {
        return false;
    }
    text_copy(read.path, sizeof read.path, node->key->text + path.starts[path.first]);
    scenario->expectations[scenario->expectation_count++] = read;
    return true;
}

static bool add_outcome(const Entry *entry, const Node *node, Scenario *scenario, Err *err)
{
    ExpectedOutcome *outcome = &scenario->outcomes[scenario->outcome_count];
    if (!expect_outcome_read(entry->source, node, outcome, err)) {
        return false;
    }
    scenario->outcome_count++;
    return true;
}

static bool refuse_count(const Source *source, const Node *node, size_t most, Err *err)
{
    char allowed[32];
    snprintf(allowed, sizeof allowed, "at most %zu", most);
    return source_error(source, keys_span(node), allowed, err, "one expectation too many");
}

bool expect_store(const Entries *entries, const Entry *entry, Scenario *scenario, Err *err)
{
    const Node *map = entry->node;
    if (!keys_check_map(entry->source, map, err)) {
        return false;
    }
    if (scenario->expectations == NULL) {
        scenario->expectations = zeroed(EXPECTATION_MAX, sizeof *scenario->expectations);
        scenario->outcomes = zeroed(OUTCOME_MAX, sizeof *scenario->outcomes);
    }
    scenario->expectation_count = 0;
    scenario->outcome_count = 0;
    for (const Node *node = map->first; node != NULL; node = node->next) {
        const bool is_outcome = expect_outcome_is(node);
        const size_t count = is_outcome ? scenario->outcome_count : scenario->expectation_count;
        if (count == (is_outcome ? OUTCOME_MAX : EXPECTATION_MAX)) {
            return refuse_count(entry->source, node, count, err);
        }
        if (!keys_check_single(entry->source, map, node, err) ||
            !(is_outcome ? add_outcome(entry, node, scenario, err)
                         : read_one(entries, entry, node, scenario, err))) {
            return false;
        }
    }
    return true;
}
