// Reads a study file: the case, which of its keys vary and how, within which limits.
//
// The case as it resolves with what is set, key by key, and what varies: so neither comments and
// layout of the two files nor where they lie matter, nor the limits and titles.
#include "commands/study/spec.h"
#include "base/hash.h"
#include "base/printable.h"
#include "base/text.h"
#include "casefile/input.h"
#include "commands/study/normal.h"

#include <assert.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static bool spec_read_each(Reading *reading, const Node *map,
                           bool (*read)(Reading *reading, const Node *value));
static uint64_t spec_print(const Spec *spec);
const Variable *spec_variable(const Spec *spec, const char *key);
static bool spec_sets(const Spec *spec, const char *key);

// Single values of a study file.

enum { MESSAGE_SIZE = 256 };

bool spec_read_refuse(const Reading *reading, const Node *node, const char *allowed,
                      const char *format, ...)
{
    char message[MESSAGE_SIZE];
    va_list arguments;
    va_start(arguments, format);
    shorten_list(message, sizeof message, format, arguments);
    va_end(arguments);
    const bool is_missing = node->kind == NODE_SCALAR && node->text[0] == '\0';
    return source_error(&reading->source, is_missing ? keys_span(node) : node->span, allowed,
                        reading->err, "%s", message);
}

bool spec_read_single(const Reading *reading, const Node *node, const char *what,
                      const char *allowed)
{
    return (node->kind == NODE_SCALAR && node->text[0] != '\0') ||
           spec_read_refuse(reading, node, allowed, "%s takes a single value", what);
}

// The value of a key in a mapping; NULL where it is not there.
static const Node *spec_read_child(const Node *map, const char *name)
{
    const Node *child = map->first;
    while (child != NULL && strcmp(child->key->text, name) != 0) {
        child = child->next;
    }
    return child;
}

static const Node *spec_read_first(const Node *list)
{
    return list->kind == NODE_SCALAR ? list : list->first;
}

// The values of a list, or a single value, which is a list of one: the first, and the one behind an
// item; NULL behind the last.
static const Node *spec_read_next(const Node *list, const Node *item)
{
    return item == list ? NULL : item->next;
}

// Appends a node as YAML on one line.
static void spec_read_write(const Node *node, Text *text)
{
    static const char PLAIN[] =
        "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789 ._/+^-";
    const char *separator = "";
    if (node->kind == NODE_SCALAR && node->text[0] != '\0' &&
        strspn(node->text, PLAIN) == strlen(node->text)) {
        text_append(text, "%s", node->text);
    } else if (node->kind == NODE_SCALAR) {
        text_append(text, "\"");
        for (const char *c = node->text; *c != '\0'; c++) {
            text_append(text, *c == '"' || *c == '\\' ? "\\%c" : "%c", *c);
        }
        text_append(text, "\"");
    } else {
        text_append(text, node->kind == NODE_LIST ? "[" : "{");
        for (const Node *item = node->first; item != NULL; item = item->next) {
            text_append(text, "%s", separator);
            if (node->kind == NODE_MAP) {
                spec_read_write(item->key, text);
                text_append(text, ": ");
            }
            spec_read_write(item, text);
            separator = ", ";
        }
        text_append(text, node->kind == NODE_LIST ? "]" : "}");
    }
}

bool spec_read_number(Reading *reading, const Node *node, bool is_checked, double *number)
{
    const ProbeKey *key = &reading->key;
    Variable *variable = reading->variable;
    ProbeNumber read;
    if (is_checked && !probe_check(reading->probe, &reading->source, key, node, reading->err)) {
        return false;
    }
    const bool is_word = key->row->zero_word != NULL && node->kind == NODE_SCALAR &&
                         strcmp(node->text, key->row->zero_word) == 0;
    if (is_word) {
        return spec_read_refuse(reading, node, "numbers; the word stands under set",
                                "%s for %s is not a number", node->text, variable->key);
    }
    if (!probe_number(&reading->source, key, node, &read, reading->err)) {
        return false;
    }
    // the unit of a stiffness gives the exponent of its law, that of a span what it counts, that of
    // a backlash whether it is an angle
    const SchemaType type = key->row->type;
    const bool is_stiffness = type == SCHEMA_STIFFNESS;
    const bool has_own_unit =
        is_stiffness || type == SCHEMA_SPAN || type == SCHEMA_COORDINATE || type == SCHEMA_DAMPER;
    if (has_own_unit && variable->unit[0] != '\0' && strcmp(variable->unit, read.unit) != 0) {
        return spec_read_refuse(
            reading, node, is_stiffness ? "values with one exponent" : "values in one unit",
            "this value is in %s, those before it in %s", read.unit, variable->unit);
    }
    text_copy(variable->unit, sizeof variable->unit, read.unit);
    if (has_own_unit) {
        text_copy(variable->column_unit, sizeof variable->column_unit, read.unit);
    }
    variable->given = variable->given != NULL ? variable->given : read.given;
    *number = read.value;
    return true;
}

// The schemes of a study, checked against its other keys.

// The names of all schemes that the runs may have: they depend on which joints have play, and on
// the model of contact, which may itself vary.
static size_t list_schemes(const Spec *spec, Scheme schemes[2 * SCHEME_MAX])
{
    Scenario *other = malloc(sizeof *other);
    assert(other != NULL);
    size_t count = scheme_list(spec->base, schemes);
    for (size_t i = 0; i < spec->variable_count; i++) {
        if (strcmp(spec->variables[i].key, "contact.model") == 0) {
            *other = *spec->base;
            const bool is_impact = other->contact.model == CONTACT_IMPACT;
            other->contact.model = is_impact ? CONTACT_POISSON : CONTACT_IMPACT;
            count += scheme_list(other, schemes + count);
        }
    }
    free(other);
    return count;
}

// Lists those with the exact collider or the case's, and how the others are called.
static bool refuse_unknown(const Reading *reading, const Node *node, const Scheme *schemes,
                           size_t count)
{
    const char *names[2 * SCHEME_MAX];
    const Scheme *other = NULL;
    Text allowed;
    text_init(&allowed);
    for (size_t i = 0; i < count; i++) {
        names[i] = schemes[i].name;
        if (schemes[i].is_asked || !scheme_has_step(&schemes[i])) {
            text_append(&allowed, "%s%s", i > 0 ? ", " : "", schemes[i].name);
        } else if (other == NULL) {
            other = &schemes[i];
        }
    }
    if (other != NULL) {
        text_append(&allowed, "; those with rows also with a collider, such as %s", other->name);
    }
    const char *nearest = text_nearest(node->text, names, count);
    spec_read_refuse(reading, node, allowed.data, "unknown scheme of this case '%.40s'%s%s%s",
                     node->text, nearest != NULL ? "; did you mean '" : "",
                     nearest != NULL ? nearest : "", nearest != NULL ? "'?" : "");
    text_finish(&allowed);
    return false;
}

static bool check_scheme(const Reading *reading, const Node *node, const Scheme *schemes,
                         size_t count)
{
    if (!spec_read_single(reading, node, "a scheme", "its name, such as direct/plain/corrected")) {
        return false;
    }
    BackendKind backend;
    EngineWay way;
    if (scheme_is_engine(node->text, &backend, &way)) {
        return true;
    }
    const Scheme *found = NULL;
    for (size_t i = 0; i < count; i++) {
        found = strcmp(schemes[i].name, node->text) == 0 ? &schemes[i] : found;
    }
    if (found == NULL) {
        return refuse_unknown(reading, node, schemes, count);
    }
    const Spec *spec = reading->spec;
    if (scheme_has_step(found) && spec->base->run.step == 0.0 &&
        spec_variable(spec, "run.step") == NULL) {
        return spec_read_refuse(reading, node, "run.step under set or vary, such as 1 us",
                                "%s needs a step, which is auto in the case", node->text);
    }
    return true;
}

// Schemes say by themselves what these keys would.
static bool check_scheme_alone(const Reading *reading, const Node *value)
{
    static const char *const KEYS[] = {"ode.solver", "ode.stepping", "ode.map", "ode.collider",
                                       "run.tolerance"};
    for (size_t i = 0; i < sizeof KEYS / sizeof KEYS[0]; i++) {
        if (spec_variable(reading->spec, KEYS[i]) != NULL || spec_sets(reading->spec, KEYS[i])) {
            return source_error(&reading->source, keys_span(value), "one of the two", reading->err,
                                "scheme and %s exclude each other", KEYS[i]);
        }
    }
    return true;
}

// Whether the schemes under `vary` are there and have what they need.
static bool spec_read_check_schemes(const Reading *reading)
{
    const Node *value =
        reading->vary != NULL ? spec_read_child(reading->vary, SPEC_SCHEME_KEY) : NULL;
    if (value == NULL) {
        return true;
    }
    Scheme *schemes = calloc(2 * SCHEME_MAX, sizeof *schemes);
    assert(schemes != NULL);
    const size_t count = list_schemes(reading->spec, schemes);
    bool is_good = check_scheme_alone(reading, value);
    for (const Node *item = spec_read_first(value); is_good && item != NULL;
         item = spec_read_next(value, item)) {
        is_good = check_scheme(reading, item, schemes, count);
    }
    free(schemes);
    return is_good;
}

// From the text to the spec.
//
// text -> tree of nodes -> the case, with what is set -> what varies and is drawn, each key and
// value held against the case -> what only the whole can show: schemes, the number of runs.

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

// Begins a new variable of the spec, for the key of a value. False where the key is none of the
// case, the spec has no room, or the study names the key a second time.
static bool spec_read_variable(Reading *reading, const Node *value)
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

// Reads the values of a mapping one after another; each key must stand there once.
static bool spec_read_each(Reading *reading, const Node *map,
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
    // the name of the case without its folder: rows are the same wherever a study is run from
    const char *folder_end = strrchr(spec->case_path, '/');
    spec->repeat = casefile_repeat_open(folder_end != NULL ? folder_end + 1 : spec->case_path,
                                        spec->case_text, spec->case_size, false);
    reading->probe = probe_open(spec->case_path, spec->case_text, spec->case_size, reading->err);
    return reading->probe != NULL;
}

// From slow to fast: see spec.h.
static int spec_rank_of(const Variable *variable)
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
        for (; k > 0 && spec_rank_of(&spec->variables[k - 1]) > spec_rank_of(&moved); k--) {
            spec->variables[k] = spec->variables[k - 1];
        }
        spec->variables[k] = moved;
    }
}

// Sobol's indices take two samples of all keys, and for each key one that has it of the second and
// the others of the first.
static bool expand_draws(const Reading *reading)
{
    Spec *spec = reading->spec;
    uint64_t drawn = 0;
    for (size_t i = 0; i < spec->variable_count; i++) {
        const Variable *variable = &spec->variables[i];
        drawn += variable->is_drawn ? 1 : 0;
        if (spec->method == DRAW_SOBOL && !variable->is_drawn) {
            return source_error(
                &reading->source, keys_span(reading->vary), "draw alone, or another method",
                reading->err, "method sobol is for keys that are drawn; %s varies", variable->key);
        }
    }
    if (spec->method == DRAW_SOBOL) {
        spec->draw_base = spec->draws;
        spec->draws = spec->draws > RUNS_MAX / (drawn + 2) ? RUNS_MAX : spec->draws * (drawn + 2);
    }
    return true;
}

static bool check_count(const Reading *reading)
{
    if (!expand_draws(reading)) {
        return false;
    }
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
    spec_decide_backend(spec_read_child(root, "truth") != NULL, reading->spec);
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

static uint64_t add_text(uint64_t print, const char *text)
{
    // the end as well, so that "ab", "c" is not "a", "bc"
    return hash_bytes(print, text, strlen(text) + 1);
}

static uint64_t add_case(uint64_t print, const Scenario *base)
{
    CasefileSetting setting;
    CasefileWalk walk = casefile_walk(base);
    while (casefile_next(&walk, &setting)) {
        if (strcmp(setting.key, "title") == 0) {
            continue;
        }
        print = add_text(print, setting.key);
        print = add_text(print, setting.unit);
        print = add_text(print, setting.text);
        print = hash_number(print, setting.applies ? 1.0 : 0.0);
        for (size_t k = 0; k < setting.number_count; k++) {
            print = hash_number(print, setting.numbers[k]);
        }
    }
    return print;
}

static uint64_t add_variable(uint64_t print, const Variable *variable)
{
    print = add_text(print, variable->key);
    print = add_text(print, variable->unit);
    print = hash_number(print, variable->kind);
    print = hash_number(print, variable->is_drawn ? 1.0 : 0.0);
    print = hash_number(print, (double)variable->count);
    const double numbers[] = {variable->low, variable->high, variable->centre, variable->deviation};
    for (size_t i = 0; i < sizeof numbers / sizeof numbers[0]; i++) {
        print = hash_number(print, numbers[i]);
    }
    for (size_t i = 0; variable->kind == VARIABLE_LIST && i < variable->count; i++) {
        print = variable->is_word ? add_text(print, variable->words[i])
                                  : hash_number(print, variable->numbers[i]);
    }
    return print;
}

// The fingerprint of all that decides what the runs are, which stands in the spec as well.
static uint64_t spec_print(const Spec *spec)
{
    uint64_t print = add_case(HASH_START, spec->base);
    for (size_t i = 0; i < spec->variable_count; i++) {
        print = add_variable(print, &spec->variables[i]);
    }
    print = hash_number(print, (double)spec->draws);
    print = hash_number(print, spec->method);
    print = hash_number(print, (double)spec->seed);
    if (spec->follow[0] != '\0') {
        print = hash_number(add_text(print, spec->follow), spec->direction);
    }
    if (spec->has_growth) {
        print = add_text(print, "growth");
    }
    if (spec->has_neighbours) {
        print = add_text(print, "neighbours");
    }
    print = hash_number(print, spec->backend);
    return hash_number(print, spec->has_truth ? 1.0 : 0.0);
}

const Variable *spec_variable(const Spec *spec, const char *key)
{
    for (size_t i = 0; i < spec->variable_count; i++) {
        if (strcmp(spec->variables[i].key, key) == 0) {
            return &spec->variables[i];
        }
    }
    return NULL;
}

// What a study does with a key: the variable that it is, or NULL; whether it is set for all runs.
static bool spec_sets(const Spec *spec, const char *key)
{
    const size_t length = strlen(key);
    bool is_set = false;
    for (size_t i = 0; i < spec->set_count; i++) {
        is_set = is_set || (strncmp(spec->set[i], key, length) == 0 && spec->set[i][length] == '=');
    }
    return is_set;
}

void spec_finish(Spec *spec)
{
    free(spec->path);
    free(spec->case_path);
    free(spec->case_text);
    casefile_repeat_close(spec->repeat);
    scenario_destroy(spec->base);
    for (size_t i = 0; i < spec->set_count; i++) {
        free(spec->set[i]);
    }
    for (size_t i = 0; i < spec->variable_count; i++) {
        free(spec->variables[i].numbers);
        free(spec->variables[i].words);
    }
    *spec = (Spec){0};
}

Spec *spec_open(const char *path, Err *err)
{
    Spec *spec = malloc(sizeof *spec);
    assert(spec != NULL);
    if (!spec_read(path, spec, err)) {
        free(spec);
        return NULL;
    }
    return spec;
}

void spec_close(Spec *spec)
{
    if (spec != NULL) {
        spec_finish(spec);
        free(spec);
    }
}

// The distribution of a key whose values are drawn.
//
//     KEY: tolerance                        uniform within the tolerance that the case gives
//     KEY: {uniform: [low, high]}           KEY: {log-uniform: [low, high]}
//     KEY: {normal: tolerance}              KEY: {normal: {mean: , deviation: , low: , high: }}
//     KEY: {triangular: {low: , mode: , high: }}

// Deviations from the mean to the limits of a normal distribution within a tolerance.
static const double TOLERANCE_DEVIATIONS = 3.0;
// Between limits with less of a normal distribution than this no value is right to 6 digits.
static const double NORMAL_SHARE_MIN = 1e-10;

static const char WAYS[] = "tolerance, {uniform: [low, high]}, {log-uniform: [low, high]}, "
                           "{normal: {mean, deviation}}, {triangular: {low, mode, high}}";

static bool is_tolerance(const Node *node)
{
    return node->kind == NODE_SCALAR && strcmp(node->text, "tolerance") == 0;
}

// The limits of the tolerance that the case gives to the key.
static bool spec_take_tolerance(const Reading *reading, const Node *node)
{
    Variable *variable = reading->variable;
    const Scenario *base = reading->spec->base;
    CasefileSetting setting;
    CasefileWalk walk = casefile_walk(base);
    while (casefile_next(&walk, &setting)) {
        if (setting.kind == CASEFILE_TOLERATED && strcmp(setting.key, variable->key) == 0) {
            text_copy(variable->unit, sizeof variable->unit, setting.unit);
            variable->low = setting.numbers[0] + setting.numbers[1];
            variable->high = setting.numbers[0] + setting.numbers[2];
            return true;
        }
    }
    return spec_read_refuse(
        reading, node, "a tolerance in the case such as 108 +- 0.3 mm, or {uniform: [low, high]}",
        "%s has no tolerance in %s", variable->key, reading->spec->case_path);
}

static bool spec_check_limits(const Reading *reading, const Node *node)
{
    const Variable *variable = reading->variable;
    return variable->low < variable->high ||
           spec_read_refuse(reading, node, "low below high",
                            "the lower limit is not below the upper limit of %s", variable->key);
}

bool spec_read_uniform(Reading *reading, const Node *node)
{
    reading->variable->kind = VARIABLE_UNIFORM;
    if (is_tolerance(node)) {
        return spec_take_tolerance(reading, node);
    }
    const Node *low = node->kind == NODE_LIST ? node->first : NULL;
    const Node *high = low != NULL ? low->next : NULL;
    if (high == NULL || high->next != NULL) {
        return spec_read_refuse(reading, node, "[low, high]", "the limits of %s are two values",
                                reading->variable->key);
    }
    return spec_read_number(reading, low, true, &reading->variable->low) &&
           spec_read_number(reading, high, true, &reading->variable->high) &&
           spec_check_limits(reading, node);
}

bool spec_read_log_uniform(Reading *reading, const Node *node)
{
    if (is_tolerance(node)) {
        return spec_read_refuse(reading, node, "[low, high]", "log-uniform takes no tolerance");
    }
    if (!spec_read_uniform(reading, node)) {
        return false;
    }
    reading->variable->kind = VARIABLE_LOG_UNIFORM;
    return reading->variable->low > 0.0 ||
           spec_read_refuse(reading, node->first, "limits above 0",
                            "there is no logarithm of %.60s", node->first->text);
}

static bool check_normal(const Reading *reading, const Node *node)
{
    const Variable *variable = reading->variable;
    if (!(variable->deviation > 0.0)) {
        return spec_read_refuse(reading, spec_read_child(node, "deviation"), "a deviation above 0",
                                "%s does not vary", variable->key);
    }
    const double low = (variable->low - variable->centre) / variable->deviation;
    const double high = (variable->high - variable->centre) / variable->deviation;
    return spec_check_limits(reading, node) &&
           (normal_between(low, high) >= NORMAL_SHARE_MIN ||
            spec_read_refuse(reading, node, "limits within 6 deviations of the mean",
                             "the limits of %s contain almost none of the distribution",
                             variable->key));
}

bool spec_read_normal(Reading *reading, const Node *node)
{
    Variable *variable = reading->variable;
    variable->kind = VARIABLE_NORMAL;
    if (is_tolerance(node)) {
        if (!spec_take_tolerance(reading, node)) {
            return false;
        }
        variable->centre = 0.5 * (variable->low + variable->high);
        variable->deviation = 0.5 * (variable->high - variable->low) / TOLERANCE_DEVIATIONS;
        return true;
    }
    variable->low = -INFINITY;
    variable->high = INFINITY;
    return spec_keys_read(reading, SPEC_NORMAL, node) && check_normal(reading, node);
}

bool spec_read_triangular(Reading *reading, const Node *node)
{
    Variable *variable = reading->variable;
    variable->kind = VARIABLE_TRIANGULAR;
    if (!spec_keys_read(reading, SPEC_TRIANGULAR, node) || !spec_check_limits(reading, node)) {
        return false;
    }
    return (variable->low <= variable->centre && variable->centre <= variable->high) ||
           spec_read_refuse(reading, spec_read_child(node, "mode"), "low <= mode <= high",
                            "the mode of %s lies outside its limits", variable->key);
}

static bool read_distribution(Reading *reading, const Node *node)
{
    const Variable *variable = reading->variable;
    if (is_tolerance(node)) {
        return spec_read_uniform(reading, node);
    }
    if (node->kind != NODE_MAP || node->first == NULL || node->first->next != NULL) {
        return spec_read_refuse(reading, node, WAYS, "%s needs one distribution", variable->key);
    }
    return spec_keys_read(reading, SPEC_DISTRIBUTION, node) &&
           (!variable->is_whole || variable->kind == VARIABLE_UNIFORM ||
            spec_read_refuse(reading, node, "{uniform: [low, high]}",
                             "whole numbers such as %s are drawn from a uniform distribution",
                             variable->key));
}

static bool spec_read_draw_read_key(Reading *reading, const Node *value)
{
    if (!spec_read_variable(reading, value)) {
        return false;
    }
    reading->variable->is_drawn = true;
    if (reading->variable->is_word) {
        return source_error(&reading->source, keys_span(value), "a list of them under vary",
                            reading->err, "%s takes words, which cannot be drawn",
                            reading->variable->key);
    }
    return read_distribution(reading, value);
}

bool spec_read_draws(Reading *reading, const Node *keys)
{
    return spec_read_each(reading, keys, spec_read_draw_read_key) &&
           (keys->first != NULL ||
            spec_read_refuse(reading, keys, "a key with its distribution", "nothing is drawn"));
}

// The values that a key takes one after another.
//
//     KEY: value    KEY: [value, value]    KEY: {from: value, to: value, count: 8, scale: log}

static bool add_word(const Reading *reading, const Node *node)
{
    Variable *variable = reading->variable;
    Text text;
    text_init(&text);
    if (node->kind == NODE_SCALAR) {
        text_append(&text, "%s", node->text);
    } else {
        spec_read_write(node, &text);
    }
    bool is_good = text.length < RECORD_WORD_SIZE ||
                   spec_read_refuse(reading, node, "at most 63 bytes", "this value is too long");
    for (size_t i = 0; is_good && i < variable->count; i++) {
        is_good =
            strcmp(variable->words[i], text.data) != 0 ||
            spec_read_refuse(reading, node, "each value once", "'%s' is listed twice", text.data);
    }
    if (is_good) {
        text_copy(variable->words[variable->count++], RECORD_WORD_SIZE, text.data);
    }
    text_finish(&text);
    return is_good;
}

static bool add_number(Reading *reading, const Node *node)
{
    Variable *variable = reading->variable;
    double number;
    if (!spec_read_number(reading, node, true, &number)) {
        return false;
    }
    for (uint64_t i = 0; i < variable->count; i++) {
        if (variable->numbers[i] == number) {
            return spec_read_refuse(reading, node, "each value once", "'%.60s' is listed twice",
                                    node->text);
        }
    }
    variable->numbers[variable->count++] = number;
    return true;
}

// A list, or a single value, which is a list of one. A point [x, y] is a value and no list.
static bool read_list(Reading *reading, const Node *list)
{
    Variable *variable = reading->variable;
    size_t count = 0;
    for (const Node *item = spec_read_first(list); item != NULL;
         item = spec_read_next(list, item)) {
        count++;
    }
    if (count == 0 || count > SPEC_VALUE_MAX) {
        return spec_read_refuse(
            reading, list, "1 to 1000 values, or a range {from, to, count}",
            count == 0 ? "the list of %s is empty" : "the list of %s is too long", variable->key);
    }
    variable->kind = VARIABLE_LIST;
    if (variable->is_word) {
        variable->words = calloc(count, sizeof *variable->words);
    } else {
        variable->numbers = calloc(count, sizeof *variable->numbers);
    }
    assert(variable->words != NULL || variable->numbers != NULL);
    // the names of schemes are looked at when all keys are known
    const bool is_scheme = reading->key.row == NULL;
    bool is_read = true;
    for (const Node *item = spec_read_first(list); is_read && item != NULL;
         item = spec_read_next(list, item)) {
        is_read = (is_scheme || probe_check(reading->probe, &reading->source, &reading->key, item,
                                            reading->err)) &&
                  (variable->is_word ? add_word(reading, item) : add_number(reading, item));
    }
    return is_read;
}

static bool read_range(Reading *reading, const Node *range)
{
    Variable *variable = reading->variable;
    if (variable->is_word) {
        return spec_read_refuse(reading, range, "a list [..]",
                                "the values of %s are not numbers and have no range",
                                variable->key);
    }
    variable->kind = VARIABLE_LINEAR;
    if (!spec_keys_read(reading, SPEC_RANGE, range)) {
        return false;
    }
    const bool is_log = variable->kind == VARIABLE_LOGARITHMIC;
    if (!(variable->low < variable->high)) {
        return spec_read_refuse(reading, range, "from below to", "the range of %s is empty",
                                variable->key);
    }
    if (is_log && !(variable->low > 0.0)) {
        const Node *from = spec_read_child(range, "from");
        return spec_read_refuse(reading, from, "from above 0, or scale: linear",
                                "there is no logarithm of %.60s", from->text);
    }
    // the first two are nearest to one another
    const double steps = (double)variable->count - 1.0;
    const double gap =
        is_log ? variable->low * (pow(variable->high / variable->low, 1.0 / steps) - 1.0)
               : (variable->high - variable->low) / steps;
    if (variable->is_whole && !(gap >= 1.0)) {
        return spec_read_refuse(reading, range, "steps of 1 or more",
                                "the range of %s has more values than whole numbers",
                                variable->key);
    }
    return true;
}

static bool spec_read_vary_read_key(Reading *reading, const Node *value)
{
    if (!spec_read_variable(reading, value)) {
        return false;
    }
    const SchemaRow *row = reading->key.row; // NULL for the scheme
    const char *key = reading->variable->key;
    if (row != NULL &&
        (row->type == SCHEMA_TEXT || row->type == SCHEMA_BACKENDS || !schema_is_setting(row))) {
        return source_error(&reading->source, keys_span(value),
                            row->type == SCHEMA_BACKENDS ? "scheme: [reference, auto/1e-4]"
                                                         : "any other key",
                            reading->err, "%s cannot vary", key);
    }
    // with other bodies the columns, which are those of the first run, would hold what is of others
    if (row != NULL && (row->type == SCHEMA_JOINT_NAME || row->type == SCHEMA_BETWEEN)) {
        return source_error(
            &reading->source, keys_span(value), "a separate study for each value", reading->err,
            "%s cannot vary, because a study has the columns of one mechanism", key);
    }
    return value->kind == NODE_MAP ? read_range(reading, value) : read_list(reading, value);
}

bool spec_read_vary(Reading *reading, const Node *vary)
{
    reading->vary = vary;
    return spec_read_each(reading, vary, spec_read_vary_read_key);
}

// Along which key runs follow one another.
//
//     follow: KEY    follow: {key: KEY, direction: both}

bool spec_read_follow_key(Reading *reading, const Node *value)
{
    static const char ALLOWED[] = "a key under vary that takes several numbers";
    Spec *spec = reading->spec;
    if (!spec_read_single(reading, value, "a key", ALLOWED)) {
        return false;
    }
    const Variable *variable = spec_variable(spec, value->text);
    if (variable == NULL || variable->is_word || !variable->changes_truth || variable->count < 2) {
        return spec_read_refuse(reading, value, ALLOWED,
                                variable == NULL      ? "'%.60s' does not vary"
                                : variable->is_word   ? "the values of %.60s are not numbers"
                                : variable->count < 2 ? "%.60s has one value"
                                                      : "%.60s leaves the motion as it is",
                                value->text);
    }
    text_copy(spec->follow, sizeof spec->follow, value->text);
    return true;
}

// Both directions are one more variable, of two words.
static bool add_direction(Reading *reading, const Node *value)
{
    Spec *spec = reading->spec;
    if (spec->variable_count == SPEC_VARIABLE_MAX) {
        return spec_read_refuse(reading, value, "at most 47 keys under vary",
                                "there is no room for a column of the direction");
    }
    Variable *variable = &spec->variables[spec->variable_count++];
    *variable = (Variable){
        .kind = VARIABLE_LIST,
        .is_word = true,
        .changes_truth = true,
        .count = 2,
        .words = calloc(2, sizeof *variable->words),
    };
    assert(variable->words != NULL);
    text_copy(variable->key, sizeof variable->key, SPEC_DIRECTION_KEY);
    text_copy(variable->words[0], RECORD_WORD_SIZE, "forward");
    text_copy(variable->words[1], RECORD_WORD_SIZE, "backward");
    return true;
}

bool spec_read_follow(Reading *reading, const Node *value)
{
    const Spec *spec = reading->spec;
    if (!(value->kind == NODE_SCALAR ? spec_read_follow_key(reading, value)
                                     : spec_keys_read(reading, SPEC_FOLLOW, value))) {
        return false;
    }
    if (!scenario_settles(spec->base)) {
        return spec_read_refuse(reading, value,
                                "a case with play and a drive of constant speed or with "
                                "drive.period, and run.start: settled",
                                "there is no settled motion to follow in this case");
    }
    return spec->direction != FOLLOW_BOTH || add_direction(reading, value);
}
