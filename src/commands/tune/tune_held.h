// What can be had at a step that is held: every scheme, and the best constants.
#pragma once

#include "commands/tune/tune_runs.h"

// Runs every scheme at the step that is held, and takes in what comes of it.
bool tune_held_run(const TuneSearch *search, Err *err);

// Adds constants to those that are to be run: the best for an impact of median mass and speed, and
// for the hardest, as kp and kd and as ERP and CFM. Adds nothing where the law has no such impact.
// Fails with ERR_SOLVER where the reference does.
bool tune_held_constants(const TuneSearch *search, Err *err);
