// The contacts of the joints with play: looked for before each step at each place where they may
// be, one row each while they last.
#pragma once

#include "contact/map.h"
#include "model/solver.h"
#include "ode/plane/contact_friction.h"
#include "ode/stepping.h"

// The contact at one point, as ode/plane/contact_rows.c keeps it.
typedef struct ContactRow ContactRow;

// The effective masses with which the linkage meets what presses at its contact points.
typedef struct ContactMass {
    const World *world;
    Response response; // its places are the pairs of the world
    bool is_placed;    // the response is where the bodies are in this step, and so are the motions
    Motion *motions;   // owned by the rows
} ContactMass;

typedef struct ContactRows {
    const Scenario *scenario;
    World *world;
    const Map *map;
    double penalty; // N s/m, of CONTACT_POISSON: given, or the paper's estimate
    dJointGroupID group;
    ContactRow *rows;      // by pair of the world; owned, as the next
    FrictionRow *friction; // of those that touch
    FrictionWork *work;    // NULL without friction
    size_t *numbers;       // of the pairs that touch
    size_t most_rows;      // at any step so far
    size_t row_count;      // made so far
    size_t fallback_count; // of those, where the map would not have been stable
    bool is_staggered;     // positions stand half a step behind the speeds
    ContactMass mass;      // of the linkage at the places
} ContactRows;

// Prepares the laws of all pairs. Fails with ERR_CASE where a law does not fit a joint. The rows
// must not be copied: ODE writes into them. Of a staggered world the positions are those of
// mid-step and the speeds those of the step's start: the onset of a contact is then located between
// steps.
bool contact_rows_init(ContactRows *rows, const Scenario *scenario, World *world, bool is_staggered,
                       Err *err);
void contact_rows_finish(ContactRows *rows);

// Writes what the contacts carry after the last step, by joint and its places.
void contact_rows_states(const ContactRows *rows, ContactState (*states)[JOINT_PLACES]);

// Carries what the rows know of the steps before.
void contact_rows_carry(ContactRows *rows, Carry *carry);

// Looks for contacts where the bodies stand now and makes a row for each; fills the states (gap,
// touching, and the eccentricity of joints with one place) and the closing speeds at which their
// contacts began, by joint: of several places the least gap and the highest speed. Fails
// with ERR_SOLVER where a pin is deeper in its wall than any contact law holds.
bool contact_rows_make(ContactRows *rows, double step_s, JointState *states, double *approach,
                       Err *err);

// The power of all drives at a time, W, from the joints' forces, among which it puts those of the
// driven joints. Offsets are room, by joint.
double contact_rows_drive_power(const ContactRows *rows, double time_s, Vec2 *offsets,
                                JointState *joints);

ContactEnergy contact_rows_energy(const ContactRows *rows);

// After the step, the forces of the ideal joints being known: fills in or adds those of the
// contacts, books the energies, and removes the rows.
void contact_rows_clear(ContactRows *rows, double step_s, JointState *states);

// Once the rows are cleared: the largest force and depth at the ends of coordinates, 0 elsewhere;
// where positions stand at mid-step, since the last step but one.
void contact_rows_peaks(const ContactRows *rows, JointPeak *peaks);
