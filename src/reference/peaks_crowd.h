// The maxima of many contacts in one step, found together.
#pragma once

#include "model/solver.h"
#include "reference/stepper.h"

typedef struct PeaksCrowd {
    SystemState *scratch; // of the stepper's system, owned by whoever has the crowd
    JointTop *tops;       // by joint; owned, as are the arrays below
    JointState *joints;
    SpaceJointState *space_joints;
    double *forces; // N, by joint at the nodes of a curve
    double *depths; // m, likewise
} PeaksCrowd;

PeaksCrowd peaks_crowd_create(const System *system, SystemState *scratch);
void peaks_crowd_finish(PeaksCrowd *crowd);

// Writes the tops of all joints between two times of the present step, of which the state at the
// later one is given. Returns false where the accelerations are not determined in between.
bool peaks_crowd_find(PeaksCrowd *crowd, Stepper *stepper, double start_s, double end_s,
                      const SystemState *state);
