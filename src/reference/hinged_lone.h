// A body on no hinge whose pin is in a hole of the ground, or whose hole is about a pin there: what
// drops, bounces and rolls.
#pragma once

#include "reference/hinged_pair.h"

// Whether a mechanism is such a body.
bool hinged_lone_is(const Hinged *hinged);

// As hinged_rates, to the last bit.
bool hinged_lone_rates(const Hinged *hinged, double since_s, const double *y, double *rates);
