// What acts on the bodies of a linkage beside gravity, joints and contacts: springs, bushings,
// dampers and the torque of a drive.
#pragma once

#include "model/bushing.h"
#include "model/gap_damping.h"

// Force on a body at its centre of mass, N, and moment about it, N m.
typedef struct BodyLoad {
    Vec2 force;
    double moment;
} BodyLoad;

// Whether anything of the kind acts; and whether any of it is a damper.
bool forces_any(const Linkage *linkage);
bool forces_damp(const Linkage *linkage);

// A spring's line at the motions given.
typedef struct SpringLine {
    Vec2 ends[2];    // m, on body a and on body b
    Vec2 direction;  // unit, from the first to the second; zero where they coincide
    double distance; // m
    double rate;     // m/s, of the distance
} SpringLine;

SpringLine forces_line(const Spring *spring, const Motion *motions);

// The angle of a joint, rad, and its rate, rad/s; see linkage_turning.
typedef struct JointTurn {
    double angle;
    double rate;
} JointTurn;

JointTurn forces_turn(const Linkage *linkage, int joint, const Motion *motions);

// Whether a joint's coordinate is the way along a line; else it is an angle. Where it stands, rad
// or m, and its rate.
bool forces_is_along_line(const Linkage *linkage, int joint);
JointTurn forces_coordinate(const Linkage *linkage, int joint, const Motion *motions);

// The same of the joint of the drive's torque.
JointTurn forces_drive_turn(const Linkage *linkage, const Motion *motions);
double forces_drive_rate(const Linkage *linkage, const Motion *motions);

// Add the loads, by body, of all springs and what bushings pull, all dampers, and a torque, N m, at
// the drive's joint (a force, N, along its line).
void forces_add_springs(const Linkage *linkage, const Motion *motions, BodyLoad *loads);
void forces_add_dampers(const Linkage *linkage, const Motion *motions, BodyLoad *loads);
void forces_add_torque(const Linkage *linkage, const Motion *motions, double torque,
                       BodyLoad *loads);

// Adds a force, N, at a point of a body, in the world; of the ground nothing.
void forces_add_at(int body, Vec2 point, Vec2 force, const Motion *motions, BodyLoad *loads);

// Adds a force, N, or torque, N m, along a joint's coordinate.
void forces_add_along(const Linkage *linkage, int joint, double value, const Motion *motions,
                      BodyLoad *loads);

// What a soft drive adds to its table at a time, N m, but for what the rate takes; and all that the
// drive's torque is then.
double forces_followed(const Linkage *linkage, const Motion *motions, double time_s);
double forces_drive_torque(const Linkage *linkage, const Motion *motions, double time_s);

// The same of a soft drive before its limit, N m, and what the limit leaves of that.
double forces_drive_unlimited(const Linkage *linkage, const Motion *motions, double time_s);
double forces_within_limit(const Torque *torque, double unlimited);

// Add the load of one damper that pulls along a spring's line with a tension, N.
void forces_add_tension(const Spring *spring, const SpringLine *line, const Motion *motions,
                        double tension, BodyLoad *loads);

// Add what a row of a bushing pulls with, N or N m: on body a, and the other way on body b.
void forces_add_row(const Bushing *bushing, const BushingPose *pose, size_t row, double pull,
                    const Motion *motions, BodyLoad *loads);

// Add what a damper in a joint's gap drags with, N or N m, against its row's rate.
void forces_add_drag(const Joint *joint, const GapDampingRow *row, double drag, BodyLoad *loads);

// Add a moment, N m, that a joint's turned body gets and the other one gives.
void forces_add_moment(const Linkage *linkage, int joint, double moment, BodyLoad *loads);

// Writes the loads of everything of the kind at a time; loads from outside are in model/loads.h.
void forces_loads(const Linkage *linkage, const Motion *motions, double time_s, BodyLoad *loads);

// Energy stored in springs and bushings, J; power that the dampers take, not those of a motor or a
// soft drive, and that the drive's torque gives at a time, W; power of a load on a body, W.
double forces_energy(const Linkage *linkage, const Motion *motions);
double forces_damping_power(const Linkage *linkage, const Motion *motions);
double forces_torque_power(const Linkage *linkage, const Motion *motions, double time_s);
double forces_load_power(const BodyLoad *load, const Motion *motion);
