// A linkage built in ODE: bodies, ideal joints, contact points of joints with play. Only what the
// plane needs.
#pragma once

#include "base/vec2.h"
#include "contact/touch.h"
#include "model/trajectory.h"
#include "ode/jobs.h"
#include "ode/plane/applied.h"
#include "ode/plane/collider.h"
#include "ode/plane/rubbing.h"
#include "ode/plane/world_hold.h"

#include <ode/ode.h>

// How ODE holds a body that moves in the plane, cheap enough to be read in every step.
typedef struct Snapshot {
    Vec2 position;  // m
    Vec2 direction; // unit: where the body's x axis points
    Vec2 velocity;  // m/s
    double omega;   // rad/s
} Snapshot;

// The state of a body; NULL is the ground.
static inline Snapshot snapshot_of(dBodyID body)
{
    if (body == NULL) {
        return (Snapshot){.direction = {1.0, 0.0}};
    }
    const dReal *position = dBodyGetPosition(body);
    const dReal *rotation = dBodyGetRotation(body);
    const dReal *velocity = dBodyGetLinearVel(body);
    return (Snapshot){
        .position = {position[0], position[1]},
        .direction = {rotation[0], rotation[4]},
        .velocity = {velocity[0], velocity[1]},
        .omega = dBodyGetAngularVel(body)[2],
    };
}

// A vector given in the body's frame, in the world's.
static inline Vec2 snapshot_turn(const Snapshot *body, Vec2 local)
{
    const Vec2 x = body->direction;
    return (Vec2){x.x * local.x - x.y * local.y, x.y * local.x + x.x * local.y};
}

// The velocity of the body's point that is at an arm from its centre, m, in the world's frame.
static inline Vec2 snapshot_velocity(const Snapshot *body, Vec2 arm)
{
    return vec2_add(body->velocity, vec2_scale(body->omega, vec2_perp(arm)));
}

// A prismatic joint, and the limited angles and teeth, as ode/plane/world.c keeps them.
typedef struct Sliding Sliding;
typedef struct WorldEnds WorldEnds;

// A place at which a joint with play touches, in ODE's world, or an end of a limited coordinate.
// The bodies' positions say all, exactly, of two circles as well; collider pin-hole is that. Any
// other collider is asked of a pin in its hole, about two geoms: a hole on one body, a cylinder on
// the other.
typedef struct WorldPair {
    int joint;      // number in the linkage
    Touch touch;    // the place, without its law
    Vec2 line;      // unit, in body a's frame: of a line its normal, of a cam where its profile's
                    // angles count from
    Vec2 facing;    // unit, in body b's frame: of a flat on a cam
    bool is_corner; // one of several places of its joint: of a block, or the next
    bool is_end;    // of a limited coordinate: nothing slides there
    Vec2 beside[2]; // m, from the joint's anchors to the place's, in their bodies' frames
    dBodyID bodies[2]; // a and b; NULL: the ground
    dGeomID hole;      // of a TOUCH_HOLE that a collider is asked about, else NULL, as the next two
    dGeomID pin;
    void *collision; // what the world's collider keeps of the joint; owned
    WorldEnds *ends; // of an angle, teeth or a rack, else NULL: the world's
    dJointID row;    // of a TOUCH_TURN, else NULL
} WorldPair;

typedef struct World {
    const Linkage *linkage;
    dWorldID id;
    Jobs *jobs;               // of its steps; owned
    dBodyID *bodies;          // owned, as are all arrays here
    dJointFeedback *feedback; // of the revolute joints, by joint
    size_t sliding_count;
    Sliding *sliding;         // the prismatic joints
    const Collider *collider; // of all pairs
    size_t pair_count;
    WorldPair *pairs;       // in the order of touch_list
    WorldEnds *ends;        // of limited angles and teeth; NULL: there are none
    WorldHold *hold;        // of the ideal joints where they have no rows in ODE; else NULL
    size_t constraint_rows; // scalar rows of the ideal joints, all independent
    Applied applied;        // springs, dampers, torque
    Rubbing rubbing;        // friction of ideal pivots
} World;

// ODE's body of a body of the linkage; 0 for the ground.
static inline dBodyID world_body(const World *world, int body)
{
    return body == LINKAGE_GROUND ? 0 : world->bodies[body];
}

// Builds the world of a scenario with its bodies in the motions given. Fails with ERR_SOLVER where
// joint rows would be redundant, or the collider cannot resolve a joint's play.
// The world must not be copied: ODE keeps pointers into it. It is to be finished after a failure
// too.
bool world_build(const Scenario *scenario, const Motion *motions, World *world, Err *err);

// Counts the ideal joints' rows in the plane and makes sure that none follows from the others;
// fails with ERR_SOLVER where one does.
bool world_rows_check(const Scenario *scenario, const Motion *motions, size_t *row_count, Err *err);

// A world without bodies: engine, gravity and everything that ODE would otherwise take from its own
// defaults.
void world_start(const Scenario *scenario, World *world);

// Destroys what was built; accepts a zeroed world.
void world_finish(World *world);

// Carries where the bodies are and how they move.
void world_carry(World *world, Carry *carry);

// Takes one step of the world, by ODE's direct or its quick solver. Fails as engine_step does.
bool world_step(World *world, double step_s, bool is_quick, Err *err);

// Fills in, by joint, how far from the anchor on a body the forces of the prismatic joints acted in
// the last step, m: at the anchor on their body b. Other joints are left alone.
void world_offsets(const World *world, int body, Vec2 *offsets);

// Fails with ERR_SOLVER where a velocity is not finite or a body has left the plane, which is kept
// only as long as nothing ever leaves it.
bool world_check(const World *world, Err *err);

// Fills in the forces of the ideal joints, and the couples of the prismatic ones, in the last step;
// the driven one apart.
void world_joint_forces(const World *world, JointState *joints);

// Puts one body where a motion says, with its velocity; in space at its height.
void world_place(World *world, size_t body, const Motion *motion);

// Puts the driven bodies to a time with their speeds at another, of steps forwards (1) or backwards
// (-1) in time.
void world_place_driven(World *world, double placed_s, double speed_s, long direction);

// The state of one body as the engine holds it.
Snapshot world_snapshot(const World *world, size_t body);

// The positions and velocities of all bodies; angles in one turn.
void world_motions(const World *world, Motion *motions);

// An angle of a body that is known in one turn, with the turns it has made; without limited angles
// and teeth, or of other bodies than theirs, the angle as it is.
double world_count_turns(const World *world, size_t body, double angle);

// How the place is, and how it moves. Of a hole the two circles, whatever the collider takes it
// for.
TouchPose pair_pose(const WorldPair *pair);

// The centre of a hole, and the anchor on body b of a hole or disc, m, in the world.
Vec2 pair_centre(const WorldPair *pair);
Vec2 pair_anchor_b(const WorldPair *pair);

// What a unit along a normal is in the first two rows of the response at the place.
Vec2 pair_in_rows(const WorldPair *pair, Vec2 normal);

// The point, m, in the world, at which a force along a normal acts.
Vec2 pair_point(const WorldPair *pair, Vec2 normal);

// Of a place that touches: from the joint's anchors on bodies a and b to where the joint's force is
// said to act, m: where the bodies touch, or of a block at the joint's anchor on body b. The lever
// is from there to the corner, zero of any other joint.
void pair_arms(const WorldPair *pair, const TouchPose *pose, Vec2 arms[2], Vec2 *lever);

// How fast body b's point there moves against body a's, m/s.
Vec2 pair_velocity(const WorldPair *pair, Vec2 point);
