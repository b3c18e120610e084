// How ODE learns that a pin touches the wall of its hole: a family of colliders, chosen by
// ode.collider.
//
// Each is asked with the two geoms of a joint where they stand, and answers with the deepest
// contact in the plane of the linkage. What is wrong with its answer goes into the contact row.
#pragma once

#include "base/err.h"
#include "base/vec2.h"
#include "model/scenario.h"

#include <ode/ode.h>

typedef struct Collision {
    double depth;  // m, above 0
    Vec2 normal;   // unit, direction of the force on the pin
    Vec2 arm_hole; // m, from the hole's centre to the point where the force acts
    Vec2 arm_pin;  // m, from the pin's centre to there
} Collision;

typedef struct Collider {
    // Fails with ERR_CASE where the collider cannot resolve the contacts of a joint with play; NULL
    // where it resolves them all.
    bool (*check)(const Scenario *scenario, int joint, Err *err);
    // Makes what a joint needs beyond its two geoms, checked or not; NULL where that is nothing.
    void *(*open)(const Scenario *scenario, int joint);
    // Finds the deepest contact; false where there is none. Both geoms have their axes along z.
    bool (*find)(void *state, dGeomID hole, dGeomID pin, Collision *collision);
    // Frees the state; accepts NULL.
    void (*close)(void *state);
} Collider;

const Collider *collider_get(OdeCollider kind);

// The members, by the names in OPTIONS_ODE_COLLIDER_LIST.
#define COLLIDER_DECLARE(id, word, collider) extern const Collider collider;
OPTIONS_ODE_COLLIDER_LIST(COLLIDER_DECLARE)
