// Makes a scenario of a case file.
//
// text -> tree of nodes -> known keys (overrides in their places) -> scenario.
#include "casefile/casefile.h"

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

static bool read_entries(Entries *entries, const Node *root, const Source *source,
                         const Override *overrides, size_t override_count, Err *err)
{
    if (!entries_read(entries, root, source, err)) {
        return false;
    }
    for (size_t i = 0; i < override_count; i++) {
        const Override *override = &overrides[i];
        if (!entries_override(entries, override->key, strlen(OPTION), override->value,
                              &override->source, err)) {
            return false;
        }
    }
    return true;
}

// Reads the text and the overrides into trees, which live until the scenario is built.
bool casefile_load_text(const char *name, const char *text, size_t size,
                        const char *const *overrides, size_t override_count, Scenario *scenario,
                        Err *err)
{
    Source source;
    Node *root = NULL;
    if (!input_parse("case", name, text, size, &source, &root, err)) {
        return false;
    }
    Override *read = calloc(override_count + 1, sizeof *read);
    Entries *entries = calloc(1, sizeof *entries);
    assert(read != NULL && entries != NULL);
    bool is_good = true;
    for (size_t i = 0; is_good && i < override_count; i++) {
        is_good = override_read(&read[i], overrides[i], err);
    }
    is_good = is_good && read_entries(entries, root, &source, read, override_count, err) &&
              assemble_scenario(entries, scenario, err);
    for (size_t i = 0; i < override_count; i++) {
        override_finish(&read[i]);
    }
    document_destroy(root);
    entries_finish(entries);
    free(entries);
    free(read);
    return is_good;
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
