// Settings of tests of solvers and laws, whose outside truths are of one start and one law: unless
// they say otherwise pins start in the middle of their holes, and contacts know the speed of their
// impact alone.
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <string.h>

enum { OF_ONE_START_MAX = 2 }; // settings that are put before others

static inline bool of_one_start_names(const char *const *overrides, size_t count, const char *key)
{
    bool names = false;
    for (size_t i = 0; i < count; i++) {
        names = names || strncmp(overrides[i], key, strlen(key)) == 0;
    }
    return names;
}

// Writes all settings, and returns how many there are; room for OF_ONE_START_MAX more is needed.
static inline size_t of_one_start(const char *const *overrides, size_t count, const char **all)
{
    size_t used = 0;
    if (!of_one_start_names(overrides, count, "run.start=")) {
        all[used++] = "run.start=centred";
    }
    if (!of_one_start_names(overrides, count, "contact.resting-speed=")) {
        all[used++] = "contact.resting-speed=none";
    }
    for (size_t i = 0; i < count; i++) {
        all[used++] = overrides[i];
    }
    return used;
}
