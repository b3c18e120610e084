// The rates of a mechanism whose bodies hang on hinges, or on nothing, and touch at pins in their
// holes alone: what most mechanisms with play are, and what an integrator asks for most.
//
// The same numbers as those of reference/dynamics.c, to the last bit, from the same operations in
// the same order; but everything of a body stands in one place, and nothing is worked out that
// rates do not need: no angles and positions, no pin that is apart from its wall.
#pragma once

#include "reference/dynamics_state.h"

// Prepares the rates of these equations, which must outlive it; hinged_destroy frees it, and
// accepts NULL. Returns NULL where they are of another kind: with loops, slides, springs, dampers
// or torques, friction, or places that are no pins in holes.
Hinged *hinged_create(const Dynamics *dynamics);
void hinged_destroy(Hinged *hinged);

// Writes rates of the integrator's vector. Returns false where they are not determined, or where
// the drive's speed changes, which is not for here.
bool hinged_rates(const Hinged *hinged, double since_s, const double *y, double *rates);
