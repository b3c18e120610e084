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
