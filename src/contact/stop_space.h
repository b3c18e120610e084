// The ends of the limited angle of a hinge in space, as places of contact: a row of the angle each,
// and one that nothing moves, so that they have two like an end of a pin
// (contact/pin_space_rows.h).
#pragma once

#include "kernel/force_law.h"
#include "model/scenario.h"
#include "model/space_coordinate.h"

typedef struct StopSpace {
    int joint;
    double sign;  // 1 at the low end, -1 at the high one
    double limit; // rad, of the angle there
    ForceLaw law;
} StopSpace;

// Lists the ends of all limited joints, joint by joint, and how many there are. Returns them for
// the caller to free, or NULL with ERR_CASE where a law does not fit a joint.
StopSpace *stop_space_list(const Scenario *scenario, size_t *count, Err *err);

// Which of its joint's places it is: 0 the low end, 1 the high one.
static inline int stop_space_place(const StopSpace *stop)
{
    return stop->sign > 0.0 ? 0 : 1;
}

// The gap, rad, at an angle.
static inline double stop_space_gap(const StopSpace *stop, double angle)
{
    return stop->sign * (angle - stop->limit);
}

// The row in which the gap opens, in the bodies' velocities.
SpaceRow stop_space_row(const StopSpace *stop, const Linkage *linkage, const SpaceMotion *motions);

// How fast the rate of that row changes under the accelerations of motions.
double stop_space_drift(const StopSpace *stop, const Linkage *linkage, const SpaceMotion *motions);
