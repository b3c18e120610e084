// What the contacts of a joint with play are like in its mechanism: with which mass they press, and
// how fast pin and wall come together.
#pragma once

#include "model/scenario.h"
#include "run/run.h"

// Joints with play that one mapping takes.
enum { MAPPING_JOINT_MAX = 24 };

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

// Whether a mapping takes all joints with play of a scenario; fails with ERR_SOLVER where there are
// too many.
bool mapping_joint_check(const Scenario *scenario, Err *err);

// Fills in the joints with play of a scenario, in their order, and their count, from a run of the
// reference, which the watch follows. Fails with ERR_SOLVER where the reference does, or where
// there are more than MAPPING_JOINT_MAX.
bool mapping_joint_measure(const Scenario *scenario, RunWatch watch,
                           MappingJoint joints[MAPPING_JOINT_MAX], size_t *count, Err *err);
