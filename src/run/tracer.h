// The history of every signal of a run, and the spikes in it.
#pragma once

#include "run/run.h"

// Finds the spikes of the run that it looks at.
extern const RunProbe TRACER_PROBE;

// Runs the scenario as run_scenario does and finds its spikes. Where the solver takes every joint
// as ideal, or each is, they are not looked for.
Trajectory *tracer_run(const Scenario *scenario, const Solver *solver, RunWatch watch);
