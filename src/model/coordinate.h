// The coordinate of a joint that flanks or stops limit (Limits in model/linkage.h).
//
// Of a revolute joint the angle, rad, as linkage_turning has it; of a prismatic joint the position
// of body b's anchor along the line, m; of a pair of gears how far the pitch circle of body b has
// come round against that of body a where they touch, m; of a rack and pinion how far the pinion's
// pitch circle has come along the rack's pitch line, m. Angles count beyond a turn.
#pragma once

#include "base/mesh.h"
#include "model/joint_rows.h"

// The values between which the coordinate is free.
double coordinate_low(const Joint *joint);
double coordinate_high(const Joint *joint);

// Half of the gap between the ends; infinite of a stop without another, and between flanks without
// a gap, of which one presses at any time.
double coordinate_play(const Joint *joint);

double coordinate_position(const Linkage *linkage, const Motion *motions, int joint);

// Its rate, rad/s or m/s, in the bodies' velocities. That of teeth holds wherever the two bodies
// are.
double coordinate_rate(const Linkage *linkage, const Motion *motions, int joint);

// The sign with which the coordinate of a revolute joint follows the angle of body b less that of
// body a: -1 where b is the ground.
double coordinate_sense(const Joint *joint);

// A pair of gears with its tables.
Mesh coordinate_mesh(const Linkage *linkage, const Joint *joint);

// The flank of a pair of gears with a sign, 1 at the low end of the coordinate and -1 at the high
// one.
MeshFlank coordinate_flank(const Linkage *linkage, const Motion *motions, int joint, double sign);

// What the rate of the gap to an end is made of. A push there acts on the bodies with the same
// coefficients: on a hinge torques, between gears forces on the line of action where it meets that
// of the centres, and of a rack where the pinion's pitch circle is nearest.
void coordinate_row(const Linkage *linkage, const Motion *motions, int joint, double sign,
                    JointRow *row);
