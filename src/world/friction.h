// The friction of a hinge or slider of ODE: what moves it in a step.
#pragma once

#include "world/play.h"

// Before a step of a length, s, the bodies kept where forces are evaluated, with the speeds of the
// step's start: makes the rows of all joints with friction, and pushes the bodies beside them,
// which is kept, too. What presses in the first step is tried. Fails where ODE has no memory.
JpStatus friction_push(JpWorld *world, double step, JpError *error);

// The row of a joint with friction does nothing until the next step.
void friction_rest(JpJoint *joint);

// After it, the bodies having the speeds of its end: reads what friction was, and what pressed.
void friction_book(JpWorld *world, double step);
