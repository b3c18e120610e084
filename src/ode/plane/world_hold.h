// The ideal joints of a world with many of them, held by forces that are found here instead of by
// rows of ODE: in time proportional to the joints.
#pragma once

#include "model/scenario.h"
#include "model/trajectory.h"

#include <ode/ode.h>

typedef struct WorldHold WorldHold;

// Rows of ideal joints that hold one another, from which on the sparse factor is faster than ODE's
// dense one.
enum { WORLD_HOLD_ROWS = 32 };

// What holds the ideal joints of a scenario in the plane; NULL where they are rows of ODE, as those
// of so many or less are that hold one another. For world_hold_free, which accepts NULL.
WorldHold *world_hold_make(const Scenario *scenario, size_t most_rows);
void world_hold_free(WorldHold *hold);

// Whether nothing else is a row of ODE, which would have to be solved together with the joints':
// contacts, dampers, rows that the case makes soft.
bool world_hold_is_alone(const Scenario *scenario);

// The share of an ideal joint's opening that a step takes back.
double world_hold_erp(const OdeOptions *options);

// Where the bodies' motions are to be put before a push.
Motion *world_hold_motions(WorldHold *hold);

// Pushes the bodies, on which all else acts already, so that a step keeps the joints closed. Fails
// with ERR_SOLVER where the joints are redundant there.
bool world_hold_push(WorldHold *hold, const dBodyID *bodies, double step_s, Err *err);

// Fills in the forces of the ideal joints in the last step; the driven one apart.
void world_hold_forces(const WorldHold *hold, JointState *joints);

// Fills in, by joint, how far from the anchor on a body the forces of prismatic joints acted in the
// last step, m: at the anchor on their body b.
void world_hold_offsets(const WorldHold *hold, int body, Vec2 *offsets);
