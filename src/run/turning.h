// How far each body has turned, added up from the steps: enough to know which turn an angle is in.
#pragma once

#include "model/solver.h"

typedef struct Turning {
    const Linkage *linkage;
    double *told_s; // by body, the end of its last record; owned, like the next two
    double *angle;  // rad, there
    double *omega;  // rad/s, there
} Turning;

// The bodies where they are at time zero.
Turning turning_start(const Linkage *linkage);
void turning_finish(Turning *turning);

void turning_add(Turning *turning, const StepRecord *record);

// Puts the angles of a part of a sample (NULL: of all of it), known but for whole turns, into the
// turn that the bodies are in.
void turning_unwrap(const Turning *turning, const SolverPart *part, Sample *sample);
