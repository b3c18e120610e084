// The cheapest setting of another engine: which of its ways, at which step.
#pragma once

#include "cli/common_options.h"

// What is asked for.
typedef struct TuneEngineOptions {
    const CommonOptions *common;
    const char *engine; // NAME or NAME/WAY+WAY
    double target;      // 1, of the error that the scenario's tolerance is of
} TuneEngineOptions;

// Finds the start of the scenario, runs the engine's ways at falling steps, each until its error
// meets the target, and prints how cheap they are. ERR_USAGE where there is no such engine or way,
// ERR_CASE, before anything runs, where it does not take the case, ERR_DIFFERS where nothing meets
// the error.
bool tune_engine_run(const TuneEngineOptions *options, Scenario *scenario, Err *err);
