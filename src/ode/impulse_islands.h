// The parts in which a step is handed on whose contacts were integrated by islands: those of the
// islands in order of time, and the end of the step of all.
#pragma once

#include "ode/impulse_part.h"
#include "ode/impulse_step.h"

typedef struct ImpulseIslands ImpulseIslands;

ImpulseIslands *impulse_islands_create(ImpulseStep *step);
void impulse_islands_destroy(ImpulseIslands *islands);

// Begins a step that has been taken.
void impulse_islands_begin(ImpulseIslands *islands, ImpulsePart *part);

// Whether the next part begins a new step.
bool impulse_islands_need_step(const ImpulseIslands *islands);

// What the last part was of.
const ImpulseScope *impulse_islands_scope(const ImpulseIslands *islands);

// Goes on to the next part, and fills in the record. What others than the island's bodies and
// joints do stays as it was at the last part that had them.
void impulse_islands_next(ImpulseIslands *islands, ImpulsePart *part, Motion *motions,
                          JointState *joints, double *depths);
