// The parts in which a step is handed on whose contacts were integrated by islands: those of the
// islands in order of time, and the end of the step of all. In the plane and in space.
#pragma once

#include "kernel/kernel.h"
#include "ode/impulse_part.h"
#include "ode/impulse_scope.h"

typedef struct ImpulseIslands ImpulseIslands;

// A step that has been taken.
typedef struct ImpulseSpan {
    double start_s;
    double end_s;
    double width_s;
    double drive_work; // J
    double damped;     // J, in dampers
} ImpulseSpan;

// What the islands are of. It is kept as it is given.
typedef struct ImpulseIslandsOf {
    const Linkage *linkage;
    KernelIslands *islands;
    const ResponseGroups *groups;
    const ImpulseScope *whole;
    const bool *counts;       // by place: whether it is a contact of its joint; NULL: all
    const double *depths;     // m, by place, at the time that was looked at last
    const JointState *joints; // likewise
    const SpaceJointState *space_joints; // NULL in the plane
    void *context;                       // of the next three
    ImpulseSpan (*span)(const void *context);
    // looks at a scope, from the contacts' sums up to then: joints, depths, how the bodies turn
    void (*inside)(void *context, const ImpulseScope *scope, ImpulseTime at,
                   const KernelSums *sums);
    double (*mean)(const void *context, size_t joint); // N: mean force of an ideal joint
} ImpulseIslandsOf;

ImpulseIslands *impulse_islands_create(const ImpulseIslandsOf *of);
void impulse_islands_destroy(ImpulseIslands *islands);

// Begins a step that has been taken.
void impulse_islands_begin(ImpulseIslands *islands, ImpulsePart *part);

// Whether the next part begins a new step.
bool impulse_islands_need_step(const ImpulseIslands *islands);

// What the last part was of.
const ImpulseScope *impulse_islands_scope(const ImpulseIslands *islands);

// Goes on to the next part, and fills in the record. What others than the island's bodies and
// joints do stays as it was at the last part that had them.
void impulse_islands_next(ImpulseIslands *islands, ImpulsePart *part);
