// Mechanisms that share nothing but the ground, side by side: contacts integrated within the step.
#pragma once

#include "model/several.h"

#include <ode/ode.h>

// Opens them (model/several.h), each stepped by that solver, whose states have such a world.
bool impulse_parts_open(const Scenario *scenario, const Solver *solver,
                        dWorldID (*world)(const void *state), void **state, Err *err);

dWorldID impulse_world(const void *state);

extern const Solver STEPPING_IMPULSE_PARTS; // of several in the plane
