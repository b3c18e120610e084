// Lists the solvers of the program.
#include "run/registry.h"

#include <assert.h>

#define MEMBER(id, word, solver, has_play) [id] = &solver,
static const Solver *const SOLVERS[] = {OPTIONS_BACKEND_LIST(MEMBER)};

const Solver *registry_solver(BackendKind backend)
{
    assert(backend >= 0 && backend < BACKEND_COUNT);
    return SOLVERS[backend];
}

bool registry_check_backend(const Scenario *scenario, BackendKind backend, Err *err)
{
    const Solver *solver = registry_solver(backend);
    return solver->check == NULL || solver->check(scenario, err);
}

bool registry_check(const Scenario *scenario, Err *err)
{
    bool is_right = true;
    for (size_t i = 0; is_right && i < scenario->run.backend_count; i++) {
        is_right = registry_check_backend(scenario, scenario->run.backends[i], err);
    }
    return is_right;
}
