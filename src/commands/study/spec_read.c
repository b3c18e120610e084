// What does a study file ask for?
//
// text -> tree of nodes -> the case, with what is set -> what varies and is drawn, each key and
// value held against the case -> what only the whole can show: schemes, the number of runs.
#include "commands/study/spec_read.h"

#include "base/text.h"
#include "casefile/input.h"

#include <assert.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const uint64_t RUNS_MAX = 9007199254740992u; // 2^53: every number of a run is exact

// Whether a key stands where the study sets, varies or draws it already.
static bool check_new(const Reading *reading, const Node *value)
{
    const char *key = value->key->text;
    const Variable *variable = spec_variable(reading->spec, key);
    // there are draws only when all that varies has been read
    const char *where = variable != NULL                ? variable->is_drawn ? "draw" : "vary"
                        : spec_sets(reading->spec, key) ? "set"
                                                        : NULL;
    return where == NULL || source_error(&reading->source, keys_span(value), "one of the two",
                                         reading->err, "%s is already given under %s", key, where);
}

// The case with what is set, as soon as all of that is known.
static bool take_base(Reading *reading)
{
    Spec *spec = reading->spec;
    if (spec->base != NULL) {
        return true;
    }
    spec->base = calloc(1, sizeof *spec->base);
    assert(spec->base != NULL);
    return probe_scenario(reading->probe, spec->base, reading->err);
}

// Finds the key of a value in the case, and gives it the value in place of the one it has there.
static bool take_key(Reading *reading, const Node *value)
{
    return probe_key(reading->probe, &reading->source, value, &reading->key, reading->err) &&
           probe_set(reading->probe, &reading->source, value, reading->err);
}

// Whether the values of a key leave the motion that solvers are after as it is.
static bool leaves_truth(const char *key)
{
    return strcmp(key, SPEC_SCHEME_KEY) == 0 || strncmp(key, "ode.", strlen("ode.")) == 0 ||
           strcmp(key, "run.step") == 0 || strcmp(key, "run.tolerance") == 0;
}

bool spec_read_variable(Reading *reading, const Node *value)
{
    Spec *spec = reading->spec;
    const bool is_scheme = strcmp(value->key->text, SPEC_SCHEME_KEY) == 0;
    reading->key = (ProbeKey){0};
    if (!take_base(reading) || !check_new(reading, value) ||
        (!is_scheme && !take_key(reading, value))) {
        return false;
    }
    if (spec->variable_count == SPEC_VARIABLE_MAX) {
        return source_error(&reading->source, keys_span(value), "at most 48 keys", reading->err,
                            "one key too many varies");
    }
    const ProbeKey *key = &reading->key;
    Variable *variable = &spec->variables[spec->variable_count++];
    reading->variable = variable;
    text_copy(variable->key, sizeof variable->key, value->key->text);
    variable->is_word = is_scheme || key->kind == PROBE_WORD || key->kind == PROBE_OTHER;
    variable->is_whole = key->kind == PROBE_WHOLE;
    variable->changes_truth = !leaves_truth(variable->key);
    if (!variable->is_word) {
        text_copy(variable->column_unit, sizeof variable->column_unit, schema_unit(key->row));
    }
    return true;
}

static bool set_key(Reading *reading, const Node *value)
{
    Spec *spec = reading->spec;
    if (strcmp(value->key->text, SPEC_SCHEME_KEY) == 0) {
        return source_error(&reading->source, keys_span(value), "scheme: NAME under vary",
                            reading->err, "scheme is not a key of the case");
    }
    if (spec->set_count == SPEC_SETTING_MAX) {
        return source_error(&reading->source, keys_span(value), "at most 64 keys", reading->err,
                            "one key too many is set");
    }
    if (!take_key(reading, value)) {
        return false;
    }
    Text text;
    text_init(&text);
    text_append(&text, "%s=", reading->key.path);
    spec_read_write(value, &text);
    spec->set[spec->set_count++] = text.data;
    return true;
}

bool spec_read_set(Reading *reading, const Node *set)
{
    return spec_read_each(reading, set, set_key);
}

bool spec_read_each(Reading *reading, const Node *map,
                    bool (*read)(Reading *reading, const Node *value))
{
    bool is_read = keys_check_map(&reading->source, map, reading->err);
    for (const Node *value = map->first; is_read && value != NULL; value = value->next) {
        is_read =
            keys_check_single(&reading->source, map, value, reading->err) && read(reading, value);
    }
    return is_read;
}

// Finds and reads the case, whose path is relative to the study file's folder.
bool spec_read_case(Reading *reading, const Node *node)
{
    static const char ALLOWED[] = "the path of a case file, relative to the study file";
    Spec *spec = reading->spec;
    if (!spec_read_single(reading, node, "case", ALLOWED)) {
        return false;
    }
    const char *slash = strrchr(spec->path, '/');
    const bool is_whole = node->text[0] == '/' || slash == NULL;
    Text path;
    text_init(&path);
    text_append(&path, "%.*s%s", is_whole ? 0 : (int)(slash - spec->path + 1), spec->path,
                node->text);
    spec->case_path = path.data;
    Err own = {0};
    if (!input_read("case", spec->case_path, &spec->case_text, &spec->case_size, &own)) {
        return spec_read_refuse(reading, node, ALLOWED, "%.*s", (int)strcspn(own.text, "\n"),
                                own.text);
    }
    reading->probe = probe_open(spec->case_path, spec->case_text, spec->case_size, reading->err);
    return reading->probe != NULL;
}

// From slow to fast: see spec.h.
static int rank_of(const Variable *variable)
{
    const bool is_grid = !variable->is_drawn;
    return is_grid && variable->changes_truth ? 0 : is_grid ? 2 : 1;
}

// In each part of the order the keys stay as the file has them.
static void order_variables(Spec *spec)
{
    for (size_t i = 1; i < spec->variable_count; i++) {
        const Variable moved = spec->variables[i];
        size_t k = i;
        for (; k > 0 && rank_of(&spec->variables[k - 1]) > rank_of(&moved); k--) {
            spec->variables[k] = spec->variables[k - 1];
        }
        spec->variables[k] = moved;
    }
}

static bool check_count(const Reading *reading)
{
    const Spec *spec = reading->spec;
    uint64_t runs = spec->draws;
    for (size_t i = 0; i < spec->variable_count; i++) {
        const uint64_t count = spec->variables[i].is_drawn ? 1 : spec->variables[i].count;
        if (count > RUNS_MAX / runs) {
            return source_error(&reading->source, keys_span(reading->vary),
                                "at most 2^53, 9007199254740992, runs", reading->err,
                                "the study has too many runs: %.3g and more",
                                (double)runs * (double)count);
        }
        runs *= count;
    }
    return true;
}

// The kinds of the joints in the runs follow from the keys that are there, whatever their values.
static void set_joint_kinds(const Reading *reading)
{
    Linkage *linkage = &reading->spec->base->linkage;
    for (size_t i = 0; i < linkage->joint_count; i++) {
        linkage->joints[i].kind = probe_joint_kind(reading->probe, i);
    }
}

static bool read_parts(Reading *reading, const Node *root)
{
    if (!spec_keys_read(reading, SPEC_TOP, root)) {
        return false;
    }
    if (reading->spec->variable_count == 0) {
        return spec_read_refuse(reading, reading->vary != NULL ? reading->vary : root,
                                "vary: or draw: with the keys that differ from run to run",
                                "nothing varies");
    }
    set_joint_kinds(reading);
    order_variables(reading->spec);
    return probe_is_whole(reading->probe, reading->err) && spec_read_check_schemes(reading) &&
           check_count(reading);
}

bool spec_read(const char *path, Spec *spec, Err *err)
{
    char *text = NULL;
    size_t size = 0;
    Node *root = NULL;
    Reading reading = {.spec = spec, .err = err};
    *spec = spec_default();
    spec->path = strdup(path);
    assert(spec->path != NULL);
    bool is_good = input_read("study", path, &text, &size, err) &&
                   input_parse("study", path, text, size, &reading.source, &root, err);
    if (is_good) {
        reading.source.is_override = true;
        is_good = read_parts(&reading, root);
    }
    if (is_good) {
        spec->print = spec_print(spec);
    } else {
        spec_finish(spec);
    }
    probe_close(reading.probe);
    document_destroy(root);
    free(text);
    return is_good;
}
