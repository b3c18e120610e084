// What `jointplay tune` was asked for.
#pragma once

#include "base/err.h"
#include "cli/common_options.h"
#include "commands/tune/tune.h"

#include <stdbool.h>

typedef struct TuneOptions {
    CommonOptions common;
    double error;           // 1; 0 until it is given
    double at_step_s;       // s, the only step that can be taken; 0: any
    const char *asked_cost; // of --cost, or NULL
    TuneCost cost;
    TuneLimit limit;
    const char *code;
    const char *sdf;
    const char *mjcf;
} TuneOptions;

extern const Arguments TUNE_ARGUMENTS;
TuneOptions tune_options_default(void);

// The search that the options ask for, with nothing run yet. Fails with ERR_USAGE for schemes that
// the case does not have, with ERR_CASE for a case in which nothing could be tuned.
bool tune_options_search(const TuneOptions *options, const Scenario *scenario, Tune **tune,
                         Err *err);
