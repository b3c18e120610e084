// Runs a scenario on a backend, at its own step or a chosen one.
#include "measure/backend_run.h"

#include "run/registry.h"

bool backend_run_is_chosen(const Scenario *scenario, BackendKind backend)
{
    return backend == BACKEND_ODE && scenario->run.step == 0.0;
}

Trajectory *backend_run(const Scenario *scenario, BackendKind backend, const Truth *truth,
                        ChosenWatch watch, const RunProbe *probe)
{
    if (backend_run_is_chosen(scenario, backend)) {
        return chosen_run_make(scenario, truth, watch, probe);
    }
    return run_guarded(scenario, registry_solver(backend), watch.run, probe, NULL);
}
