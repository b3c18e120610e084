// The maxima of the force and the depth of a contact within a step.
#pragma once

#include "model/solver.h"
#include "reference/stepper.h"

// The maxima of many contacts in one step, found together.
typedef struct PeaksBatch {
    SystemState *scratch; // of the stepper's system, owned by whoever has the batch
    JointPeak *peaks;     // by joint; owned, as are the arrays below
    JointState *joints;
    SpaceJointState *space_joints;
    double *forces; // N, by joint at the nodes of a curve
    double *depths; // m, likewise
} PeaksBatch;

// One quantity of a contact where it was left, and where it is now.
typedef struct Peak {
    bool was_rising;
    double last;
    double largest; // since the contact began, at the times evaluated
    double rate;
    double value;
    bool is_sought;  // since it was left
    double passes_s; // when it has a maximum then, s; INFINITY: it has none
} Peak;

// Force and depth of each contact.
typedef struct Peaks {
    SystemState *scratch; // of the stepper's system, owned by whoever has the peaks
    Peak *peaks;          // owned: two a contact, of its force and of its depth
    PeaksBatch batch;     // for more of them than are worth a part of the step each
    bool has_peaks;       // whether the last part is one that the batch has evaluated
} Peaks;

Peaks peaks_create(const System *system, SystemState *scratch);
void peaks_finish(Peaks *peaks);

// The earliest maximum of a pressing contact's force or depth between two times of the present
// step, or the later of them. The state is that at the later time. Where many contacts have one, it
// is the later time, and the batch's peaks say when.
double peaks_next(Peaks *peaks, Stepper *stepper, double start_s, double end_s,
                  const SystemState *state);
