// What the joints of a linkage in space are at an instant, and what its drive does.
#pragma once

#include "contact/pin_space.h"
#include "model/space_response.h"
#include "model/trajectory.h"

// The joints of a linkage, both as the plane sees them and in space.
typedef struct SpaceJoints {
    JointState *plane; // by joint; owned, like the next one
    SpaceJointState *space;
} SpaceJoints;

SpaceJoints space_joints_create(const Linkage *linkage);
void space_joints_free(SpaceJoints *joints);

// Fills in where the pins are at the motions given: everything but the forces.
void space_joints_place(const SpaceResponse *response, const SpaceMotion *motions,
                        JointState *plane, SpaceJointState *space);

// The same of one joint.
void space_joints_place_one(const SpaceResponse *response, const SpaceMotion *motions, size_t joint,
                            SpaceJoints *joints);

// Takes all that is known of the joints away, or of one.
void space_joints_clear(const Linkage *linkage, SpaceJoints *joints);
void space_joints_clear_one(SpaceJoints *joints, size_t joint);

// Adds the force of a place on its joint's pin, N, friction included.
void space_joints_press(SpaceJoints *joints, const PinSpace *place, Vec3 force, Vec3 hole_axis);

// Puts the force on body b of an ideal joint, N.
void space_joints_hold(SpaceJoints *joints, size_t joint, Vec3 force);

// The force in the driven joint on the driven body, N, and the power of the drive, W, from the
// driven body's own equations: `others` is all that acts on that body, but for the drive and
// gravity.
double space_joints_drive(const Scenario *scenario, const SpaceMotion *driven,
                          const SpaceChange *others, Vec3 *force);
