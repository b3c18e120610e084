// Speeds at the end of a step that keep ODE's joints as they are there.
#pragma once

#include "world/play.h"

// Whether ODE's joints of all known bodies only hold: none of them presses, slips, drives or damps.
// Then a step is linear in all forces.
bool closing_is_linear(const JpWorld *world);

// Whether somebody reads the forces of one of these joints.
bool closing_is_read(const JpWorld *world);

// Takes from the bodies' velocities what would open the joints where the bodies are now, in a world
// that is linear and in which no forces act: positions stay. Leaves them as they are where there is
// no memory.
void closing_run(JpWorld *world, double step);
