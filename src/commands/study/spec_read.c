// What does a study file ask for?
//
// text -> tree of nodes -> the case, with what is set -> what varies and is drawn, each key and
// value held against the case -> what only the whole can show: schemes, the number of runs.
#include "commands/study/spec_read.h"

#include "base/text.h"
#include "casefile/input.h"
#include "casefile/quantity.h"

#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// Of a run with nothing said: minutes of a chaotic case end in a row that says so, and the two
// cores of a small machine with 4 GB go on.
static const double TIME_DEFAULT = 60.0;         // s
static const size_t MEMORY_DEFAULT = 2000000000; // B
static const uint64_t SEED_DEFAULT = 1;

static const double TIME_MAX = 1e7;                 // s: a run of four months is a slip of the pen
static const double MEMORY_MIN = 1e7;               // B: with less not even the program starts
static const double MEMORY_MAX = 1e15;              // B: a million times what machines have
static const uint64_t RUNS_MAX = 9007199254740992u; // 2^53: every number of a run is exact

enum { TITLE, CASE, SET, VARY, DRAW, LIMITS, TRUTH, PART_COUNT };
static const char *const PARTS[PART_COUNT] = {"title", "case",   "set",  "vary",
                                              "draw",  "limits", "truth"};

// Whether a key stands where the study sets, varies or draws it already.
static bool check_new(const Reading *reading, const Node *value)
{
    const char *key = value->key->text;
    const size_t length = strlen(key);
    const char *where = NULL;
    for (size_t i = 0; i < reading->spec->set_count; i++) {
        const char *set = reading->spec->set[i];
        where = strncmp(set, key, length) == 0 && set[length] == '=' ? "set" : where;
    }
    for (size_t i = 0; i < reading->spec->variable_count; i++) {
        const Variable *variable = &reading->spec->variables[i];
        // there are draws only when all that varies has been read
        where = strcmp(variable->key, key) == 0 ? variable->is_drawn ? "draw" : "vary" : where;
    }
    return where == NULL || source_error(&reading->source, keys_span(value), "one of the two",
                                         reading->err, "%s stands under %s already", key, where);
}

// Whether the values of a key leave the motion that solvers are after as it is.
static bool leaves_truth(const char *key)
{
    return strcmp(key, SPEC_SCHEME_KEY) == 0 || strncmp(key, "ode.", strlen("ode.")) == 0 ||
           strcmp(key, "run.step") == 0 || strcmp(key, "run.tolerance") == 0;
}

Variable *spec_read_variable(Reading *reading, const Node *value, ProbeKey *key)
{
    Spec *spec = reading->spec;
    const bool is_scheme = strcmp(value->key->text, SPEC_SCHEME_KEY) == 0;
    if (!check_new(reading, value) ||
        (!is_scheme && (!probe_key(reading->probe, &reading->source, value, key, reading->err) ||
                        !probe_set(reading->probe, &reading->source, value, reading->err)))) {
        return NULL;
    }
    if (spec->variable_count == SPEC_VARIABLE_MAX) {
        source_error(&reading->source, keys_span(value), "at most 48 keys", reading->err,
                     "one key too many varies");
        return NULL;
    }
    Variable *variable = &spec->variables[spec->variable_count++];
    text_copy(variable->key, sizeof variable->key, value->key->text);
    variable->is_word = is_scheme || key->kind == PROBE_WORD || key->kind == PROBE_OTHER;
    variable->is_whole = key->kind == PROBE_WHOLE;
    variable->changes_truth = !leaves_truth(variable->key);
    if (!variable->is_word) {
        text_copy(variable->column_unit, sizeof variable->column_unit, schema_unit(key->row));
    }
    return variable;
}

static bool read_set(Reading *reading, const Node *set)
{
    Spec *spec = reading->spec;
    if (!keys_check_map(&reading->source, set, reading->err)) {
        return false;
    }
    for (const Node *value = set->first; value != NULL; value = value->next) {
        ProbeKey key;
        if (strcmp(value->key->text, SPEC_SCHEME_KEY) == 0) {
            return source_error(&reading->source, keys_span(value), "scheme: NAME under vary",
                                reading->err, "the scheme is no key of the case");
        }
        if (spec->set_count == SPEC_SETTING_MAX) {
            return source_error(&reading->source, keys_span(value), "at most 64 keys", reading->err,
                                "one key too many is set");
        }
        if (!keys_check_single(&reading->source, set, value, reading->err) ||
            !probe_key(reading->probe, &reading->source, value, &key, reading->err) ||
            !probe_set(reading->probe, &reading->source, value, reading->err)) {
            return false;
        }
        Text text;
        text_init(&text);
        text_append(&text, "%s=", key.path);
        spec_read_write(value, &text);
        spec->set[spec->set_count++] = text.data;
    }
    return true;
}

// A limit, or none for 0.
static bool read_limit(const Reading *reading, const Node *node, const char *what,
                       Dimension dimension, double low, double high, double *limit)
{
    char allowed[QUANTITY_TEXT_SIZE];
    snprintf(allowed, sizeof allowed, "none, or %g to %g %s", low, high, units_si(dimension));
    Complaint complaint;
    double read = 0.0;
    if (!spec_read_single(reading, node, what, allowed)) {
        return false;
    }
    if (strcmp(node->text, "none") == 0) {
        *limit = 0.0;
        return true;
    }
    if (!quantity_parse(node->text, dimension, &read, &complaint)) {
        return spec_read_refuse(reading, node, complaint.allowed, "%s", complaint.text);
    }
    if (!(read >= low && read <= high)) {
        return spec_read_refuse(reading, node, allowed, "%s is out of range: %.60s", what,
                                node->text);
    }
    *limit = read;
    return true;
}

static bool read_limits(const Reading *reading, const Node *limits)
{
    enum { TIME, MEMORY, LIMIT_COUNT };
    static const char *const NAMES[LIMIT_COUNT] = {"time", "memory"};
    static const double TIME_MIN = 1e-3; // s: what a process takes to start
    ChildLimits *own = &reading->spec->limits;
    const Node *parts[LIMIT_COUNT];
    double memory = (double)own->memory_bytes;
    if (!keys_sort(&reading->source, limits, NAMES, LIMIT_COUNT, parts, reading->err) ||
        (parts[TIME] != NULL && !read_limit(reading, parts[TIME], "the time", DIMENSION_TIME,
                                            TIME_MIN, TIME_MAX, &own->time_s)) ||
        (parts[MEMORY] != NULL && !read_limit(reading, parts[MEMORY], "the memory",
                                              DIMENSION_MEMORY, MEMORY_MIN, MEMORY_MAX, &memory))) {
        return false;
    }
    own->memory_bytes = (size_t)memory;
    return true;
}

static bool read_head(const Reading *reading, const Node *const *parts)
{
    static const char *const WORDS[] = {"false", "true", NULL};
    Spec *spec = reading->spec;
    size_t truth = 1;
    if (parts[TITLE] != NULL) {
        if (parts[TITLE]->kind != NODE_SCALAR || strlen(parts[TITLE]->text) >= SPEC_TEXT_SIZE) {
            return spec_read_refuse(reading, parts[TITLE], "text on one line, at most 255 bytes",
                                    "this is no title");
        }
        text_copy(spec->title, sizeof spec->title, parts[TITLE]->text);
    }
    if ((parts[TRUTH] != NULL && !spec_read_word(reading, parts[TRUTH], "truth", WORDS, &truth)) ||
        (parts[LIMITS] != NULL && !read_limits(reading, parts[LIMITS]))) {
        return false;
    }
    spec->has_truth = truth == 1;
    return true;
}

// Finds and reads the case, whose path is relative to the study file's folder.
static bool read_case(Reading *reading, const Node *node)
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

static bool check_count(const Reading *reading, const Node *vary, const Node *draw)
{
    const Spec *spec = reading->spec;
    uint64_t runs = spec->draws;
    for (size_t i = 0; i < spec->variable_count; i++) {
        const uint64_t count = spec->variables[i].is_drawn ? 1 : spec->variables[i].count;
        if (count > RUNS_MAX / runs) {
            return source_error(&reading->source, keys_span(vary != NULL ? vary : draw),
                                "at most 2^53, 9007199254740992, runs", reading->err,
                                "the study has too many runs: %.3g and more",
                                (double)runs * (double)count);
        }
        runs *= count;
    }
    return true;
}

// The joints that have play in the runs have it by the keys that are there, whatever their values.
static void loosen_joints(const Reading *reading)
{
    Linkage *linkage = &reading->spec->base->linkage;
    for (size_t i = 0; i < linkage->joint_count; i++) {
        if (probe_has_play(reading->probe, i)) {
            linkage->joints[i].kind = JOINT_CLEARANCE;
        }
    }
}

static bool read_parts(Reading *reading, const Node *root)
{
    Spec *spec = reading->spec;
    const Node *parts[PART_COUNT];
    if (!keys_sort(&reading->source, root, PARTS, PART_COUNT, parts, reading->err) ||
        !read_head(reading, parts)) {
        return false;
    }
    if (parts[CASE] == NULL) {
        return source_error(&reading->source, keys_span(root),
                            "case: with the path of a case file, relative to the study file",
                            reading->err, "the study names no case");
    }
    if (parts[VARY] == NULL && parts[DRAW] == NULL) {
        return source_error(&reading->source, keys_span(root),
                            "vary: or draw: with the keys that differ from run to run",
                            reading->err, "nothing varies");
    }
    spec->base = malloc(sizeof *spec->base);
    assert(spec->base != NULL);
    if (!read_case(reading, parts[CASE]) ||
        (parts[SET] != NULL && !read_set(reading, parts[SET])) ||
        !probe_scenario(reading->probe, spec->base, reading->err) ||
        (parts[VARY] != NULL && !spec_read_vary(reading, parts[VARY])) ||
        (parts[DRAW] != NULL && !spec_read_draw(reading, parts[DRAW]))) {
        return false;
    }
    if (spec->variable_count == 0) {
        return spec_read_refuse(reading, parts[VARY], "a key with its values", "nothing varies");
    }
    loosen_joints(reading);
    order_variables(spec);
    return probe_is_whole(reading->probe, reading->err) &&
           spec_read_check_schemes(reading, parts[VARY]) &&
           check_count(reading, parts[VARY], parts[DRAW]);
}

bool spec_read(const char *path, Spec *spec, Err *err)
{
    char *text = NULL;
    size_t size = 0;
    Node *root = NULL;
    Reading reading = {.spec = spec, .err = err};
    *spec = (Spec){
        .path = strdup(path),
        .draws = 1,
        .method = DRAW_LATIN_HYPERCUBE,
        .seed = SEED_DEFAULT,
        .has_truth = true,
        .limits = {.time_s = TIME_DEFAULT, .memory_bytes = MEMORY_DEFAULT},
    };
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
