// The equations of motion of a linkage with play in space, in the coordinates of its tree, contacts
// as smooth forces while their mode is frozen.
#pragma once

#include "reference/space_contact.h"
#include "reference/space_loops.h"
#include "reference/system.h"

// Everything at one instant. Made of zeros.
typedef struct SpaceState {
    SystemState shared;  // the first
    SpaceTreeState tree; // accelerations filled in
    SpaceForce *forces;  // by contact
    Vec3 *reactions;     // N, on body b, of ideal joints
    double drive_power;  // W
} SpaceState;

typedef struct SpaceDynamics {
    System system; // the first
    SpaceTree tree;
    SpaceLoops *loops; // owned, like all below
    SpaceContact *contacts;
    // room to work in
    SpaceState *scratch;
    SpacePush *loads;  // by number of body + 1: at the centre, and the moment about it
    SpacePush *pushes; // by body: of these less what the bodies' bias takes of them
    double *sides;     // by row of the loops
    double *solved;    // by coordinate, and by row of the loops
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

// Fills in positions, velocities and the contacts' forces, and factors the matrix of the equations
// for the accelerations into that of the loops. Returns false where the accelerations are not
// determined.
bool space_dynamics_factor(const SpaceDynamics *dynamics, double since_s, const double *y,
                           SpaceState *state);

// Rates of the integrator's vector; NaN where they are not determined. The context is a
// SpaceDynamics.
void space_dynamics_rates(double since_s, const double *y, double *rates, void *context);

// One contact at a time, for events.
Press space_dynamics_press(const SpaceDynamics *dynamics, size_t contact, double since_s,
                           const double *y);
