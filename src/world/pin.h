// A pin in its hole, as bodies of ODE's have it.
#pragma once

#include "world/play.h"

// Notes how its places are at a step's start.
void pin_start(JpJoint *joint);

// Finds its places where the step evaluates forces, with rows across the axis if asked for.
void pin_find(JpJoint *joint, bool has_rows);

// Where a place is now in its first rows as the step has found them, and how fast it goes there.
void pin_now(const JpJoint *joint, const Place *place, double at[2], double rate[2]);

// A pin that is made, that a step finds, and that a step has moved.
typedef enum PinMoment {
    PIN_MADE,
    PIN_FOUND,
    PIN_STEPPED,
} PinMoment;

// Fails with JP_ERROR_OUTSIDE where a pin is deeper in its wall or collar than it may be.
JpStatus pin_check_inside(const JpJoint *joint, PinMoment moment, JpError *error);
