// Sums up what wears the pins of a run, from inside its steps.
#pragma once

#include "model/solver.h"

typedef struct Wearing Wearing;

// The solver is asked for states within its steps. NULL where no pin has a hole to wear, or the
// solver takes every joint as ideal; the other functions then do nothing. All arguments must
// outlive the result.
Wearing *wearing_start(const Scenario *scenario, const Solver *solver, const void *state,
                       Trajectory *trajectory);

// Takes in the solver's last step.
void wearing_add(Wearing *wearing, const StepRecord *step);

void wearing_finish(Wearing *wearing);
