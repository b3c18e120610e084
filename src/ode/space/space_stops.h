// The ends of limited angles of hinges in space as rows of ODE: what ode/plane/contact_rows.c does
// for ends in the plane.
#pragma once

#include "contact/map.h"
#include "model/space_coordinate.h"
#include "model/space_response.h"
#include "ode/plane/world.h"
#include "ode/space/space_joints.h"
#include "ode/stepping.h"

// One end, as ode/space/space_stops.c keeps it.
typedef struct SpaceStop SpaceStop;

typedef struct SpaceStops {
    const Scenario *scenario;
    World *world;
    SpaceResponse *response;
    const Map *map;
    bool is_staggered;
    size_t first_place; // of theirs in the response
    size_t count;
    SpaceStop *stops;     // owned, like the arrays below
    double *angles;       // rad, by joint: of limited ones at the last look
    SpaceRow *rows;       // room: of all places of the response
    SpaceMotion *motions; // room: by body
    size_t fallback_count;
} SpaceStops;

// Lists the ends of all limited angles, into zeroed memory. Fails with ERR_CASE where a law does
// not fit. To be finished after a failure too.
bool space_stops_list(SpaceStops *stops, const Scenario *scenario, Err *err);

// Writes the places as the response takes them, one row each.
void space_stops_response_places(const SpaceStops *stops, SpaceResponsePlace *places);

// Makes their rows in a world that has been built, with a response whose places from the one of
// that number on are theirs, one row each. Must not be copied.
void space_stops_init(SpaceStops *stops, World *world, SpaceResponse *response, size_t first_place,
                      bool is_staggered);
void space_stops_finish(SpaceStops *stops);

// Carries what they know of the steps before.
void space_stops_carry(SpaceStops *stops, Carry *carry);

// Looks for ends that press at the motions given and makes their rows. Writes angles and gaps into
// the joints, and the closing speeds at which their contacts began. Fails with ERR_SOLVER where an
// end is deeper than its law holds.
bool space_stops_make(SpaceStops *stops, const SpaceMotion *motions, double step_s,
                      SpaceJoints *joints, double *approach, Err *err);

// After the step: adds the torques to the joints and books the energies.
void space_stops_clear(SpaceStops *stops, double step_s, SpaceJoints *joints);
ContactEnergy space_stops_energy(const SpaceStops *stops);

// The largest force and depth of each joint that the steps up to the last one show, by joint.
void space_stops_peaks(const SpaceStops *stops, JointPeak *peaks);

// Writes what the ends carry after the last step, by joint and its places.
void space_stops_states(const SpaceStops *stops, ContactState (*states)[JOINT_PLACES]);
