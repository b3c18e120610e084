// The gyroscopic torques of a step whose positions stand at mid-step.
#pragma once

#include "world/bodies.h"

// Puts them on all bodies that have ODE's own and whose inertia is not that of a ball, and takes
// ODE's away; bodies stand at mid-step, with the angular velocities of the step's start.
void gyration_push(Bodies *bodies, double step);

// Gives ODE its own back, and notes the angular velocities at the end for the next step.
void gyration_finish(Bodies *bodies, double step);
