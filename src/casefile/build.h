// From the sizes of a four-bar to a linkage that stands at its start.
#pragma once

#include "model/scenario.h"

// Names the bodies and joints, sets anchors, driver and traced points, and finds the motions at
// time zero. Expects lengths, masses, clearances, joint kinds, drive (present) and points in their
// places (points still measured along the link from its first joint). Fails with ERR_SOLVER where
// the linkage cannot be solved at the start.
bool build_fourbar(Scenario *scenario, Err *err);
