// Studies of the paper's cases, from a text that a test holds. Runs in the source root.
#pragma once

#include "scratch.h"

#include "commands/study/design.h"

#include <string.h>

// Reads a study of cases/NAME with the rest of its text.
static inline bool study_try(const char *name, const char *rest, Spec *spec, Err *err)
{
    char path[512];
    char folder[512];
    scratch_path("study.yaml", path, sizeof path);
    assert_non_null(getcwd(folder, sizeof folder));
    FILE *stream = fopen(path, "w");
    assert_non_null(stream);
    fprintf(stream, "case: %s/cases/%s\n%s", folder, name, rest);
    assert_int_equal(fclose(stream), 0);
    const bool is_read = spec_read(path, spec, err);
    unlink(path);
    return is_read;
}

// One that must be good. The caller finishes it.
static inline Spec study_read(const char *name, const char *rest)
{
    Spec spec;
    Err err = {0};
    if (!study_try(name, rest, &spec, &err)) {
        fail_msg("%s", err.text);
    }
    return spec;
}

static inline const Variable *study_variable(const Spec *spec, const char *key)
{
    for (size_t i = 0; i < spec->variable_count; i++) {
        if (strcmp(spec->variables[i].key, key) == 0) {
            return &spec->variables[i];
        }
    }
    fail_msg("no variable %s", key);
    return NULL;
}
