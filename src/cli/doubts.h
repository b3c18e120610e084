// What a case may have got wrong though it can be run.
#pragma once

#include "model/scenario.h"

// Writes a warning to standard error for each joint that is far from its bodies: a place or an
// inertia in the wrong unit.
void doubts_say(const Scenario *scenario);
