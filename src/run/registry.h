// The solvers of the program.
#pragma once

#include "model/solver.h"

// The solver that stands behind one backend of a case file.
const Solver *registry_solver(BackendKind backend);

// Whether a backend can run a scenario at all, and whether all of its own can, asked before any
// long work: its start may still have to be found. Fails with ERR_CASE, naming what cannot be run.
bool registry_check_backend(const Scenario *scenario, BackendKind backend, Err *err);
bool registry_check(const Scenario *scenario, Err *err);
