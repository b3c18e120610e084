// What acts on the bodies beside joints, contacts and gravity, as a force and a moment on each:
// springs, bushings, loads, servos and steady friction, for every engine alike.
#pragma once

#include "drivers/common/driver.h"

// On a body: the force at its centre of mass, N, and the moment about it, N m.
typedef struct DriverAction {
    Vec2 force;
    double moment;
} DriverAction;

// Whether there is any of these.
bool actions_any(const DriverCase *of);

// Writes what these do with the bodies so; of what is over time the mean
// between two times, s, which may be equal.
void actions_find(const DriverCase *of, const DriverMotion *motions, double from_s, double to_s,
                  DriverAction *actions);

// Adds a force at a point of a body, in its frame; of the ground nothing.
void actions_add(const DriverMotion *motions, int body, Vec2 local, Vec2 force,
                 DriverAction *actions);
