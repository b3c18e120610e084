// What happens between samples, gathered step by step in memory that does not grow with the steps.
#pragma once

#include "model/solver.h"

typedef struct Recorder {
    const Scenario *scenario;
    Trajectory *trajectory; // receives extremes, contacts, ranges and hash
    bool is_empty;          // before the first step that is reported
    bool *was_touching;     // by joint, in the step before; owned, like the arrays below
    Spike *open;            // the contact under way, by joint
    size_t stretch;         // of the ranges, under way
    double stretch_end_s;
    Range *now;   // of the steps in it, by signal
    Vec2 *forces; // N, on each body in a step; room
} Recorder;

Recorder recorder_start(const Scenario *scenario, Trajectory *trajectory);

// Takes in one step.
void recorder_add(Recorder *recorder, const StepRecord *step);

// Takes in a state that the solver was asked for, at a time in the last step: extremes and ranges
// hold it.
void recorder_see(Recorder *recorder, const Sample *sample);

// Closes contacts that are still under way at the end of the run, and frees what the recorder has.
void recorder_finish(Recorder *recorder);
