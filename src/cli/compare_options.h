// What `jointplay compare` was asked for.
#pragma once

#include "base/err.h"
#include "base/text.h"
#include "cli/option_values.h"
#include "compare/ladder.h"

#include <stdbool.h>

typedef struct CompareOptions {
    const char *path; // of the case
    const char *overrides[OPTION_SETTING_MAX];
    size_t override_count;
    const char *steps;   // as given, or NULL
    const char *schemes; // as given, or NULL
    size_t repeats;
    size_t jobs;
    double time_limit_s; // of one run
    const char *store;   // NULL: the usual one
    bool is_fresh;
    bool is_json;
    const char *csv;
    const char *plot;
    const char *folder;
    bool is_quiet;
} CompareOptions;

// Reads the command line; where help was asked for it is printed and *is_answered is true.
// ERR_USAGE.
bool compare_options_read(int argc, char **argv, CompareOptions *options, bool *is_answered,
                          Err *err);

// The ladder that the options ask for: schemes of the scenario, steps coarse to fine. Fails with
// ERR_USAGE for a step that is none or that the scenario cannot be run at.
bool compare_options_ladder(const CompareOptions *options, const Scenario *scenario,
                            Ladder **ladder, Err *err);
