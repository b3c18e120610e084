// The ranges of a run, gathered step by step where its trajectory has room for them.
#pragma once

#include "model/solver.h"

typedef struct RecorderRanges {
    const Scenario *scenario;
    Trajectory *trajectory;
    size_t stretch; // under way
    double stretch_end_s;
    Range *now;   // of the steps in it, by signal, but for those of parts; owned, like the next
    Vec2 *forces; // N, on each body in a step; room
} RecorderRanges;

RecorderRanges recorder_ranges_start(const Scenario *scenario, Trajectory *trajectory);

// Takes in one step.
void recorder_ranges_add(RecorderRanges *own, const StepRecord *step);

// Takes in a state of a part or of all (NULL) at any time.
void recorder_ranges_see(RecorderRanges *own, const SolverPart *part, const Sample *sample);

// Closes the stretch under way and frees the room.
void recorder_ranges_finish(RecorderRanges *own);
