// The equations of motion of a linkage with play in space, in the coordinates of its tree, contacts
// as smooth forces while their mode is frozen.
#pragma once

#include "contact/pin_space.h"
#include "reference/space/space_articulated.h"
#include "reference/space/space_tree.h"
#include "reference/system.h"

// The forces at the sites where a pin in space presses on its hole, in the coordinates of a tree.

// A site at the base of the tree.
typedef struct SpaceContact {
    PinSpace site;  // of a pin; of an end of a limited angle its joint alone
    bool is_turn;   // whether it is one
    double sign;    // 1 of its low end, -1 of its high one
    double limit;   // rad, where that is
    Vec3 base_hole; // m, from the centre of body a to the site's point of the hole
    Vec3 base_pin;  // m, from the centre of body b to that point of the pin's axis which is nearest
                    // to it; of a collar to the pin's middle
    Vec3 base_axis; // of the pin; of a collar of the hole
    Vec3 base_gap;  // m, the pin's point less the hole's
} SpaceContact;

// A site at one instant.
typedef struct SpaceForce {
    Press press;
    Vec3 offset;   // e, m
    double size;   // m, |e|
    Vec3 outward;  // e / |e|; zero of a centred pin
    Vec3 axis;     // of the pin; of a collar of the hole
    Vec3 from_a;   // m, from body a's centre to the hole's point O, of a collar to M
    Vec3 from_b;   // m, from body b's centre to the axis' point P, of a collar to M
    Vec3 relative; // m/s, velocity of body b there less that of body a
    Vec3 force_a;  // m, from the bodies' centres to where the force acts on them, on its line
    Vec3 force_b;
    Vec3 force;  // N, on the pin, friction included
    Vec3 couple; // N m, on body b, of an end of a limited angle
} SpaceForce;

// The angle of a limited joint, rad, its rate and its second rate.
double space_turn_angle(const SpaceTree *tree, const SpaceTreeState *state, int joint);
double space_turn_rate(const SpaceTree *tree, const SpaceTreeState *state, int joint);
double space_turn_second(const SpaceTree *tree, const SpaceTreeState *state, int joint);

// Puts a site at the base of the tree.
void space_contact_rebase(const SpaceTree *tree, SpaceContact *contact);

// The second rate of the depth, m/s^2, of a site whose bodies have accelerations.
double space_contact_second(const SpaceContact *at, const SpaceTreeState *state,
                            const SpaceForce *force);

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

// How accelerations in space change with coordinates and rates, for the implicit integrator.

// Derivatives of the coordinates' second rates by the coordinates and by their rates, as matrices
// of the coupling: of the forces where pins press, with the geometry frozen. NaN where they are not
// determined. The context is a SpaceDynamics.
void space_slopes(double since_s, const double *y, double *by_position, double *by_rate,
                  void *context);
