// What is looked at of a step with contacts integrated inside it, and when, in the plane and in
// space.
#pragma once

#include "kernel/kernel.h"
#include "model/response_groups.h"

// places up to which all are integrated together: what islands save they cost as well
enum { IMPULSE_FEW_PLACES = 16 };

// Bodies, joints and places; all, or those of one island.
typedef struct ImpulseScope {
    bool is_whole;
    bool has_drive; // whether the driven body is among the bodies
    size_t body_count;
    size_t *bodies; // owned, as are all arrays
    size_t joint_count;
    size_t *joints;
    size_t place_count; // of those below, the first, that are looked at
    ResponsePart part;  // the places; of an island also others of the groups of bodies that they
                        // move, and these groups
} ImpulseScope;

// A time within a step.
typedef struct ImpulseTime {
    double since_s; // since the step's start
    size_t node;    // of the kernel; islands have been looked at then
    bool is_peak;   // whether accelerations are worked out where the bodies are, not at mid-step
} ImpulseTime;

// All bodies, joints and places of a linkage.
ImpulseScope impulse_scope_whole(const Linkage *linkage, size_t place_count);
void impulse_scope_finish(ImpulseScope *scope);

// How a place is at a time within the step, from the sums then: by its island, or where the islands
// are NULL by the kernel of all.
KernelPose impulse_scope_pose(const Kernel *kernel, const KernelIslands *islands, size_t place,
                              ImpulseTime at, const KernelSums *sums);
