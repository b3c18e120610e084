// The row of ODE by which one side of a place presses in a step.
#pragma once

#include "world/play.h"

// Makes the row sign * rate_after + CFM F = speed, F >= 0, of the place's rate and a force that
// pushes it by sign * F. Of a way that is a contact in the world's group of rows.
void row_make(JpJoint *joint, Place *place, const Side *side, double cfm, double speed,
              double step);

// The force of a row of a way on the joint's first body after ODE's step, N, friction included; and
// what friction took in the step, J.
Vec3 row_force(const JpJoint *joint, const Place *place);
double row_slid(const Place *place, Vec3 force, double step);

// The force of the row after ODE's step, N m or N; takes the row of an angle away. That of a way
// goes with its group.
double row_take(Place *place);
