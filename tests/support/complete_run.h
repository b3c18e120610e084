// A run that must be complete: the test fails with what the solver said where it is not.
#pragma once

#include "close.h"

#include "run/registry.h"
#include "run/run.h"

// The caller destroys the trajectory.
static inline Trajectory *complete_run(const Scenario *scenario, BackendKind backend)
{
    Trajectory *trajectory =
        run_scenario(scenario, registry_solver(backend), (RunWatch){NULL, NULL});
    if (!trajectory->is_complete) {
        fail_msg("%s", trajectory->message);
    }
    return trajectory;
}

// The impacts of all joints.
static inline size_t run_impacts(const Trajectory *run)
{
    size_t impacts = 0;
    for (size_t k = 0; k < run->joint_count; k++) {
        impacts += run->joints[k].impacts;
    }
    return impacts;
}
