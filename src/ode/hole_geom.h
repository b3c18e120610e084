// A round hole as a geometry class of ODE, which has none, and its exact collider with a cylinder.
#pragma once

#include "model/linkage.h"

#include <ode/ode.h>

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
