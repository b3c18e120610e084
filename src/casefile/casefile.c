// How does a case file become a scenario?
//
// text -> tree of nodes -> known keys (overrides in their places) -> values in SI -> checks that
// need several values -> linkage at its start.
#include "casefile/casefile.h"

#include "casefile/build.h"
#include "casefile/check.h"
#include "casefile/closure.h"
#include "casefile/input.h"
#include "casefile/place.h"
#include "casefile/store.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

// One --set KEY=VALUE: its text as messages show it, and what it says.
typedef struct Override {
    Text shown;
    char key[SCHEMA_PATH_SIZE];
    Source source;
    Node *value;
} Override;

static const char OPTION[] = "--set ";

static bool override_read(Override *override, const char *argument, Err *err)
{
    text_init(&override->shown);
    if (!source_is_one_line(argument, strlen(argument))) {
        return err_set(err, ERR_USAGE,
                       "--set: the argument is not text on one line\nallowed: --set KEY=VALUE");
    }
    const char *equals = strchr(argument, '=');
    const size_t key_size = equals != NULL ? (size_t)(equals - argument) : 0;
    if (key_size == 0 || key_size >= sizeof override->key) {
        return err_set(err, ERR_USAGE,
                       "--set %.200s: a key and a value are needed\nallowed: --set KEY=VALUE, such "
                       "as --set run.step=2us",
                       argument);
    }
    memcpy(override->key, argument, key_size);
    override->key[key_size] = '\0';
    text_append(&override->shown, "%s%s", OPTION, argument);
    override->source = (Source){
        .name = override->shown.data,
        .text = override->shown.data,
        .size = override->shown.length,
        .shift = strlen(OPTION) + source_count(argument, key_size) + 1,
        .key_start = strlen(OPTION),
        .is_option = true,
    };
    if (!document_parse(&override->source, equals + 1, strlen(equals + 1), &override->value, err)) {
        return false;
    }
    if (override->value == NULL) {
        return err_set(err, ERR_USAGE, "%s: no value\nallowed: --set KEY=VALUE",
                       override->shown.data);
    }
    return true;
}

static void override_finish(Override *override)
{
    document_destroy(override->value);
    text_finish(&override->shown);
}

// What follows from the keys that are given and not from their values.
static void store_presence(const Entries *entries, Scenario *scenario)
{
    Linkage *linkage = &scenario->linkage;
    const EntryNames *names = entries->names;
    linkage->body_count = names[SCHEMA_BODY].count;
    linkage->joint_count = names[SCHEMA_JOINT].count;
    scenario->point_count = names[SCHEMA_POINT].count;
    for (size_t i = 0; i < LINKAGE_JOINT_MAX; i++) {
        Joint *joint = &linkage->joints[i];
        text_copy(joint->name, LINKAGE_NAME_SIZE, names[SCHEMA_JOINT].names[i]);
        joint->kind = entries_has_play(entries, i) ? JOINT_CLEARANCE : JOINT_REVOLUTE;
    }
    for (size_t i = 0; i < LINKAGE_BODY_MAX; i++) {
        text_copy(linkage->bodies[i].name, LINKAGE_NAME_SIZE, names[SCHEMA_BODY].names[i]);
    }
    for (size_t i = 0; i < SCENARIO_POINT_MAX; i++) {
        text_copy(scenario->points[i].name, LINKAGE_NAME_SIZE, names[SCHEMA_POINT].names[i]);
    }
    linkage->driver.is_present =
        entries->form == SCHEMA_SHORT || entries_group(entries, "drive", 0) != NULL;
    if (entries->form == SCHEMA_LONG) {
        // the closed form knows four-bars only
        scenario->run.backend_count = 2;
        scenario->run.backends[0] = BACKEND_REFERENCE;
        scenario->run.backends[1] = BACKEND_ODE;
    }
}

// Stores every value in the order of the schema, so that the same mistake is told first wherever
// the keys stand.
static bool store_entries(const Entries *entries, Scenario *scenario, Err *err)
{
    store_presence(entries, scenario);
    for (size_t i = 0; i < SCHEMA_ROW_COUNT; i++) {
        const SchemaRow *row = &SCHEMA_ROWS[i];
        const size_t members = entries_family_size(entries, row);
        for (size_t index = 0; index < members; index++) {
            const Entry *entry = entries_find(entries, row->path, index);
            if (entry != NULL && !store_value(entries, entry, scenario, err)) {
                return false;
            }
        }
    }
    return true;
}

// What remains is wrong as a whole; it is shown at the drive, or at the top where there is none.
static bool build(const Entries *entries, Scenario *scenario, Err *err)
{
    Err own = {0};
    const bool is_built = entries->form == SCHEMA_SHORT ? closure_check(entries, scenario, &own) &&
                                                              build_fourbar(scenario, &own)
                                                        : place_linkage(entries, scenario, &own);
    if (is_built && scenario_check(scenario, &own)) {
        return true;
    }
    if (!is_built && own.kind != ERR_SOLVER) {
        *err = own; // it has its place already
        return false;
    }
    const Entry *speed = entries_find(entries, "drive.speed", 0);
    const EntryGroup *top = entries_group(entries, "", 0);
    return source_error(speed != NULL ? speed->source : top->source,
                        speed != NULL ? speed->node->span : top->node->span, NULL, err,
                        "the mechanism cannot be solved at its start: %s", own.text);
}

static bool read_entries(Entries *entries, const Node *root, const Source *source,
                         const Override *overrides, size_t override_count, Err *err)
{
    if (!entries_read(entries, root, source, err)) {
        return false;
    }
    for (size_t i = 0; i < override_count; i++) {
        if (!entries_override(entries, overrides[i].key, overrides[i].value, &overrides[i].source,
                              err)) {
            return false;
        }
    }
    return check_required(entries, err);
}

// Reads the text and the overrides into trees, which live until the scenario is built.
bool casefile_load_text(const char *name, const char *text, size_t size,
                        const char *const *overrides, size_t override_count, Scenario *scenario,
                        Err *err)
{
    if (!input_check(name, text, size, err)) {
        return false;
    }
    // a byte order mark is no part of the text
    const size_t mark = size >= 3 && memcmp(text, "\xef\xbb\xbf", 3) == 0 ? 3 : 0;
    const Source source = {.name = name, .text = text + mark, .size = size - mark};
    Override *read = calloc(override_count + 1, sizeof *read);
    Entries *entries = calloc(1, sizeof *entries);
    assert(read != NULL && entries != NULL);
    Node *root = NULL;
    bool is_good = false;
    Scenario built = scenario_default();

    for (size_t i = 0; i < override_count; i++) {
        if (!override_read(&read[i], overrides[i], err)) {
            goto done;
        }
    }
    if (!document_parse(&source, source.text, source.size, &root, err)) {
        goto done;
    }
    if (root == NULL) {
        err_set(err, ERR_CASE, "%s: the file holds no case\nallowed: a case in YAML", name);
        goto done;
    }
    is_good = read_entries(entries, root, &source, read, override_count, err) &&
              store_entries(entries, &built, err) && check_values(entries, &built, err) &&
              build(entries, &built, err);
    if (is_good) {
        text_copy(built.path, sizeof built.path, name);
        *scenario = built;
    }

done:
    document_destroy(root);
    free(entries);
    for (size_t i = 0; i < override_count; i++) {
        override_finish(&read[i]);
    }
    free(read);
    return is_good;
}

bool casefile_load(const char *path, const char *const *overrides, size_t override_count,
                   Scenario *scenario, Err *err)
{
    char *text;
    size_t size;
    if (!input_read(path, &text, &size, err)) {
        return false;
    }
    const bool is_good =
        casefile_load_text(path, text, size, overrides, override_count, scenario, err);
    free(text);
    return is_good;
}
