// Bushings: how far one is deflected, and what it does to its two bodies.
#pragma once

#include "model/linkage.h"

// Where a bushing stands, and how it is deflected: along its x and y axes, m, and by angle, rad.
typedef struct BushingPose {
    Vec2 axes[2];                    // unit, x and y, in the world
    Vec2 point;                      // m, of its anchor on body b, where it acts on both bodies
    double deflection[BUSHING_ROWS]; // of body b against body a
    double rate[BUSHING_ROWS];       // m/s and rad/s
} BushingPose;

BushingPose bushing_pose(const Bushing *bushing, const Motion *motions);

// The points of a row's pull; a curve without points where it is linear.
const ForceCurve *bushing_curve(const Bushing *bushing, size_t row);

// The coefficient of a row's damper, N s/m or N m s/rad; and whether it has any.
double bushing_damping(const Bushing *bushing, size_t row);
bool bushing_damps(const Bushing *bushing);

// What pulls a row back at its deflection, and what its damper does at its rate, N or N m on body
// a: on body b it is the negative of it.
double bushing_pull(const Bushing *bushing, const BushingPose *pose, size_t row);
double bushing_drag(const Bushing *bushing, const BushingPose *pose, size_t row);

// Energy that its springs hold, J, zero where it is relaxed; power that its dampers take, W.
double bushing_energy(const Bushing *bushing, const BushingPose *pose);
double bushing_power(const Bushing *bushing, const BushingPose *pose);
