// How far the revolutions of a search have come, by several threads.
#pragma once

#include "run/run.h"

#include <stdatomic.h>

typedef struct TurnWatch {
    RunWatch watch;
    double started_s;     // by the clock
    double computed_s;    // of processor time, when it began
    double budget_s;      // of processor time, in which it ends; 0: it has none
    atomic_size_t turned; // revolutions so far
    size_t most;          // that there may be
} TurnWatch;

TurnWatch turn_watch_begin(RunWatch watch);

// One more; the listener is told in the caller's thread alone.
void turn_watch_count(TurnWatch *watch, bool is_callers);
