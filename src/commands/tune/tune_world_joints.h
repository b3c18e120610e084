// The bodies, joints and forces of a case as lines of a C program against libjointplay.
#pragma once

#include "base/text.h"
#include "model/scenario.h"

// Appends the name in C of a body or joint: no keyword, and no other's.
void tune_world_body(const Linkage *linkage, int body, Text *text);
void tune_world_joint(const Linkage *linkage, int joint, Text *text);

// The number of a joint with play among those that have some.
size_t tune_world_number(const Linkage *linkage, int joint);

// Whether a joint is one of ODE's in the program.
bool tune_world_is_ideal(const Linkage *linkage, int joint);

// Whether a body is driven at constant speed: it is one of ODE's without dynamics, whose origin is
// the pivot about which it turns, so that it stays exactly on its path. And a point of a body where
// its origin is.
bool tune_world_is_led(const Linkage *linkage, int body);
Vec2 tune_world_local(const Linkage *linkage, int body, Vec2 local);

// Appends what makes an ideal joint of ODE; nothing of a joint that is none, or that a body that is
// led turns about.
void tune_world_ideal(const Linkage *linkage, int joint, Text *text);

// Appends what makes a joint of the library of one with play; nothing of others. Fails with
// ERR_CASE where a law does not fit its joint.
bool tune_world_play(const Scenario *scenario, int joint, Text *text, Err *err);
