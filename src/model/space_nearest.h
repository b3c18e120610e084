// The speeds of a linkage's bodies in space that are nearest to given ones, weighed by mass and
// inertia, and keep its joints and its driver; see model/nearest.h for the plane.
#pragma once

#include "model/nearest.h"
#include "model/space_rows.h"

// Changes the speeds as little as keeps the ideal joints closed, with_play the others too as if
// they were ideal, and follows the driver.
void space_nearest_speeds(const Linkage *linkage, bool with_play, SpaceMotion *motions);

// Alters changes of the speeds at the start as little as keeps the ideal joints closed and the
// driver as it is.
void space_nearest_change(const Linkage *linkage, SpeedChange *changes);

// Whether the ideal joints keep closed at these speeds and the driven body follows the driver, to
// 1e-9 of the largest. Else *joint is the number of the joint that opens fastest, or -1 where it is
// the driver.
bool space_nearest_check(const Linkage *linkage, const SpaceMotion *motions, int *joint);
