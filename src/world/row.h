// The row of ODE by which one side of a joint presses in a step.
#pragma once

#include "world/play.h"

// Makes the row sign * rate_after + CFM F = speed, F >= 0, of the coordinate's rate and a force
// that pushes it by sign * F. Of a slider that is a contact in the group.
void row_make(JpJoint *joint, const Side *side, double cfm, double speed, double step,
              dJointGroupID group);

// The force of the row after ODE's step, N m or N; takes the row of an angle away. That of a slider
// goes with its group.
double row_take(JpJoint *joint);
