// The places at which the bodies of a linkage touch, as its equations of motion know them.
#pragma once

#include "reference/dynamics_state.h"

// Fills in the contacts and their places, for which there is room. Fails with ERR_CASE where a law
// does not fit a joint.
bool dynamics_places_list(const Scenario *scenario, Dynamics *dynamics, Err *err);
