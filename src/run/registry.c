// Which solver stands behind which word of a case?
#include "run/registry.h"

#include "analytic/analytic.h"
#include "ode/ode_solver.h"
#include "reference/reference.h"

#include <assert.h>

static const Solver *const SOLVERS[BACKEND_COUNT] = {
    [BACKEND_ANALYTIC] = &ANALYTIC_SOLVER,
    [BACKEND_REFERENCE] = &REFERENCE_SOLVER,
    [BACKEND_ODE] = &ODE_SOLVER,
};

const Solver *registry_solver(BackendKind backend)
{
    assert(backend >= 0 && backend < BACKEND_COUNT);
    return SOLVERS[backend];
}
