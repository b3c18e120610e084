// A linkage built in ODE: bodies, ideal joints, places of joints with play. Only what the plane
// needs.
#pragma once

#include "model/trajectory.h"
#include "ode/applied.h"
#include "ode/ends.h"
#include "ode/jobs.h"
#include "ode/pair.h"
#include "ode/plane/collider.h"
#include "ode/sliding.h"
#include "ode/snapshot.h"
#include "ode/world_hold.h"

#include <ode/ode.h>

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
} World;

// Builds the world of a scenario with its bodies in the motions given. Fails with ERR_SOLVER where
// joint rows would be redundant, or the collider cannot resolve a joint's play.
// The world must not be copied: ODE keeps pointers into it. It is to be finished after a failure
// too.
bool world_build(const Scenario *scenario, const Motion *motions, World *world, Err *err);

// A world without bodies: engine, gravity and everything that ODE would otherwise take from its own
// defaults.
void world_start(const Scenario *scenario, World *world);

// Destroys what was built; accepts a zeroed world.
void world_finish(World *world);

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

// Puts one body where a motion says, with its velocity.
void world_place(World *world, size_t body, const Motion *motion);

// The state of one body as the engine holds it.
Snapshot world_snapshot(const World *world, size_t body);

// The positions and velocities of all bodies; angles in one turn.
void world_motions(const World *world, Motion *motions);
