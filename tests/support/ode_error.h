// How far ODE is from a truth, and how that distance goes with the step.
#pragma once

#include "complete_run.h"

#include "measure/error.h"

enum { ODE_CLIMB_MAX = 8 };

// The errors of one scenario's ODE runs at several steps, coarsest first.
typedef struct OdeClimb {
    size_t count;
    double steps_s[ODE_CLIMB_MAX];
    TrajectoryError errors[ODE_CLIMB_MAX];
} OdeClimb;

// The error of a scenario's ODE run at a step against another backend's.
static inline TrajectoryError ode_error_at(Scenario scenario, BackendKind truth, double step_s)
{
    scenario.run.step = step_s;
    Trajectory *ode = complete_run(&scenario, BACKEND_ODE);
    Trajectory *exact = complete_run(&scenario, truth);
    const TrajectoryError error = error_against(ode, exact, INFINITY);
    assert_true(error.is_known);
    trajectory_destroy(ode);
    trajectory_destroy(exact);
    return error;
}

// The errors at so many steps, s, from the first on, each the one before over the ratio.
static inline OdeClimb ode_climb(const Scenario *scenario, BackendKind truth, double first_s,
                                 double ratio, size_t count)
{
    OdeClimb climb = {.count = count};
    assert_true(count <= ODE_CLIMB_MAX);
    for (size_t i = 0; i < count; i++) {
        climb.steps_s[i] = i == 0 ? first_s : climb.steps_s[i - 1] / ratio;
        climb.errors[i] = ode_error_at(*scenario, truth, climb.steps_s[i]);
    }
    return climb;
}

// The power of the step at which an error falls from one step to another.
static inline double ode_order(double coarse, double fine, double step_ratio)
{
    return log(coarse / fine) / log(step_ratio);
}

// The order in omega between two steps of a climb.
static inline double ode_climb_order(const OdeClimb *climb, size_t coarse, size_t fine)
{
    return ode_order(climb->errors[coarse].omega_max, climb->errors[fine].omega_max,
                     climb->steps_s[coarse] / climb->steps_s[fine]);
}
