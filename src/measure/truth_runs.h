// The runs that a truth consists of (measure/truth.c), made at the same time where there are
// processors: the first, the second and the third, and perturbed ones beside the second, which
// begin as soon as that is there.
#pragma once

#include "model/growth.h"
#include "run/run.h"

typedef struct TruthRuns TruthRuns;

// Makes all of them by at most so many threads; truth_runs_finish frees it.
TruthRuns *truth_runs_make(const Scenario *scenario, RunWatch watch, size_t threads);

// The first at the case's own samples and on the fine grid, and the two that it is compared with,
// on that; none of them need be complete.
const Trajectory *truth_runs_first(const TruthRuns *runs);
const Trajectory *truth_runs_fine(const TruthRuns *runs);
const Trajectory *truth_runs_second(const TruthRuns *runs);
const Trajectory *truth_runs_third(const TruthRuns *runs);

double truth_runs_duration(const TruthRuns *runs); // s

// Of the perturbed runs, up to a time, s; asked once. False where there were none: of mechanisms of
// more than PERTURB_BODY_MAX bodies, or where another run is not complete.
bool truth_runs_growth(TruthRuns *runs, double until_s, Growth *growth);

// Returns the first run, the caller's from here on, and frees all else.
Trajectory *truth_runs_finish(TruthRuns *runs);
