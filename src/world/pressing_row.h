// Rows of ODE that press and never pull: of an angle and of a way. Both the worlds of cases and
// those of callers are stepped with them.
#pragma once

#include "base/vec3.h"

#include <ode/ode.h>

// A row of an angle, which does nothing until it presses: the rate of the first body about the
// axis against that of the second, of which one may be NULL, the world. NULL: there is no memory.
dJointID pressing_row_of_angle(dWorldID world, const dBodyID bodies[2], dJointFeedback *feedback);

// The axis of the row, in the world; of ODE's first body, which is the second one where the first
// is the world.
void pressing_row_set_axis(dJointID row, double x, double y, double z);

// In the next step: rate_after + CFM M = speed, M >= 0, M the torque about the axis.
void pressing_row_press(dJointID row, double cfm, double speed, double step_s);

// After it: the row does nothing again.
void pressing_row_rest(dJointID row);

// A row of a way, for one step: the contact as ODE wants it, its normal that of the force on the
// first body.
dJointID pressing_row_of_way(dWorldID world, dJointGroupID group, const dContact *contact,
                             const dBodyID bodies[2], dJointFeedback *feedback);

// What a row of a way did to the first body after the step, N, friction included.
Vec3 pressing_row_force(const dJointFeedback *feedback, const dBodyID bodies[2]);
