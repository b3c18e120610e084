// The mean forces of a step whose contacts are integrated inside it, and the work of the drive.
#pragma once

#include "ode/space_impulse_step.h"

// Fills in both for a step that has been taken.
void space_impulse_means_find(SpaceImpulseStep *step);
