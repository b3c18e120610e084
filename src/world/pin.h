// A pin in its hole, as bodies of ODE's have it.
#pragma once

#include "world/play.h"

// Notes how its places are at a step's start.
void pin_start(JpJoint *joint);

// Finds its places where the step evaluates forces, with rows across the axis if asked for.
void pin_find(JpJoint *joint, bool has_rows);
