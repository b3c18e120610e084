// Whether a motion passes a change point of its ideal joints about a time.
#pragma once

#include "model/trajectory.h"

// Whether the ideal joints of a small mechanism in the plane come close to a change point, where
// their constraints depend on one another, within a hundredth of the run before or after a time, s.
// An ODE step that opens the joints by little may there go on along the other branch, at any step.
bool change_point_is_near(const Trajectory *truth, double time_s);
