// The contacts of pins in space as ODE's rows, and the joints they belong to: what
// ode/space_contacts.c and its parts share.
#pragma once

#include "contact/law_row.h"
#include "contact/onset.h"
#include "contact/pin_space.h"
#include "model/space_response.h"
#include "ode/plane/world.h"

// What a pin does at one of its places.
typedef struct SpaceContact {
    ContactState state; // as in ode/plane/contact_rows.h
    double depth;       // m, of the row, like all that follows up to the friction
    PinSpacePose pose;
    Vec3 point;     // m, where the force acts
    Vec3 hole_axis; // unit, of a collar
    Onset onset;
    double mass;       // kg, effective along the normal that it was worked out for
    double stiff_mass; // kg, with which the stiffest motion of the joint's places meets it
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

// Rows of a place in the response of the linkage: along its normal, and two along its wall.
enum { SPACE_CONTACT_ROWS = 3 };

typedef struct SpaceContacts {
    const Scenario *scenario;
    World *world;
    SpaceResponse *response; // the linkage's
    const Map *map;
    double penalty; // N s/m, of CONTACT_POISSON, of a whole joint
    dJointGroupID group;
    size_t count;
    PinSpace *places;       // owned, as are all arrays here
    SpaceContact *contacts; // by place
    SpaceRow *rows;         // room: SPACE_CONTACT_ROWS of each, for the response
    SpaceMotion *motions;   // room: by body
    size_t most_rows;
    size_t fallback_count;
    bool has_friction; // at any place
    bool is_staggered; // positions stand half a step behind the speeds
} SpaceContacts;
