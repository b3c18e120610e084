// How long a search will still take.
#pragma once

#include "commands/tune/tune.h"

// The settings of some schemes that a search may still run.
typedef struct TuneLeft {
    bool is_in[SCHEME_MAX];
    double best;      // cost of the best setting that meets the target; INFINITY where none does
    double margin;    // settings that cost more than this times the best are not run
    double limit_s;   // nor settings that take longer
    bool is_reopened; // schemes that were ended because they cost more go on
} TuneLeft;

// The time by the clock, s, of the runs that are to be expected one after another. Errors are taken
// to go on falling as between the last two settings of a scheme; schemes that have not been run are
// left out.
double tune_left(const Tune *tune, const TuneLeft *left);
