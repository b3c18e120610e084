// What a scenario in space needs of its bodies and joints.
#pragma once

#include "casefile/entries.h"

// Moments and products of inertia that a body can have, and a width of every joint with play. Fails
// with ERR_CASE and a line of the case; planar scenarios have nothing to fail in.
bool check_space(const Entries *entries, const Scenario *scenario, Err *err);
