// Friction where bodies touch, as rows of ODE that follow the law of the other solvers.
#pragma once

#include "model/options.h"
#include "model/response.h"
#include "ode/plane/world.h"

// Two bodies that touch in a step. The first eight are given.
typedef struct FrictionRow {
    const WorldPair *pair;
    size_t first_row;      // of the place in the response
    Vec2 normal;           // unit: direction of the force on body b
    double friction;       // 1: the coefficient of the place's law
    double friction_speed; // m/s, of the law
    double closing;        // m/s, along it, before the step
    double target;  // m/s: separating speed that the row along the normal asks for, (ERP / h) d
    double cfm;     // s/kg, of that row
    double sliding; // m/s, of body b along vec2_perp of the normal, before the step
    double bound;   // 1: what ODE's bound has to be as a share of what presses without friction
    double slip;    // s/kg: speed for each newton along the wall; INFINITY: as the bound allows
    double surface; // m/s, sliding speed at which nothing holds
} FrictionRow;

// The speed at which body b slides on body a's point that it touches, m/s.
double contact_friction_sliding(const FrictionRow *row);

// What the search for it works with, for the places of a response. For contact_friction_free, which
// accepts NULL.
typedef struct FrictionWork FrictionWork;
FrictionWork *contact_friction_work(const Response *response);
void contact_friction_free(FrictionWork *work);

// Finds the friction of all places that touch, for a step of ODE's direct solver. The response is
// placed, has turns, and has the motions before the step; gravity in m/s^2; loads on the
// bodies, NULL where there are none.
void contact_friction_find(const Response *response, const Motion *motions, Vec2 gravity,
                           const BodyLoad *loads, double step_s, FrictionWork *work,
                           FrictionRow *rows, size_t count);
