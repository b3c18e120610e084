// Mechanisms that share nothing but the ground, side by side: contacts integrated within the step.
#pragma once

#include "model/solver.h"

// How many mechanisms of a planar linkage can be stepped apart; 1 where they have to be stepped
// together.
size_t impulse_parts_count(const Scenario *scenario);

// Whether the part that an impulse solver has taken last ends with its step.
bool impulse_is_at_end(const void *state);

extern const Solver STEPPING_IMPULSE_PARTS; // where there are several
