// From bodies and joints placed in the world to a linkage that stands at its start.
#pragma once

#include "casefile/entries.h"

// Turns the places of the joints, which stand in anchor_a, into anchors of their bodies, puts pins
// where they start, and finds or checks the speeds at time zero. Fails with ERR_CASE or ERR_USAGE
// and a place where joints are redundant or speeds do not agree, and with ERR_SOLVER without a
// place where the linkage cannot be solved at the start.
bool place_linkage(const Entries *entries, Scenario *scenario, Err *err);
