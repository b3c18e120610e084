// The equations of motion of a linkage with play in space, in the coordinates of its tree, contacts
// as smooth forces while their mode is frozen.
#pragma once

#include "reference/space_contact.h"
#include "reference/space_loops.h"
#include "reference/system.h"

// Everything at one instant. Made of zeros.
typedef struct SpaceState {
    SystemState shared;               // the first
    SpaceTreeState tree;              // accelerations filled in
    SpaceForce forces[PIN_SPACE_MAX]; // by contact
    Vec3 reactions[SPACE_JOINT_MAX];  // N, on body b, of ideal joints
    double drive_power;               // W
} SpaceState;

typedef struct SpaceDynamics {
    System system; // the first
    SpaceTree tree;
    SpaceLoops loops;
    SpaceContact contacts[PIN_SPACE_MAX];
    // owned; room to work in
    SpaceState *scratch;
    double *matrix;
    double *right;
} SpaceDynamics;

// Fails with ERR_CASE where a contact law does not fit a joint.
bool space_dynamics_init(const Scenario *scenario, SpaceDynamics *dynamics, Err *err);
void space_dynamics_finish(SpaceDynamics *dynamics);

// Room for a state of these equations; the caller frees it.
SpaceState *space_dynamics_state_create(const SpaceDynamics *dynamics);

// Times, s, and coordinates are those since the base of the tree.
//
// The state at a time from the integrator's vector, and the rates of that, which may be NULL.
// Returns false where the accelerations are not determined.
bool space_dynamics_evaluate(const SpaceDynamics *dynamics, double since_s, const double *y,
                             SpaceState *state, double *rates);

// Unknowns of the equations for the accelerations: the coordinates' second rates, and a multiplier
// for each row of the loops.
static inline size_t space_dynamics_equations(const SpaceDynamics *dynamics)
{
    return dynamics->tree.coordinate_count + dynamics->loops.row_count;
}

// Fills in positions, velocities and the contacts' forces, and factors the matrix of these
// equations into dynamics->matrix, for dense_substitute. Returns false where the accelerations are
// not determined.
bool space_dynamics_factor(const SpaceDynamics *dynamics, double since_s, const double *y,
                           SpaceState *state, size_t *pivots);

// Rates of the integrator's vector; NaN where they are not determined. The context is a
// SpaceDynamics.
void space_dynamics_rates(double since_s, const double *y, double *rates, void *context);

// One contact at a time, for events.
Press space_dynamics_press(const SpaceDynamics *dynamics, size_t contact, double since_s,
                           const double *y);
