// The program that --code writes, run before it is written: what it is worth is not derived from
// the trials, whose world is another, but measured.
#pragma once

#include "commands/tune/tune_runs.h"

// Runs the world of the program of a scenario, which has a setting with a step, and holds it
// against the reference at the times that the program prints. Where the error is above the target
// that the setting meets, the step is shortened along the grid until it is not; a step that is held
// stays, and so does one that may not be shortened. The result is the search's program. Fails with
// ERR_SOLVER where there is no process left.
bool tune_program_run(const TuneSearch *search, const Scenario *scenario, bool may_shorten,
                      Err *err);
