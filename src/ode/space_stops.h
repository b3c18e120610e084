// The ends of limited angles of hinges in space as rows of ODE: what ode/plane/contact_rows.c does
// for ends in the plane.
#pragma once

#include "contact/map.h"
#include "contact/onset.h"
#include "contact/tops.h"
#include "model/space_coordinate.h"
#include "model/space_response.h"
#include "ode/plane/world.h"
#include "ode/space_joints.h"
#include "ode/stepping.h"

// One end.
typedef struct SpaceStop {
    int joint;
    double sign;  // 1 of the low end, -1 of the high one
    double limit; // rad, where it is
    ForceLaw law;
    dJointID row;
    dJointFeedback feedback;
    Vec3 axis; // of the row, of ODE's first body
    Onset onset;
    Tops tops;
    ContactState state; // as in ode/plane/contact_rows.h
    bool falls_back;    // the map is not stable at this step: the row is the textbook's
    double gap;         // rad, where the bodies are
    double depth;       // rad, of the row
    double share;       // 1, of the step in which the end is overlapped
    double closing;     // rad/s, before the step
    double mass;        // kg m^2, effective
    double damping;     // N m s/rad
    double pressing;    // N m, in the step
    double elastic;     // J, stored after it
    double dissipated;  // J, lost in it
} SpaceStop;

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

// Makes their rows in a world that has been built, with a response whose places from the one of
// that number on are theirs, one row each. Must not be copied.
void space_stops_init(SpaceStops *stops, World *world, SpaceResponse *response, size_t first_place,
                      bool is_staggered);
void space_stops_finish(SpaceStops *stops);

// Looks for ends that press at the motions given and makes their rows. Writes angles and gaps into
// the joints, and the closing speeds at which their contacts began. Fails with ERR_SOLVER where an
// end is deeper than its law holds.
bool space_stops_make(SpaceStops *stops, const SpaceMotion *motions, double step_s,
                      SpaceJoints *joints, double *approach, Err *err);

// After the step: adds the torques to the joints and books the energies.
void space_stops_clear(SpaceStops *stops, double step_s, SpaceJoints *joints);
ContactEnergy space_stops_energy(const SpaceStops *stops);

// The largest force and depth of each joint that the steps up to the last one show, by joint.
void space_stops_tops(const SpaceStops *stops, JointTop *tops);
