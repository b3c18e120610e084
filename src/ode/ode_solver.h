// The Open Dynamics Engine as a solver.
//
// No file of this folder may be named like one of ODE's own headers: <ode/ode.h> is looked for in
// src/ first.
#pragma once

#include "model/solver.h"

extern const Solver ODE_SOLVER;
