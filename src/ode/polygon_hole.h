// A round hole taken for a regular polygon, as colliders see it that know flat faces only.
#pragma once

#include "contact/facets.h"
#include "ode/collider.h"

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
