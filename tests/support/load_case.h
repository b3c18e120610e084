// Reads case files in a test: what must load, and what must be refused with which words.
#pragma once

#include "casefile/casefile.h"

#include "close.h"
#include "kept.h"
#include "of_one_start.h"

enum { LOAD_OVERRIDE_MAX = 32 };

static inline Scenario load(const char *path, const char *const *overrides, size_t count)
{
    const char *all[LOAD_OVERRIDE_MAX];
    assert_true(count + OF_ONE_START_MAX <= LOAD_OVERRIDE_MAX);
    const size_t used = of_one_start(overrides, count, all);
    Scenario scenario;
    Err err = {0};
    if (!casefile_load(path, all, used, &scenario, &err)) {
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
