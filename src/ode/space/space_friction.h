// Friction of pins in space on their walls, as rows of ODE that follow the law of the other
// solvers: ode/plane/contact_friction.h with two directions along the wall.
#pragma once

#include "model/options.h"
#include "model/space_response.h"

// A pin on its wall in a step. Those up to `sliding` are given.
typedef struct SpaceFrictionRow {
    int body[2]; // of the hole and of the pin
    Vec3 point;  // m, where the wall is touched
    Vec3 normal; // unit: direction of the force on the pin
    Vec3 side;   // unit: a direction along the wall
    bool has_friction;
    double friction;       // 1: the coefficient of the place's law
    double friction_speed; // m/s, of the law
    double target;     // m/s: separating speed that the row along the normal asks for, (ERP / h) d
    double cfm;        // s/kg, of that row
    Vec3 sliding;      // m/s, of the pin along the wall, before the step
    Vec3 along;        // unit: the first direction of friction; the second is normal x along
    double bound;      // 1: what ODE's bound has to be as a share of what presses without friction
    double slip[2];    // s/kg: speed for each newton along the wall; INFINITY: as the bound allows
    double surface[2]; // m/s, sliding speed at which nothing holds
} SpaceFrictionRow;

// What a step of ODE starts from: speeds as its rows see them, the driven body's at the step's end;
// accelerations by all that acts but the rows.
typedef struct SpaceFrictionStep {
    const SpaceMotion *motions;
    double step_s;
    double erp; // of the ideal joints
} SpaceFrictionStep;

// Finds the friction of all pins that touch, for a step of ODE's direct solver. `places`: of each
// row its number in the response, in order, whose places have three rows each. Returns false, the
// rows untouched, where the response cannot be placed.
bool space_friction_find(SpaceResponse *response, const SpaceFrictionStep *step,
                         const size_t *places, SpaceFrictionRow *rows, size_t count);
