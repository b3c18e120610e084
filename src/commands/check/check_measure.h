// Measures a scenario for a regression check.
#pragma once

#include "commands/check/check_add.h"
#include "measure/truth.h"

// What to hold the runs against, and how much to measure. It is fixed when a baseline is made:
// a horizon found anew each time would differ by a sample.
typedef struct CheckPlan {
    bool has_truth;     // errors are measured
    double uncertainty; // 1, of the truth
    bool is_limited;    // the motion cannot be predicted to its end
    double horizon_s;   // where that is so
    bool is_full;       // order of convergence as well
} CheckPlan;

// How the starts of an ensemble differ from the scenario's own.
typedef struct CheckStart {
    unsigned member; // 0: not at all
    double share;    // 1: size of the perturbation, see model/perturb.h
    unsigned shake;  // 0: not; else the seed with which inputs are rounded anew
} CheckStart;

// The plan of a scenario, its truth being known. The runs are measured in full.
CheckPlan check_plan(const Truth *truth);

// The scenario from another start.
void check_measure_start(Scenario *scenario, CheckStart start);

// Runs the scenario on its backends and measures them. A run that fails leaves nothing measured.
// What the measure held before is lost but for its room.
void check_measure(const Scenario *scenario, const CheckPlan *plan, CheckMeasure *measure);

// Gives back what a measure holds, zeroed ones included; and one with the contents of another.
void check_measure_finish(CheckMeasure *measure);
CheckMeasure check_measure_copy(const CheckMeasure *measure);

// The same in one piece of memory, as a child process hands it to its parent: how many bytes that
// takes at most; what is written there; and what is read from it.
size_t check_measure_packed_size(const Scenario *scenario);
void check_measure_pack(const CheckMeasure *measure, void *packed, size_t size);
CheckMeasure check_measure_unpack(const void *packed);
