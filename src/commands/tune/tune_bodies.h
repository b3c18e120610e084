// The bodies of a case in programs against libjointplay.
#pragma once

#include "base/text.h"
#include "model/linkage.h"

// Append the name in C of a body, NULL for the ground, or of a joint: no keyword, and no other's.
void tune_bodies_name(const Linkage *linkage, int body, Text *text);
void tune_bodies_joint_name(const Linkage *linkage, int joint, Text *text);

// Whether a body is driven at constant speed: it is one of ODE's without dynamics, whose origin is
// the pivot about which it turns, so that it stays exactly on its path. And a point of a body where
// its origin is.
bool tune_bodies_is_led(const Linkage *linkage, int body);
Vec2 tune_bodies_local(const Linkage *linkage, int body, Vec2 local);

// kg, of what moves on the bristle of a pin's friction, where it is not what the library takes: a
// body that is driven by a motor has dynamics there. 0 where it is that.
double tune_bodies_bristle_mass(const Linkage *linkage, const Joint *joint);
