// The reference: the same contact problem integrated to an error far below that of any engine.
#pragma once

#include "model/solver.h"

extern const Solver REFERENCE_SOLVER;
