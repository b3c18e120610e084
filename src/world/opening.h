// How far ODE's joints are open, and what that moves.
#pragma once

#include "world/closing.h"
#include "world/play.h"

// In a world whose steps have a new length, opens its joints as far as they stay open at that
// length; bodies are at mid-step, as they were kept. Does nothing where trials cannot be made.
JpStatus opening_settle(JpWorld *world, double step, JpError *error);

// Finds what the joints are open by, beside a step whose speeds of all bodies, six each, are given.
JpStatus opening_find(JpWorld *world, double step, const double *speeds, JpError *error);

// By how much bodies were off in a direction at the start of the step for that.
double opening_shift(const JpWorld *world, const Direction *direction);

// Opens joints that were closed at the step's start, and held so in a step that gave speeds, as far
// as they are open in steps with the ERP that they have else; the speeds stay.
JpStatus opening_open(JpWorld *world, Closing *closing, double step, const double *speeds,
                      JpError *error);
