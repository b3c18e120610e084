// What turns the driven body, and what joints turn theirs by, from the samples of a run.
#pragma once

#include "model/trajectory.h"

// The moment about the anchor of body b, N m, that comes with a joint's force on body b: of what
// slides, of limits and of teeth, and of friction at the wall of a hole or stop. In the plane.
double joint_moment(const Linkage *linkage, const Motion *motions, size_t joint,
                    const JointState *state);

// Whether the motion of a body is prescribed by a torque at a pivot, in the plane.
bool drive_torque_exists(const Linkage *linkage);

// How many there are: of several drives one each, that of a torque is none of them.
size_t drive_torque_count(const Linkage *linkage);

// That torque where bodies move and joints stand so at a time, s: as below.
double drive_torque_of(const Scenario *scenario, const Motion *motions, const JointState *states,
                       double time_s, size_t drive);

// That torque at a sample, N m, counter-clockwise on the body of a drive (linkage_drive; of a
// torque the only one): what Euler's law of the body leaves when joints, springs and dampers have
// their share.
double drive_torque_at(const Scenario *scenario, const Trajectory *run, size_t drive,
                       size_t sample);
