// The ways in which a linkage in space is stepped in ODE: solvers, to which ode/ode_solver.c hands
// on.
#pragma once

#include "model/solver.h"

extern const Solver SPACE_PLAIN;
extern const Solver SPACE_STAGGERED;
extern const Solver SPACE_IMPULSE;
extern const Solver SPACE_IMPULSE_PARTS; // of mechanisms that share nothing but the ground
