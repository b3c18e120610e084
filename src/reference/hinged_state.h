// Everything of a mechanism of hinges and pins in holes at one instant, by the way of its rates
// (reference/hinged.h): the same numbers as those of reference/dynamics.c, to the last bit.
#pragma once

#include "reference/hinged_move.h"

// Fills in a state and, where asked for, the rates of the integrator's vector there (else NULL).
// Returns false where the second rates are not determined. The drive's speed must be steady.
bool hinged_evaluate(const Hinged *hinged, double since_s, const double *y, DynamicsState *state,
                     double *rates);

// From second rates: accelerations, the forces of the hinges on the bodies that they hang on, added
// to these, and on the driven one. Writes the force of each hinge on its body b, N, by joint; NULL:
// nowhere.
void hinged_hold(const Hinged *hinged, const double *rates, HingedLoad *load, Vec2 *reactions);

// Shows the bodies' positions and velocities; their accelerations stay as they are.
void hinged_place(const Hinged *hinged, double since_s, const double *y, Motion *motions);
