// The solvers of the program.
#pragma once

#include "model/solver.h"

// The solver that stands behind one backend of a case file.
const Solver *registry_solver(BackendKind backend);
