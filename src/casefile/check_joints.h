// Whether the sizes, the start and the stiffness of each joint with play fit together.
#pragma once

#include "casefile/entries.h"

bool check_joints(const Entries *entries, const Scenario *scenario, Err *err);
