// Reads the numbers that a case sets limits for.
//
//     path = [backend .] bodies . NAME . number | [backend .] joints . NAME . number
//          | [backend .] part . number | settled . number
//          | settled . bodies . NAME . number | settled . joints . NAME . number
//
// The parts are those of NUMBER_OWNER_LIST, the numbers those of NUMBER_LIST that have
// NUMBER_EXPECT (model/number_list.h).
// How its runs end is read in expect_outcome.c.
#include "casefile/expect.h"

#include "casefile/expect_outcome.h"
#include "casefile/keys.h"

#include "base/zeroed.h"

#include <stdio.h>
#include <string.h>

enum { SEGMENT_MAX = 4, CHOICE_MAX = NUMBER_COUNT };

static Dimension dimension_of(NumberKind kind, NumberTurn turn)
{
    const bool is_turned = turn == NUMBER_TURNED;
    switch (kind) {
    case NUMBER_OF_COUNT:
    case NUMBER_OF_EFFORT:
    case NUMBER_OF_SHARE:
    case NUMBER_OF_RATIO:
    case NUMBER_OF_MICROSECONDS:
        return DIMENSION_NONE;
    case NUMBER_OF_FORCE:
        return is_turned ? DIMENSION_TORQUE : DIMENSION_FORCE;
    case NUMBER_OF_IMPULSE:
        return is_turned ? DIMENSION_ANGULAR_IMPULSE : DIMENSION_IMPULSE;
    case NUMBER_OF_DEPTH:
        return is_turned ? DIMENSION_ANGLE : DIMENSION_LENGTH;
    case NUMBER_OF_APPROACH:
        return is_turned ? DIMENSION_ANGULAR_SPEED : DIMENSION_SPEED;
    case NUMBER_OF_SIGNAL:
        return turn == NUMBER_SPED ? DIMENSION_ANGULAR_ACCELERATION
                                   : dimension_of(NUMBER_OF_FORCE, turn);
    case NUMBER_OF_SIGNAL_IMPULSE:
        return turn == NUMBER_SPED ? DIMENSION_ANGULAR_SPEED
                                   : dimension_of(NUMBER_OF_IMPULSE, turn);
    case NUMBER_OF_LENGTH:
        return DIMENSION_LENGTH;
    case NUMBER_OF_ANGLE:
        return DIMENSION_ANGLE;
    case NUMBER_OF_SPEED:
        return DIMENSION_SPEED;
    case NUMBER_OF_ANGULAR_SPEED:
        return DIMENSION_ANGULAR_SPEED;
    case NUMBER_OF_ANGULAR_ACCELERATION:
        return DIMENSION_ANGULAR_ACCELERATION;
    case NUMBER_OF_ENERGY:
        return DIMENSION_ENERGY;
    case NUMBER_OF_PRESSURE:
        return DIMENSION_PRESSURE;
    case NUMBER_OF_PRESSURE_SPEED:
        return DIMENSION_PRESSURE_SPEED;
    case NUMBER_OF_TIME:
    case NUMBER_OF_SPAN:
        return DIMENSION_TIME;
    case NUMBER_KIND_COUNT:
        break;
    }
    return DIMENSION_NONE;
}

ExpectRow expect_row(NumberId id, NumberTurn turn)
{
    const Number *number = &NUMBERS[id];
    ExpectRow row = {.dimension = dimension_of(number->kind, turn),
                     .is_count = number_is_whole(number),
                     .needs_play = number_needs_play(number)};
    snprintf(row.name, sizeof row.name, "%s%s", NUMBER_OWNERS[number->owner].before, number->name);
    return row;
}

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
        "joints.NAME.NUMBER, bodies.NAME.NUMBER, run.NUMBER, error.NUMBER, energy.NUMBER, "
        "section.NUMBER, cost.NUMBER, outcome, each with a backend before it or none; "
        "settled.NUMBER, settled.bodies.NAME.NUMBER, settled.joints.NAME.NUMBER",
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

// The first owner whose paths begin with a word; NUMBER_OWNER_COUNT: none.
static NumberOwner owner_of(const char *word)
{
    NumberOwner owner = 0;
    while (owner < NUMBER_OWNER_COUNT && strcmp(NUMBER_OWNERS[owner].path, word) != 0) {
        owner++;
    }
    return owner;
}

// The words that a path can begin with.
static size_t first_words(bool has_backend, const char *choices[NUMBER_OWNER_COUNT + BACKEND_COUNT])
{
    size_t count = 0;
    for (NumberOwner owner = 0; owner < NUMBER_OWNER_COUNT; owner++) {
        const char *path = NUMBER_OWNERS[owner].path;
        if (owner_of(path) == owner && strchr(path, '.') == NULL) {
            choices[count++] = path;
        }
    }
    for (int i = 0; !has_backend && i < BACKEND_COUNT; i++) {
        choices[count++] = OPTIONS_BACKENDS[i];
    }
    return count;
}

// Whose numbers a path is of: the words of a NumberOwner.
static bool find_owner(Path *path, NumberOwner *owner, Err *err)
{
    if (path->first == path->count) {
        return refuse_path(path, err);
    }
    *owner = owner_of(path->segments[path->first]);
    if (*owner == NUMBER_OWNER_COUNT) {
        const char *choices[NUMBER_OWNER_COUNT + BACKEND_COUNT];
        const size_t count = first_words(path->first > 0, choices);
        return keys_refuse(path->source, segment_span(path, path->first), "part of a path",
                           path->segments[path->first], choices, count, err);
    }
    path->member = path->first + 1;
    if (*owner == NUMBER_OWNER_SETTLED && path->first > 0) {
        return refuse_path(path, err);
    }
    if (*owner == NUMBER_OWNER_SETTLED && path->count > 2) {
        char words[2 * LINKAGE_NAME_SIZE];
        snprintf(words, sizeof words, "%s.%s", path->segments[0], path->segments[1]);
        const NumberOwner of_members = owner_of(words);
        *owner = of_members < NUMBER_OWNER_COUNT ? of_members : *owner;
        path->member += of_members < NUMBER_OWNER_COUNT ? 1 : 0;
    }
    const bool has_member = NUMBER_OWNERS[*owner].members != NUMBER_OF_WHOLE;
    return path->count == path->member + (has_member ? 2 : 1) || refuse_path(path, err);
}

static bool find_member(const Path *path, const Entries *entries, NumberMembers members,
                        Expectation *expectation, Err *err)
{
    if (members == NUMBER_OF_WHOLE) {
        expectation->member = 0;
        return true;
    }
    const SchemaFamily family = members == NUMBER_OF_BODIES ? SCHEMA_BODY : SCHEMA_JOINT;
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

// The unit of a number is that of a torque where the limits of its joint turn it.
static NumberTurn turn_of(const Linkage *linkage, NumberOwner owner, int member)
{
    return owner == NUMBER_OWNER_BODY_SPIKE ? NUMBER_SPED
           : NUMBER_OWNERS[owner].members == NUMBER_OF_JOINTS &&
                   linkage_is_torsional(&linkage->joints[member])
               ? NUMBER_TURNED
               : NUMBER_PUSHED;
}

// Finds the number in the last segment among those of a path.
static bool find_number(const Path *path, const char *words, const Scenario *scenario,
                        Expectation *expectation, ExpectRow *found, Err *err)
{
    const size_t last = path->count - 1;
    const char *choices[CHOICE_MAX];
    ExpectRow rows[CHOICE_MAX];
    size_t count = 0;
    for (NumberId id = 0; id < NUMBER_COUNT; id++) {
        const NumberOwner owner = NUMBERS[id].owner;
        if ((NUMBERS[id].places & NUMBER_EXPECT) == 0 ||
            strcmp(NUMBER_OWNERS[owner].path, words) != 0) {
            continue;
        }
        ExpectRow *row = &rows[count];
        *row = expect_row(id, turn_of(&scenario->linkage, owner, expectation->member));
        const bool lacks_play =
            row->needs_play && !linkage_has_play(&scenario->linkage.joints[expectation->member]);
        const bool is_it = strcmp(row->name, path->segments[last]) == 0;
        if (is_it && lacks_play) {
            return source_error(
                path->source, segment_span(path, last),
                owner == NUMBER_OWNER_JOINT ? "force_max, force_spikes" : "a joint with play", err,
                "%s has no play, and so no %s", path->segments[last - 1], row->name);
        }
        if (is_it) {
            expectation->number = id;
            *found = *row;
            return true;
        }
        if (!lacks_play) {
            choices[count++] = row->name;
        }
    }
    return keys_refuse(path->source, segment_span(path, last), "number", path->segments[last],
                       choices, count, err);
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
    NumberOwner owner = NUMBER_OWNER_COUNT;
    ExpectRow row = {.is_count = false};
    if (!cut_path(&path, err)) {
        return false;
    }
    take_backend(&path, &read);
    if (!find_owner(&path, &owner, err) ||
        !find_member(&path, entries, NUMBER_OWNERS[owner].members, &read, err) ||
        !find_number(&path, NUMBER_OWNERS[owner].path, scenario, &read, &row, err)) {
        return false;
    }
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
