// Checks the friction of ideal joints.
#pragma once

#include "casefile/entries.h"
#include "model/scenario.h"

// Refuses keys of the friction of an ideal joint that do not go together, and friction where
// something that is asked for does not know it.
bool check_friction(const Entries *entries, const Scenario *scenario, Err *err);
