// The contacts of pins in space: looked for before each step at every place of every joint, one
// contact of ODE each while they last.
#pragma once

#include "contact/map.h"
#include "contact/pin_space.h"
#include "model/space_response.h"
#include "ode/plane/world.h"
#include "ode/space/space_joints.h"
#include "ode/stepping.h"

// What a pin does at one of its places, as ode/space/space_contacts.c keeps it.
typedef struct SpaceContact SpaceContact;

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

// Lists the places of all joints with play, into zeroed memory. Fails with ERR_CASE where a law
// does not fit. It is to be finished after a failure too.
bool space_contacts_list(SpaceContacts *contacts, const Scenario *scenario, Err *err);

// Prepares them, in the world and the response of the linkage that were built with these places
// (space_contacts_response_places). Must not be copied: ODE writes into it.
void space_contacts_init(SpaceContacts *contacts, World *world, SpaceResponse *response,
                         bool is_staggered);

// The places as the response takes them, SPACE_CONTACT_ROWS each, in an array with room for some
// in all, which free() gives back.
SpaceResponsePlace *space_contacts_response_places(const SpaceContacts *contacts, size_t room);
void space_contacts_finish(SpaceContacts *contacts);

// Carries what they know of the steps before.
void space_contacts_carry(SpaceContacts *contacts, Carry *carry);

// Looks for contacts at the motions given and makes a row for each. `seen` are the motions as the
// step's rows will see them, with accelerations by all but the rows: friction looks ahead by them.
// Writes the closing speeds at which the joints' contacts began. Fails with ERR_SOLVER where a pin
// is deeper in its wall than any contact law holds.
bool space_contacts_make(SpaceContacts *contacts, const SpaceMotion *motions,
                         const SpaceMotion *seen, double step_s, double *approach, Err *err);

// After the step: adds the forces to the joints, books the energies, and removes the rows.
void space_contacts_clear(SpaceContacts *contacts, double step_s, SpaceJoints *joints);

// Adds what the contacts did to a body in the step.
void space_contacts_load(const SpaceContacts *contacts, int body, Vec3 centre, SpaceChange *load);

// The sizes of the impulses of a step at all places, by joint, N s.
void space_contacts_impulses(const SpaceContacts *contacts, double step_s, double *impulses);

ContactEnergy space_contacts_energy(const SpaceContacts *contacts);

// Writes what the contacts carry after the last step, by joint and its places.
void space_contacts_states(const SpaceContacts *contacts, ContactState (*states)[JOINT_PLACES]);
