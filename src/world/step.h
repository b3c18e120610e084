// What other files need of a step.
#pragma once

#include "world/play.h"

// Finds the bodies of a world as a step does at its start. JP_ERROR_WORLD where a body of a joint
// was destroyed, JP_ERROR_MEMORY.
JpStatus step_know_bodies(JpWorld *world, JpError *error);
