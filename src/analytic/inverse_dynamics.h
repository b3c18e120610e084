// The forces behind a known motion: drive torques and the reaction in every ideal joint.
#pragma once

#include "model/kinematics.h"

typedef struct Reactions {
    Vec2 force_on_b[KINEMATICS_JOINT_MAX];    // N, on body b of each joint, at its anchor there; on
                                              // body a its opposite at the same point
    double moment_on_b[KINEMATICS_JOINT_MAX]; // N m, likewise, of prismatic joints: the couple
    double drive_torques[LINKAGE_DRIVE_MAX];  // N m, of each drive on the body that it turns
} Reactions;

// The instant of the motions, for loads: and that from which on a load's piece holds, which is no
// later (model/loads.h).
typedef struct InverseTime {
    double time_s;
    double from_s;
} InverseTime;

// Solves the Newton-Euler equations of every body for the reactions. The motions hold position,
// velocity and acceleration; every joint counts as ideal; gravity acts, m/s^2, beside the
// linkage's springs, dampers and loads.
// Fails with ERR_SOLVER where the reactions are not determined, or the mechanism is not small
// (model/kinematics.h).
bool inverse_dynamics_solve(const Linkage *linkage, const Motion *motions, Vec2 gravity,
                            InverseTime time, Reactions *reactions, Err *err);

// Rate of change of the kinetic and potential energy of all bodies less the power of springs,
// dampers and loads, W. In a linkage with ideal joints it equals drive torque times crank speed.
double inverse_dynamics_power(const Linkage *linkage, const Motion *motions, Vec2 gravity,
                              InverseTime time);
