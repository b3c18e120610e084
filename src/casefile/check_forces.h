// Checks of the springs and the torque of a case.
#pragma once

#include "casefile/entries.h"

// Fails where springs or a torque do not go with the rest of the case.
bool check_forces(const Entries *entries, const Scenario *scenario, Err *err);
