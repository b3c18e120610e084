// Scenarios of random cases, for measurements that run them in their own process.
#pragma once

#include "random_case.h"

#include "model/trajectory.h"

// Loads the case of a kind and a seed with settings, as --set takes them.
bool random_scenario(const CaseKind *kind, uint64_t seed, const char *const *settings, size_t count,
                     Scenario *scenario, Err *err);

// The same mechanism elsewhere, for a reference that is to judge: its coordinates are other
// numbers, and so is their rounding. The tolerance is the reference's.
Scenario moved_scenario(const Scenario *scenario, double tolerance);

// Takes the bodies of its run to where those of the mechanism itself are: the velocity of a pin in
// a hole of the ground is told by where it is.
void move_back(Trajectory *moved);

// The largest distance of a run from its judge at the samples up to a time, s, in the rates and
// scales of a third trajectory (model/distance.h): past the horizon the judge may move faster.
double apart_until(const Trajectory *run, const Trajectory *judge, const Trajectory *scale,
                   double until_s);
