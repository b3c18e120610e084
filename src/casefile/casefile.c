// Makes a scenario of a case file.
//
// text -> tree of nodes -> known keys (overrides in their places) -> scenario.
#include "casefile/casefile.h"

#include "base/zeroed.h"
#include "casefile/assemble.h"
#include "casefile/input.h"

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
        .what = "case",
        .is_option = true,
        .is_override = true,
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

// A case and its overrides as trees, and what they say key by key.
typedef struct Reading {
    Source source;
    Node *root;
    size_t override_count;
    Override *overrides; // owned
    Entries entries;
} Reading;

static void reading_finish(Reading *reading)
{
    for (size_t i = 0; i < reading->override_count; i++) {
        override_finish(&reading->overrides[i]);
    }
    free(reading->overrides);
    document_destroy(reading->root);
    entries_finish(&reading->entries);
    *reading = (Reading){.root = NULL};
}

static bool read_entries(Reading *reading, Err *err)
{
    if (!entries_read(&reading->entries, reading->root, &reading->source, err)) {
        return false;
    }
    for (size_t i = 0; i < reading->override_count; i++) {
        const Override *override = &reading->overrides[i];
        if (!entries_override(&reading->entries, override->key, strlen(OPTION), override->value,
                              &override->source, err)) {
            return false;
        }
    }
    return true;
}

// Fills a zeroed reading, which stays where it is: entries point into it. For reading_finish also
// on failure.
static bool reading_take(Reading *reading, const char *name, const char *text, size_t size,
                         const char *const *overrides, size_t override_count, Err *err)
{
    if (!input_parse("case", name, text, size, &reading->source, &reading->root, err)) {
        return false;
    }
    reading->overrides = zeroed(override_count + 1, sizeof *reading->overrides);
    for (size_t i = 0; i < override_count; i++) {
        reading->override_count++;
        if (!override_read(&reading->overrides[i], overrides[i], err)) {
            return false;
        }
    }
    return read_entries(reading, err);
}

// Reads the text and the overrides into trees, which live until the scenario is built.
bool casefile_load_text(const char *name, const char *text, size_t size,
                        const char *const *overrides, size_t override_count, Scenario *scenario,
                        Err *err)
{
    Reading reading = {.root = NULL};
    const bool is_good = reading_take(&reading, name, text, size, overrides, override_count, err) &&
                         assemble_scenario(&reading.entries, scenario, err);
    reading_finish(&reading);
    return is_good;
}

// The same case again and again.
//
// Which keys a case has follows from its keys and those of the overrides alone: where nothing but
// the single values of overrides differs, the trees are those of the last time, with other texts in
// the places of these values.

struct CasefileRepeat {
    char *name; // owned
    const char *text;
    size_t size;
    bool is_read;
    Reading reading; // where it is
};

CasefileRepeat *casefile_repeat_open(const char *name, const char *text, size_t size)
{
    CasefileRepeat *repeat = zeroed(1, sizeof *repeat);
    repeat->name = strdup(name);
    assert(repeat->name != NULL);
    repeat->text = text;
    repeat->size = size;
    return repeat;
}

void casefile_repeat_close(CasefileRepeat *repeat)
{
    if (repeat != NULL) {
        reading_finish(&repeat->reading);
        free(repeat->name);
        free(repeat);
    }
}

// Whether YAML takes a text as one single value that is the text itself: a number with its unit or
// a word, of letters, digits, blanks between them, and what numbers and units are written with.
static bool is_plain_value(const char *text)
{
    static const char FIRST[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789";
    static const char FURTHER[] =
        " -+.^_/abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789";
    const char *start = text + (text[0] == '-' ? 1 : 0);
    const size_t length = strlen(start);
    return length > 0 && strchr(FIRST, start[0]) != NULL && strspn(start, FURTHER) == length &&
           start[length - 1] != ' ';
}

// Puts another value into the place of that of an override. False where it has another key, or one
// of the two is more than a single value.
static bool override_repeat(Override *override, const char *argument)
{
    const char *own = override->shown.data + strlen(OPTION);
    const size_t key_size = strlen(override->key);
    if (strcmp(own, argument) == 0) {
        return true;
    }
    if (strncmp(own, argument, key_size) != 0 || argument[key_size] != '=') {
        return false;
    }
    const char *value = argument + key_size + 1;
    if (!is_plain_value(value) || !is_plain_value(own + key_size + 1)) {
        return false;
    }
    override->shown.length = 0;
    text_append(&override->shown, "%s%s", OPTION, argument);
    override->source.name = override->source.text = override->shown.data;
    override->source.size = override->shown.length;
    free(override->value->text);
    override->value->text = strdup(value);
    assert(override->value->text != NULL);
    override->value->span.end = override->value->span.start + strlen(value);
    return true;
}

static bool reading_repeat(Reading *reading, const char *const *overrides, size_t override_count)
{
    if (override_count != reading->override_count) {
        return false;
    }
    for (size_t i = 0; i < override_count; i++) {
        if (!override_repeat(&reading->overrides[i], overrides[i])) {
            return false;
        }
    }
    return true;
}

bool casefile_repeat(CasefileRepeat *repeat, const char *const *overrides, size_t override_count,
                     Scenario *scenario, Err *err)
{
    Reading *reading = &repeat->reading;
    if (!repeat->is_read || !reading_repeat(reading, overrides, override_count)) {
        reading_finish(reading);
        repeat->is_read = reading_take(reading, repeat->name, repeat->text, repeat->size, overrides,
                                       override_count, err);
    }
    return repeat->is_read && assemble_scenario(&reading->entries, scenario, err);
}

bool casefile_load(const char *path, const char *const *overrides, size_t override_count,
                   Scenario *scenario, Err *err)
{
    char *text;
    size_t size;
    const bool is_stdin = strcmp(path, "-") == 0;
    if (!(is_stdin ? input_read_stdin("case", &text, &size, err)
                   : input_read("case", path, &text, &size, err))) {
        return false;
    }
    const bool is_good = casefile_load_text(is_stdin ? INPUT_STDIN : path, text, size, overrides,
                                            override_count, scenario, err);
    free(text);
    return is_good;
}
