// What happens between samples, gathered step by step in constant memory.
#pragma once

#include "model/solver.h"

typedef struct Recorder {
    const Scenario *scenario;
    Trajectory *trajectory;               // receives extremes, contacts and hash
    bool is_empty;                        // before the first step
    bool was_touching[LINKAGE_JOINT_MAX]; // by joint, in the step before
    Spike open[LINKAGE_JOINT_MAX];        // the contact under way, by joint
} Recorder;

Recorder recorder_start(const Scenario *scenario, Trajectory *trajectory);

// Takes in one step.
void recorder_add(Recorder *recorder, const StepRecord *step);

// Closes contacts that are still under way at the end of the run.
void recorder_finish(Recorder *recorder);
