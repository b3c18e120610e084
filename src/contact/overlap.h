// What a contact does in the part of a step in which it overlaps, where positions stand at
// mid-step.
#pragma once

#include "kernel/force_law.h"

// How much of a step a contact is overlapped in.
typedef struct Overlap {
    double depth; // m, that gives the mean force of the step; 0 where it does not overlap
    double share; // of the step
    double onset; // s, from the step's start to where it begins, where that is in the step
} Overlap;

// From the gap at mid-step, m, negative inside, and the closing speed at the step's start, m/s.
Overlap overlap_find(const ForceLaw *law, double gap, double closing, double step_s);

// From the gaps at mid-step and at the step's ends, between which it goes one way.
Overlap overlap_between(const ForceLaw *law, double gap, const double gaps[2], double step_s);
