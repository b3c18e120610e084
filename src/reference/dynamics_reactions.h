// The forces of the ideal joints.
#pragma once

#include "reference/dynamics_loads.h"

// Fills in the accelerations of the bodies from what the equations were solved for, then the
// reactions of the ideal joints but the drive's; adds those to the loads.
void dynamics_reactions_find(const Dynamics *dynamics, const double *solved, Loads *loads,
                             DynamicsState *state);
