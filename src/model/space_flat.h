// A linkage in space that never leaves the plane: which one that is, and the same in the plane.
//
// Two things keep it there. Bodies that hang by hinges along z on the ground or on the driven body
// can move in no other way, whatever their masses and loads. Of the others the motion is that of
// its mirror image in the plane: what they are, how they start and where they touch is the same on
// both sides of it.
#pragma once

#include "model/trajectory.h"

// Whether the bodies of a linkage in space move in the plane alone, from the start given on, tilted
// and lifted by nothing: exactly, and not to rounding. Not where ideal joints close loops.
bool space_flat_is(const Scenario *scenario);

// The same scenario in the plane. For scenario_free.
Scenario space_flat_scenario(const Scenario *scenario);

// A motion of a body and the state of a joint in the plane as they are in space: the two ends of a
// pin have half of what the plane's presses with, at the same gap; its tilt and its way along the
// axis are nothing.
SpaceMotion space_flat_motion(const Body *body, const Motion *planar);
SpaceJointState space_flat_joint(const Joint *joint, const JointState *planar);
