// Where regularized friction decides: a joint that is loaded and slides more slowly than friction
// sets in is not held, but creeps.
#pragma once

#include "model/trajectory.h"

// The share of the samples in which a joint with play touches, in which it slides nowhere faster
// than its friction sets in. NAN of a joint whose friction is none or holds, that never touches, or
// in space.
double creep_share(const Scenario *scenario, const Trajectory *run, size_t joint);

// The joint that creeps most, of a share of which a reader is to know, which is written; -1: none
// does.
int creep_worst(const Scenario *scenario, const Trajectory *run, double *most);
