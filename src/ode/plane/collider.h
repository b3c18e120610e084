// Finds where a pin touches the wall of its hole: a family of colliders, chosen by ode.collider; a
// round hole as a geometry class of ODE; and the polygon that stands for it.
//
// Each is asked with the two geoms of a joint where they stand, and answers with the deepest
// contact in the plane of the linkage. What is wrong with its answer goes into the contact row.
#pragma once

#include "base/err.h"
#include "base/vec2.h"
#include "contact/facets.h"
#include "model/linkage.h"
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

// The width of pin and hole, m: the joint's, or the pin's radius where it has none, for ODE's
// cylinder wants one above zero. An exact contact does not depend on it.
static inline double hole_geom_width(const Clearance *clearance)
{
    return clearance->width > 0.0 ? clearance->width : clearance->pin_radius;
}

// A hole about its own z axis, in no space. The engine must have been started. The class is
// registered with the first hole; ODE knows it until the process ends.
dGeomID hole_geom_create(double radius_m);

double hole_geom_radius(dGeomID hole);

// ODE's collider function of a hole (first) and a cylinder, both with axes along z: at most one
// contact, at the point of the wall nearest the pin, its normal pressing the hole outwards, its
// depth the overlap. None for a pin within its play, the concentric pin included.
int hole_geom_collide(dGeomID hole, dGeomID pin, int flags, dContactGeom *contact, int skip);

typedef struct PolygonHole {
    Facets facets;
    double hole_radius; // m
    double pin_radius;  // m
    double half_height; // m, of the faces: more than the pin's half length
    double clear;       // m: a pin nearer than that to the hole's centre is not asked for
} PolygonHole;

// One side of the polygon and the pin, in the frame of the side: origin in the hole's centre, x
// along the outward normal, y along the side.
typedef struct PolygonSide {
    Vec2 outward; // unit, the x axis in the world
    Vec2 pin;     // m, the pin's centre in that frame
} PolygonSide;

// The polygon of a joint with play.
PolygonHole polygon_hole_of_joint(const Scenario *scenario, int joint);

// Finds the side that faces the pin: its normal is nearest the direction from the hole's centre to
// the pin's. No other side can overlap the pin deeper. False for a pin near the middle of its play.
bool polygon_hole_side(const PolygonHole *polygon, dGeomID hole, dGeomID pin, PolygonSide *side);

// A contact with a side from its depth, m, and the direction of the force on the pin in the side's
// frame, not of unit length: the force acts at the pin's surface.
Collision polygon_hole_collision(const PolygonHole *polygon, const PolygonSide *side, double depth,
                                 Vec2 direction);

// A contact as ODE found it between faces of the hole and the pin, put into the plane.
Collision polygon_hole_contact(const dContactGeom *geom, dGeomID hole, dGeomID pin);
