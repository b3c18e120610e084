// What decides what the runs of a study are?
//
// The case as it resolves with what is set, key by key, and what varies: so neither comments and
// layout of the two files nor where they lie matter, nor the limits and titles.
#include "commands/study/spec.h"

#include "base/hash.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

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

uint64_t spec_print(const Spec *spec)
{
    uint64_t print = add_case(HASH_START, spec->base);
    for (size_t i = 0; i < spec->variable_count; i++) {
        print = add_variable(print, &spec->variables[i]);
    }
    print = hash_number(print, (double)spec->draws);
    print = hash_number(print, spec->method);
    print = hash_number(print, (double)spec->seed);
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

bool spec_sets(const Spec *spec, const char *key)
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
