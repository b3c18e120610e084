// A place at which a joint with play touches, in ODE's world, or an end of a limited coordinate.
// The bodies' positions say all, exactly, of two circles as well; collider pin-hole is that. Any
// other collider is asked of a pin in its hole, about two geoms: a hole on one body, a cylinder on
// the other.
#pragma once

#include "contact/touch.h"
#include "ode/ends.h"
#include "ode/plane/collider.h"

typedef struct WorldPair {
    int joint;         // number in the linkage
    Touch touch;       // the place, without its law
    Vec2 line;         // unit, of a TOUCH_LINE: its normal in body a's frame
    bool is_corner;    // one of several places of its joint: of a block, or the next
    bool is_end;       // of a limited coordinate: nothing slides there
    Vec2 beside[2];    // m, from the joint's anchors to the place's, in their bodies' frames
    dBodyID bodies[2]; // a and b; NULL: the ground
    dGeomID hole;      // of a TOUCH_HOLE that a collider is asked about, else NULL, as the next two
    dGeomID pin;
    void *collision; // what the world's collider keeps of the joint; owned
    WorldEnds *ends; // of a TOUCH_TURN or TOUCH_TEETH, else NULL: the world's
    dJointID row;    // of a TOUCH_TURN, else NULL
} WorldPair;

// Makes the place between two bodies. Fails with ERR_SOLVER where the collider cannot see such
// contacts; the pair is to be finished then too.
bool pair_make(const Scenario *scenario, const Touch *touch, const dBodyID bodies[2],
               const Collider *collider, WorldPair *pair, Err *err);

// Makes the place at an end of a limited coordinate.
void pair_make_end(const Scenario *scenario, const Touch *touch, const dBodyID bodies[2],
                   dWorldID world, WorldEnds *ends, WorldPair *pair);
void pair_finish(const Collider *collider, WorldPair *pair);

// How the place is, and how it moves. Of a hole the two circles, whatever the collider takes it
// for.
TouchPose pair_pose(const WorldPair *pair);

// The centre of a hole, and the anchor on body b of a hole or disc, m, in the world.
Vec2 pair_centre(const WorldPair *pair);
Vec2 pair_anchor_b(const WorldPair *pair);

// The point, m, in the world, at which a force along a normal acts.
Vec2 pair_point(const WorldPair *pair, Vec2 normal);

// Of a place that touches: from the joint's anchors on bodies a and b to where the joint's force is
// said to act, m: where the bodies touch, or of a block at the joint's anchor on body b. The lever
// is from there to the corner, zero of any other joint.
void pair_arms(const WorldPair *pair, const TouchPose *pose, Vec2 arms[2], Vec2 *lever);

// How fast body b's point there moves against body a's, m/s.
Vec2 pair_velocity(const WorldPair *pair, Vec2 point);
