// The equations of motion of a linkage with play in the plane, in the coordinates of its tree,
// contacts as smooth forces while their mode is frozen.
#pragma once

#include "reference/dynamics_contact.h"
#include "reference/tree.h"

// Fails with ERR_CASE where a contact law does not fit a joint.
bool dynamics_init(const Scenario *scenario, Dynamics *dynamics, Err *err);

// Unknowns of the equations for the accelerations: the coordinates' second rates, and behind them
// two multipliers for each joint that closes a loop.
enum { DYNAMICS_EQUATION_MAX = TREE_COORDINATE_MAX + 2 * TREE_LOOP_MAX };

static inline size_t dynamics_equations(const Dynamics *dynamics)
{
    return dynamics->tree.coordinate_count + 2 * dynamics->tree.loop_count;
}

// Factors the matrix of these equations at a state of the tree, for dense_substitute. Returns false
// where the accelerations are not determined.
bool dynamics_factor(const Dynamics *dynamics, const TreeState *state, double *matrix,
                     size_t *pivots);

// Times, s, and coordinates are those since the base of the tree.
//
// The state at a time from the integrator's vector, and the rates of that, which may be NULL: those
// of loops as open as they are. Returns false where the accelerations are not determined.
bool dynamics_evaluate(const Dynamics *dynamics, double since_s, const double *y,
                       DynamicsState *state, double *rates);

// Rates of the integrator's vector; NaN where they are not determined. The context is a Dynamics.
void dynamics_rates(double since_s, const double *y, double *rates, void *context);

// One contact at a time, for events: cheaper than the whole state.
ContactForce dynamics_contact(const Dynamics *dynamics, size_t contact, double since_s,
                              const double *y);
