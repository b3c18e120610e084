// The contacts of pins in space: looked for before each step at every place of every joint, one
// contact of ODE each while they last.
#pragma once

#include "contact/map.h"
#include "contact/pin_space.h"
#include "ode/contact_rows.h"
#include "ode/space_joints.h"
#include "ode/space_world.h"

// What a pin does at one of its places.
typedef struct SpaceContact {
    bool is_touching;
    double depth; // m, of the row, like all that follows up to the friction
    PinSpacePose pose;
    Vec3 point;          // m, where the force acts
    Vec3 hole_axis;      // unit, of a collar
    double impact_speed; // m/s, closing speed when the present contact began
    double gaps[2];      // m, of the last step and of the one before it
    size_t gaps_known;   // how many of them the pin was free in
    double mass;         // kg, effective along the normal that it was worked out for
    double stiff_mass;   // kg, with which the stiffest motion of the joint's places meets it
    Vec3 mass_normal;
    unsigned mass_places; // the joint's places that touched then, one bit each
    bool falls_back;      // the map is not stable at this step: the row is the textbook's
    double damping;       // N s/m
    Vec3 sliding;         // m/s, along the wall before the step, where there is friction
    Vec3 force;           // N, on the pin in the step
    double elastic;       // J, stored after the step
    double dissipated;    // J, lost along the normal in the step
    double friction;      // J, lost in sliding in the step
    dContact contact;     // as ODE is given it
    dJointFeedback feedback;
} SpaceContact;

typedef struct SpaceContacts {
    const Scenario *scenario;
    World *world;
    SpaceResponse *response; // the linkage's
    const Map *map;
    double penalty; // N s/m, of CONTACT_POISSON, of a whole joint
    dJointGroupID group;
    size_t count;
    PinSpace places[PIN_SPACE_MAX];
    SpaceContact contacts[PIN_SPACE_MAX];
    size_t most_rows;
    size_t fallback_count;
    bool is_staggered; // positions stand half a step behind the speeds
} SpaceContacts;

// Prepares the places of all joints with play. Fails with ERR_CASE where a law does not fit. Must
// not be copied: ODE writes into it.
bool space_contacts_init(SpaceContacts *contacts, const Scenario *scenario, World *world,
                         SpaceResponse *response, bool is_staggered, Err *err);
void space_contacts_finish(SpaceContacts *contacts);

// Looks for contacts at the motions given and makes a row for each. Writes the closing speeds at
// which the joints' contacts began. Fails with ERR_SOLVER where a pin is deeper in its wall than
// any contact law holds.
bool space_contacts_make(SpaceContacts *contacts, const SpaceMotion *motions, double step_s,
                         double *approach, Err *err);

// After the step: adds the forces to the joints, books the energies, and removes the rows.
void space_contacts_clear(SpaceContacts *contacts, double step_s, SpaceJoints *joints);

// Adds what the contacts did to a body in the step.
void space_contacts_load(const SpaceContacts *contacts, int body, Vec3 centre, SpaceChange *load);

// The sizes of the impulses of a step at all places, by joint, N s.
void space_contacts_impulses(const SpaceContacts *contacts, double step_s, double *impulses);

ContactEnergy space_contacts_energy(const SpaceContacts *contacts);
