// A run on one backend, at its own step or at one that is chosen for the error asked for: run.step
// auto.
#pragma once

#include "measure/truth.h"

// A listener. A trial begins: its number, from 1, and its step, s; number 0 stands
// for the truth.
typedef struct ChosenWatch {
    RunWatch run;
    void (*begin)(size_t trial, double step_s, void *context); // may be NULL
    double budget_s; // of processor time, for all trials together; 0: as long as it takes
} ChosenWatch;

// Runs the scenario on one backend, as run_guarded does: at its own step, or where that is to be
// chosen at falling steps, each trial held against the truth as it goes, until one holds
// run.tolerance up to the truth's horizon: that trial is the result. Its error_estimate is an upper
// bound, the measured error and the truth's uncertainty, up to estimate_s. Where run.most-steps or
// the budget of the watch are used up first it is the best trial, marked as short, with what the
// tolerance would take where that is the budget's doing; where none held the tolerance at all, or
// there is no truth, it is a failed run with the reason. Steps, evaluations and time are those of
// all trials. The truth, which no other run needs, is made where it is NULL; the probe may be NULL.
// The caller destroys what comes back.
Trajectory *backend_run(const Scenario *scenario, BackendKind backend, const Truth *truth,
                        ChosenWatch watch, const RunProbe *probe);

// What looks into the steps of a run of which errors are measured: nothing, but where the tolerance
// is of peaks, which are then those that `run` finds.
const RunProbe *backend_run_probe(const Scenario *scenario);

// Whether the step of that backend is to be chosen.
bool backend_run_is_chosen(const Scenario *scenario, BackendKind backend);

// The scenario with a step that was chosen for it, so that the run is the same to the last bit.
Scenario chosen_run_scenario(const Scenario *scenario, double step_s);
