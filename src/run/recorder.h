// What happens between samples, gathered step by step in memory that does not grow with the steps.
#pragma once

#include "run/marking.h"
#include "run/report_cut.h"

// The ranges of a run, gathered step by step where its trajectory has room for them.

typedef struct RecorderRanges {
    const Scenario *scenario;
    Trajectory *trajectory;
    size_t stretch; // under way
    double stretch_end_s;
    Range *now;   // of the steps in it, by signal, but for those of parts; owned, like the next
    Vec2 *forces; // N, on each body in a step; room
} RecorderRanges;

typedef struct Recorder {
    const Scenario *scenario;
    Trajectory *trajectory; // receives extremes, contacts, ranges and hash
    bool *has_body;         // whether it has been in a step that is reported; owned, as all arrays
    bool *has_joint;
    bool has_all;       // whether all of them have been in one
    bool *was_touching; // by joint, in the step before
    Spike *open;        // the contact under way, by joint
    ReportCut cut;      // of the step that the reported time begins in
    bool is_cut;        // whether the last record is one that it cuts
    RecorderRanges ranges;
    Marking *marking; // owned; NULL where no marks are asked for
} Recorder;

// The solver is asked for what is within the step that the reported time begins in; NULL: nobody
// is.
Recorder recorder_start(const Scenario *scenario, Trajectory *trajectory, const Solver *solver,
                        const void *of);

// Takes in one step.
void recorder_add(Recorder *recorder, const StepRecord *step);

// Takes in a state that the solver was asked for, at a time in the last step, of a part or of all
// (NULL): extremes and ranges hold it.
void recorder_see(Recorder *recorder, const SolverPart *part, const Sample *sample);

// A signal of which extremes are kept: a body's omega or alpha, a joint's force.
typedef enum RecorderSignal { RECORDER_OMEGA, RECORDER_ALPHA, RECORDER_FORCE } RecorderSignal;

// The largest value so far of the signal of a body or joint, or the smallest where the sign is
// negative; of a force the largest alone.
const Extreme *recorder_extreme(const Recorder *recorder, RecorderSignal signal, size_t number,
                                double sign);

// The largest force so far of a joint's contact under way, where it is one that is reported, and at
// most that of the joint; else that of the joint.
double recorder_contact_force(const Recorder *recorder, size_t joint);

// Takes in one value that lies beyond that, at a time in the last step.
void recorder_raise(Recorder *recorder, RecorderSignal signal, size_t number, double sign,
                    Extreme extreme);

// Closes contacts that are still under way at the end of the run, and frees what the recorder has.
void recorder_finish(Recorder *recorder);
