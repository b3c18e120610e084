// The bodies, joints and forces of a case as lines of a C program against libjointplay.
#pragma once

#include "base/text.h"
#include "model/scenario.h"

// Appends the name in C of a body or joint: no keyword, and no other's.
void tune_world_body(const Linkage *linkage, int body, Text *text);
void tune_world_joint(const Linkage *linkage, int joint, Text *text);

// The number of a joint with play among those that have some.
size_t tune_world_number(const Linkage *linkage, int joint);

// Appends what makes an ideal joint of ODE; nothing of a joint that is none.
void tune_world_ideal(const Linkage *linkage, int joint, Text *text);

// Appends what makes a joint of the library of one with play; nothing of others. Fails with
// ERR_CASE where a law does not fit its joint.
bool tune_world_play(const Scenario *scenario, int joint, Text *text, Err *err);
