// The closed-form four-bar as a solver: every joint ideal, every sample exact.
#pragma once

#include "model/solver.h"

extern const Solver ANALYTIC_SOLVER;
