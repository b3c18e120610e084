// Keys that a case gives and makes no use of.
#pragma once

#include "casefile/entries.h"

// Refuses a key that nothing makes use of because another one was forgotten, such as an inertia
// about x in a planar case. Where --set replaces what decides about it, it is kept for the other
// setting and is not refused.
bool unused_check(const Entries *entries, const Scenario *scenario, Err *err);

// Takes all that was given into the scenario, for casefile_unused.
void unused_remember(const Entries *entries, Scenario *scenario);
