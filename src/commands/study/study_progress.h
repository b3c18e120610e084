// How far a study has come: a line on standard error, as of a long run, gone at its end.
#pragma once

#include "cli/status_line.h"
#include "commands/study/sweep.h"

// Says how far it has come, if it is time for a line.
void study_progress_show(StatusLine *line, const SweepState *state);
