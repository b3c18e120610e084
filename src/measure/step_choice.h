// Steps of ODE worth a trial, for an error that is asked for.
#pragma once

#include "model/scenario.h"

typedef struct StepChoice {
    const Scenario *scenario; // outlives the choice
    double first_step_s;      // the coarsest worth a trial
    bool is_smooth;           // whether errors fall as the order says: nothing touches
    double order;             // of the stepping, where it is
} StepChoice;

StepChoice step_choice_begin(const Scenario *scenario);

// The scenario at that step, stepped as trials are.
Scenario step_choice_scenario(const StepChoice *choice, double step_s);

// The step that comes after one that missed the tolerance when it had come through a share of the
// run, 0 to 1, or after one that the solver failed at.
double step_choice_finer(double step_s, double share);
double step_choice_after_failure(double step_s);

// The step after one whose largest error in the whole run was that many times the tolerance, where
// errors fall as the order says.
double step_choice_by_order(const StepChoice *choice, double step_s, double excess);
