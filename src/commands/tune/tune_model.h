// MuJoCo's whole model of a case, with constants in place of the law.
#pragma once

#include "base/text.h"
#include "commands/tune/tune_runs.h"

// With constants that were found for a pin in its hole: makes the model and runs it, at a step, s.
// Without a driver of MuJoCo there is none, for a reason that stands in the model.
void tune_model_run(const TuneSearch *search, double step_s);

// Appends the model with its measured error; false where there is none.
bool tune_model_write(const Tune *tune, Text *text);
