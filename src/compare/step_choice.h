// Steps of ODE worth a trial, for an error that is asked for.
#pragma once

#include "model/scenario.h"

typedef struct StepChoice {
    const Scenario *scenario; // outlives the choice
    double order;             // of the error in the step
    double first_step_s;      // the coarsest worth a trial
} StepChoice;

// What one trial found.
typedef struct StepTrial {
    double step_s;
    double error;  // 1, the largest it came to, as far as it was run; INFINITY where it failed
    bool is_whole; // false: it was given up, or failed, and the whole error may be larger
    double share;  // of the window that it came through
} StepTrial;

StepChoice step_choice_begin(const Scenario *scenario);

// The scenario at that step, stepped as trials are.
Scenario step_choice_scenario(const StepChoice *choice, double step_s);

// A trial whose error exceeds this is not worth running on: its step is far too coarse.
double step_choice_give_up(const StepChoice *choice, double tolerance);

// The step that comes after a trial that missed the tolerance.
double step_choice_finer(const StepChoice *choice, const StepTrial *trial, double tolerance);
