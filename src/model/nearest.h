// The positions and speeds of a linkage's bodies that are nearest to given ones, weighed by mass
// and inertia, and keep its joints and its driver.
#pragma once

#include "model/linkage.h"

// Moves the bodies as little as puts each pin where it is to start in its hole, closes the ideal
// joints, and holds the driver at its start. False where that cannot all be.
bool nearest_positions(const Linkage *linkage, Motion *motions);

// The same with pins and blocks free to be anywhere.
bool nearest_ideal_positions(const Linkage *linkage, Motion *motions);

// Changes the speeds as little as keeps the ideal joints closed, with_play the others too, and
// follows the driver. Where it cannot be solved nothing changes.
void nearest_speeds(const Linkage *linkage, bool with_play, Motion *motions);

// A change of a body's speeds. The last three are 0 in the plane.
typedef struct SpeedChange {
    Vec2 velocity; // m/s, of the centre
    double omega;  // rad/s
    double velocity_z;
    double omega_x;
    double omega_y;
} SpeedChange;

// Alters changes of the bodies' speeds as little as keeps the ideal joints closed and the driver as
// it is. All are 0 where nothing is free.
void nearest_change(const Linkage *linkage, const Motion *motions, SpeedChange *changes);

// Whether the speeds keep the ideal joints closed and follow the driver, to 1e-9 of the largest.
// Else *joint is the number of the joint that opens fastest, with *distance in m/s, or -1 where it
// is the driver.
bool nearest_check(const Linkage *linkage, const Motion *motions, int *joint, double *distance);
