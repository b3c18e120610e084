// How the drive turns its body about its joint with the ground: at constant speed, or at a speed
// over time, which may repeat in periods of whole turns. The speed is then linear between the
// points of its table, so that the angle is a parabola and the angular acceleration constant; it
// jumps at the points, the kinks of the speed.
#pragma once

#include "model/time_table.h"

#include <stdbool.h>

typedef struct Driver {
    bool is_present;
    int joint;        // number of the driven joint, which is ideal; its body_a is the ground
    double speed;     // rad/s, counter-clockwise positive; of a speed over time the largest in size
    double start;     // angle of the driven body at time zero, rad
    TimeTable speeds; // rad/s, the speed over time; without points it is constant
} Driver;

// The driven body's angle, not wrapped, and its rates.
typedef struct DriveState {
    double angle; // rad
    double omega; // rad/s
    double alpha; // rad/s^2; at a kink that after it
} DriveState;

DriveState drive_at(const Driver *driver, double time_s);

// The same with the acceleration that holds from a time on, which is no later: at a kink or beyond
// it that before it.
DriveState drive_since(const Driver *driver, double from_s, double time_s);

// The angle alone, and to more digits.
double drive_angle(const Driver *driver, double time_s);
long double drive_angle_exact(const Driver *driver, long double time_s);

// The first kink after a time, s; INFINITY where there is none.
double drive_next_kink(const Driver *driver, double time_s);

// How far the driven body turns from its start up to a time, rad: the most to each side, `back` at
// most 0 and `forth` at least 0.
typedef struct DriveExtent {
    double back;
    double forth;
} DriveExtent;

DriveExtent drive_extent(const Driver *driver, double to_s);

// Whether there is a drive and its speed is constant: then it has revolutions and a period.
bool drive_is_steady(const Driver *driver);

// Takes Driver.speed from the table, where there is one: after a change of it.
void drive_take_largest(Driver *driver);
