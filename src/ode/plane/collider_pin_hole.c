// Finds the contact of a pin with a round hole exactly: two circles, one inside the other.
#include "ode/plane/collider.h"

static void *pin_hole_open(const Scenario *scenario, int joint)
{
    (void)scenario, (void)joint;
    return NULL; // the two geoms are all
}

static bool pin_hole_find(void *state, dGeomID hole, dGeomID pin, Collision *collision)
{
    (void)state;
    dContactGeom geom;
    if (dCollide(hole, pin, 1, &geom, sizeof geom) == 0) {
        return false;
    }
    dReal pin_radius;
    dReal pin_length;
    dGeomCylinderGetParams(pin, &pin_radius, &pin_length);
    const Vec2 normal = {-geom.normal[0], -geom.normal[1]};
    *collision = (Collision){
        .depth = geom.depth,
        .normal = normal,
        .arm_hole = vec2_scale(-hole_geom_radius(hole), normal),
        .arm_pin = vec2_scale(-pin_radius, normal),
    };
    return true;
}

static void pin_hole_close(void *state)
{
    (void)state;
}

const Collider collider_pin_hole = {
    .open = pin_hole_open,
    .find = pin_hole_find,
    .close = pin_hole_close,
};
