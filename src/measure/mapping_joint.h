// What the contacts of a joint with play are like in its mechanism: with which mass they press, and
// how fast pin and wall come together.
#pragma once

#include "model/scenario.h"
#include "run/run.h"

typedef struct MappingJoint {
    int joint;              // number in the linkage
    double mass_least;      // kg, effective along the normal, over the run and all directions
    double mass_median;     //
    double mass_most;       //
    size_t onsets;          // contacts begun at a closing speed above 0
    double speed_median;    // m/s, closing, over these; 0 where there are none
    double speed_most;      //
    double penetration_max; // m, of the run
    double force_max;       // N, likewise
} MappingJoint;

// The joints with play of a scenario, in their order, and their count, from a run of the reference,
// which the watch follows. The caller frees them. Fails with ERR_SOLVER where the reference does.
bool mapping_joint_measure(const Scenario *scenario, RunWatch watch, MappingJoint **joints,
                           size_t *count, Err *err);

// The same joints, of which nothing is known but their numbers.
MappingJoint *mapping_joint_list(const Scenario *scenario, size_t *count);
