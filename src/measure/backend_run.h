// One scenario on one backend, at its own step or at one that is chosen for it.
#pragma once

#include "measure/chosen_run.h"

// Runs the scenario, as run_guarded does. Where ODE's step is to be chosen the trials are held
// against the truth, which is made for it where it is NULL; no other run needs one.
Trajectory *backend_run(const Scenario *scenario, BackendKind backend, const Truth *truth,
                        ChosenWatch watch, const RunProbe *probe);

// Whether the step of that backend is to be chosen.
bool backend_run_is_chosen(const Scenario *scenario, BackendKind backend);
