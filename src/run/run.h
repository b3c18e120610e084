// One scenario on one solver makes one trajectory, observed at every step, timed.
#pragma once

#include "model/solver.h"

// Called now and then with the share of the run that is done, 0 to 1, and the wall time so far, s.
typedef void (*RunProgress)(double share, double wall_s, void *context);

typedef struct RunWatch {
    RunProgress progress; // NULL: nobody watches
    void *context;
} RunWatch;

// Runs the scenario. Never fails as a function: where the solver fails, the trajectory is not
// complete and says when and why. The caller destroys it.
Trajectory *run_scenario(const Scenario *scenario, const Solver *solver, RunWatch watch);
