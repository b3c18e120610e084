// Says how long a run will take that takes more than about a minute, before it begins.
#pragma once

#include "model/scenario.h"

// Where ODE has very many steps to make, a first part of them is run and timed, and the time of all
// is written to standard error; nothing where it is short. Of a step that is chosen as the run
// goes, and of the reference, progress_watch says it while they run.
void long_work_announce(const Scenario *scenario);

// A time as people say it, such as "3.2 h".
void long_work_words(double time_s, char *words, size_t size);
