// From the sizes of a four-bar, or from bodies and joints placed in the world, to a linkage that
// stands at its start.
#pragma once

#include "casefile/entries.h"

// Sets the bodies, joints' anchors, driver and traced points of a four-bar, and finds the motions
// at time zero. Expects names, lengths, masses, clearances, joint kinds, drive (present) and points
// in it (points still measured along the link from its first joint). Fails with
// ERR_SOLVER where the linkage cannot be solved at the start.
bool build_fourbar(Scenario *scenario, Err *err);

// Joins two bodies at points of their frames.
void build_place_joint(Joint *joint, int body_a, Vec2 anchor_a, int body_b, Vec2 anchor_b);

// Whether there is a drive and as many joints as make every body follow from it.
bool build_is_determined(const Linkage *linkage);

// Sets the start of every body of such a linkage from motions that are near it: the motions of
// ideal joints, or where a pin starts off its hole's centre, those of a pin held there at rest in
// its hole. Fails as kinematics_solve does.
bool build_start(Linkage *linkage, Motion *motions, Err *err);

// The same of a linkage in space whose axes are not all z: every joint is closed and concentric
// where it stands.
bool build_spatial(const Entries *entries, Scenario *scenario, Err *err);

// Places springs and loads of a short form, whose bodies are at their start. True always.
bool build_forces(const Entries *entries, Scenario *scenario);

// Turns the positions of the joints, which stand in anchor_a, into anchors of their bodies, puts
// pins where they start, and finds or checks the speeds at time zero. Fails with ERR_CASE or
// ERR_USAGE and a line of the case where joints are redundant or speeds do not agree, and with
// ERR_SOLVER where the linkage cannot be solved at the start.
bool build_linkage(const Entries *entries, Scenario *scenario, Err *err);
