// Why can a motion not be followed? In words that say what to change.
#pragma once

#include "reference/dynamics.h"

// The equations for the accelerations have no solution: masses and inertias too far apart for the
// digits of a double, or joints that hold each other up. Returns false, with ERR_SOLVER.
bool refusal_undetermined(const Linkage *linkage, Err *err);
