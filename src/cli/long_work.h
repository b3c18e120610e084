// Warns of long work, before it begins or once its pace is known.
#pragma once

#include "model/scenario.h"

#include <stdbool.h>

// The time, s, from which on work is long: less where no progress is shown.
double long_work_limit(bool is_quiet);

enum { LONG_WORK_TIME_SIZE = 32 };

// A time, s, in words, such as "3.2 h".
void long_work_time(double time_s, char words[LONG_WORK_TIME_SIZE]);

// Warns on standard error of work that takes long; returns whether it did.
bool long_work_warn(const char *what, double time_s, bool is_quiet);

// Where ODE has very many steps to make, a first part of them is run and timed, and the time of all
// is written to standard error; nothing where it is short. Returns whether it was. Of a step that
// is chosen as the run goes, and of the reference, progress_watch says it while they run.
bool long_work_announce(const Scenario *scenario, bool is_quiet);
