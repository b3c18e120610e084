// Samples of a run whose solver hands on one mechanism after the other: of each taken while its
// steps come, so that it may go several samples ahead of the others.
#pragma once

#include "run/recorder.h"
#include "run/turning.h"

typedef struct PartSamples {
    const Scenario *scenario;
    const Solver *solver;
    const void *state; // of the solver
    Recorder *recorder;
    const Turning *turning;
    Trajectory *trajectory;   // receives the samples
    Sample sample;            // owned, as are the arrays
    const SolverPart **parts; // by number, as they are met; NULL: not yet
    size_t *next;             // by number, the sample that is its next
    size_t part_count;        // numbers so far
} PartSamples;

// The samples go into the recorder's trajectory. All arguments must outlive the result.
PartSamples part_samples_start(Recorder *recorder, const Turning *turning, const Solver *solver,
                               const void *state);
void part_samples_finish(PartSamples *samples);

// Takes the samples of a part that its last record has reached. Fails with ERR_SOLVER where one is
// not determined.
bool part_samples_take(PartSamples *samples, const StepRecord *record, Err *err);

// Takes what rounding has left out of the samples before one that all have been stepped to.
bool part_samples_complete(PartSamples *samples, size_t behind, Err *err);
