// The friction of ideal joints in the plane.
#pragma once

#include "reference/plane/dynamics.h"

// What presses on a joint: of a pivot the reaction, N; of a guide x the force across it, N, and y
// the force at each end of its length that its moment makes, twice. Of a guide one of four faces
// presses most: x, -x, y, -y.
typedef struct RubPress {
    Vec2 of;
    double most; // N
} RubPress;

// Lists the joints with friction among the bristles of the system, for which there is room.
void rub_list(const Scenario *scenario, Dynamics *dynamics);

// Room to work in, for so many; rub_destroy frees it, and accepts NULL.
RubRoom *rub_create(const Dynamics *dynamics);
void rub_destroy(RubRoom *room);

// Solves for the coordinates' second rates, as dynamics_react does, with the friction that what
// presses in the joints makes, which that friction changes: fills in the rubs of the state and adds
// them to the loads. Returns false where the accelerations, or what presses, are not determined.
bool rub_solve(const Dynamics *dynamics, const double *y, bool are_closed, DynamicsState *state,
               Loads *loads);

// The joint whose friction had no single answer in the last rub_solve that failed; -1: none.
int rub_jammed(const Dynamics *dynamics);

// What the events of a bristle need (reference/system.h).
BristleAt rub_bristle(const Dynamics *dynamics, size_t number, double since_s, const double *y);
BristleFace rub_face(const Dynamics *dynamics, size_t number, double since_s, const double *y);
void rub_stick(Dynamics *dynamics, size_t number, const double *y);
void rub_hold(Dynamics *dynamics, double *y);
