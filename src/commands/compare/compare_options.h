// What `jointplay compare` was asked for.
#pragma once

#include "base/err.h"
#include "base/text.h"
#include "cli/common_options.h"
#include "measure/ladder.h"

#include <stdbool.h>

typedef struct CompareOptions {
    CommonOptions common;
    const char *steps; // as given, or NULL
    size_t repeats;
    const char *store; // NULL: the usual one
    bool is_fresh;
    const char *csv;
    const char *plot;
} CompareOptions;

extern const Arguments COMPARE_ARGUMENTS;
CompareOptions compare_options_default(void);

// The ladder that the options ask for: schemes of the scenario, steps coarse to fine. Fails with
// ERR_USAGE for a step that is none or that the scenario cannot be run at.
bool compare_options_ladder(const CompareOptions *options, const Scenario *scenario,
                            Ladder **ladder, Err *err);
