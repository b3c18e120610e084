// Which side of a polygon does a pin inside it touch?
//
// Side i of a regular polygon, outward normal n_i, at the distance a: overlap e . n_i - (a - r).
// The largest e . n_i is that of the normal nearest the direction of e, so that one side is asked
// instead of all N. A broad phase by boxes could not choose: a pin in its hole meets the boxes of
// nearly all sides.
#include "ode/polygon_hole.h"

#include "ode/hole_geom.h"

#include <math.h>

// faces end beyond the pin's, so that these touch nothing
static const double OVERHANG = 1.1;

// no side is asked below this share of the play
static const double CLEAR = 0.5;

PolygonHole polygon_hole_of_joint(const Scenario *scenario, int joint)
{
    const Clearance *clearance = &scenario->linkage.joints[joint].clearance;
    const Facets facets = facets_of_joint(scenario, joint);
    return (PolygonHole){
        .facets = facets,
        .hole_radius = clearance->hole_radius,
        .pin_radius = clearance->pin_radius,
        .half_height = 0.5 * OVERHANG * hole_geom_width(clearance),
        .clear = CLEAR * (facets.inradius - clearance->pin_radius),
    };
}

static Vec2 centre_of(dGeomID geom)
{
    const dReal *position = dGeomGetPosition(geom);
    return (Vec2){position[0], position[1]};
}

bool polygon_hole_side(const PolygonHole *polygon, dGeomID hole, dGeomID pin, PolygonSide *side)
{
    const Vec2 e = vec2_sub(centre_of(pin), centre_of(hole));
    if (!(vec2_dot(e, e) > polygon->clear * polygon->clear)) {
        return false;
    }
    // the hole's own x axis, about which the sides are counted
    const dReal *rotation = dGeomGetRotation(hole);
    const Vec2 axis = {rotation[0], rotation[4]};
    const double angle = atan2(vec2_cross(axis, e), vec2_dot(axis, e));
    const double pitch = polygon->facets.pitch;
    const Vec2 outward = vec2_rotate(pitch * round(angle / pitch), axis);
    *side = (PolygonSide){
        .outward = outward,
        .pin = {vec2_dot(outward, e), vec2_cross(outward, e)},
    };
    return true;
}

Collision polygon_hole_collision(const PolygonHole *polygon, const PolygonSide *side, double depth,
                                 Vec2 direction)
{
    const Vec2 unit = vec2_scale(1.0 / vec2_length(direction), direction);
    const Vec2 along = vec2_perp(side->outward);
    const Vec2 normal = vec2_add(vec2_scale(unit.x, side->outward), vec2_scale(unit.y, along));
    const Vec2 arm_pin = vec2_scale(-polygon->pin_radius, normal);
    const Vec2 e = vec2_add(vec2_scale(side->pin.x, side->outward), vec2_scale(side->pin.y, along));
    return (Collision){
        .depth = depth, .normal = normal, .arm_hole = vec2_add(e, arm_pin), .arm_pin = arm_pin};
}

Collision polygon_hole_contact(const dContactGeom *geom, dGeomID hole, dGeomID pin)
{
    const Vec2 point = {geom->pos[0], geom->pos[1]};
    const Vec2 normal = {-geom->normal[0], -geom->normal[1]};
    return (Collision){
        .depth = geom->depth,
        .normal = vec2_scale(1.0 / vec2_length(normal), normal),
        .arm_hole = vec2_sub(point, centre_of(hole)),
        .arm_pin = vec2_sub(point, centre_of(pin)),
    };
}
