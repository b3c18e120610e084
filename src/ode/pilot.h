// Trial runs of a scenario: what they find is compared, and then thrown away.
#pragma once

#include "model/distance.h"
#include "model/solver.h"

// How trial runs are made, and what they have cost.
typedef struct Pilots {
    const Solver *solver;
    SolverPulse pulse;
    size_t steps; // of all of them
    Err failure;  // why the last one failed that did
    size_t evaluations;
} Pilots;

// Runs a scenario up to a time on the samples of another, which may be finer. The trajectory holds
// bodies' motions alone, at the samples up to there; its step_s is the scenario's. Returns it, or
// NULL where the solver fails.
Trajectory *pilot_run(Pilots *pilots, const Scenario *scenario, const Scenario *grid,
                      double until_s);

// The time up to which the motion is predictable, s, at most `until_s`: where the first of several
// twins of the scenario, started a little beside it, has come too far away.
double pilot_horizon(Pilots *pilots, const Scenario *scenario, const Scenario *grid,
                     const DistanceScale *scales, double until_s);
