// Reads case files in a test: what must load, and what must be refused with which words.
#pragma once

#include "casefile/casefile.h"

#include "close.h"
#include "kept.h"

static inline Scenario load(const char *path, const char *const *overrides, size_t count)
{
    Scenario scenario;
    Err err = {0};
    if (!casefile_load(path, overrides, count, &scenario, &err)) {
        fail_msg("%s", err.text);
    }
    return kept_instead(&scenario);
}

static inline Scenario load_with(const char *path, const char *override)
{
    return load(path, &override, 1);
}

static inline void refuse(const char *path, const char *override, ErrKind kind, const char *message)
{
    Scenario scenario;
    Err err = {0};
    assert_false(casefile_load(path, &override, override != NULL ? 1 : 0, &scenario, &err));
    assert_string_equal(err.text, message);
    assert_int_equal(err.kind, kind);
}
