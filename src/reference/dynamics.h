// The equations of motion of a linkage with play in the plane, in the coordinates of its tree,
// contacts as smooth forces while their mode is frozen.
#pragma once

#include "reference/dynamics_contact.h"
#include "reference/loops.h"
#include "reference/tree.h"

// Fails with ERR_CASE where a contact law does not fit a joint.
bool dynamics_init(const Scenario *scenario, Dynamics *dynamics, Err *err);
void dynamics_finish(Dynamics *dynamics);

// Room for a state of these equations; the caller frees it.
DynamicsState *dynamics_state_create(const Dynamics *dynamics);

// Times, s, and coordinates are those since the base of the tree.
//
// The state at a time from the integrator's vector, and the rates of that, which may be NULL: those
// of loops as open as they are. Returns false where the accelerations are not determined.
bool dynamics_evaluate(const Dynamics *dynamics, double since_s, const double *y,
                       DynamicsState *state, double *rates);

// Rates of the integrator's vector; NaN where they are not determined. The context is a Dynamics.
void dynamics_rates(double since_s, const double *y, double *rates, void *context);

// What closing the loops of the tree needs.
LoopsRoom dynamics_loops(const Dynamics *dynamics);

// One contact at a time, for events: cheaper than the whole state. Only the bodies that move it are
// looked at.
ContactForce dynamics_contact(const Dynamics *dynamics, size_t contact, double since_s,
                              const double *y);

// Writes the coordinates of a Dynamics that this depends on. Returns how many there are; 0 where it
// depends on all.
size_t dynamics_contact_needs(const System *system, size_t contact, size_t *coordinates);
