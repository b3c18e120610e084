// Lists the colliders, and holds what they share: the geometry of a round hole, which ODE lacks,
// and the polygon that stands for it where a collider knows flat faces only.
#include "ode/plane/collider.h"

#include "kernel/pin_hole.h"

#include <assert.h>
#include <math.h>
#include <pthread.h>

#define MEMBER_COLLIDER(id, word, collider) &collider,

const Collider *collider_get(OdeCollider kind)
{
    static const Collider *const COLLIDERS[] = {OPTIONS_ODE_COLLIDER_LIST(MEMBER_COLLIDER)};
    assert(kind < ODE_COLLIDER_COUNT);
    return COLLIDERS[kind];
}

typedef struct HoleData {
    double radius; // m
} HoleData;

static dColliderFn *collider_with(int other_class)
{
    return other_class == dCylinderClass ? hole_geom_collide : NULL;
}

// The box around the wall: a hole has no finite outside, and the wall is all that is ever asked
// for.
static void bounding_box(dGeomID hole, dReal box[6])
{
    const HoleData *data = dGeomGetClassData(hole);
    const dReal *centre = dGeomGetPosition(hole);
    for (int axis = 0; axis < 3; axis++) {
        box[2 * axis] = centre[axis] - data->radius;
        box[2 * axis + 1] = centre[axis] + data->radius;
    }
}

dGeomID hole_geom_create(double radius_m)
{
    // ODE keeps its classes for the life of the process, and only four of them
    static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;
    static int class_number = -1;
    pthread_mutex_lock(&lock);
    if (class_number < 0) {
        const dGeomClass class = {
            .bytes = sizeof(HoleData),
            .collider = collider_with,
            .aabb = bounding_box,
        };
        class_number = dCreateGeomClass(&class);
    }
    pthread_mutex_unlock(&lock);
    const dGeomID hole = dCreateGeom(class_number);
    HoleData *data = dGeomGetClassData(hole);
    data->radius = radius_m;
    return hole;
}

double hole_geom_radius(dGeomID hole)
{
    const HoleData *data = dGeomGetClassData(hole);
    return data->radius;
}

int hole_geom_collide(dGeomID hole, dGeomID pin, int flags, dContactGeom *contact, int skip)
{
    (void)skip; // only one contact is ever written
    assert((flags & 0xffff) >= 1);
    dReal pin_radius;
    dReal pin_length;
    dGeomCylinderGetParams(pin, &pin_radius, &pin_length);
    const HoleData *data = dGeomGetClassData(hole);
    const dReal *hole_position = dGeomGetPosition(hole);
    const dReal *pin_position = dGeomGetPosition(pin);
    const Vec2 hole_centre = {hole_position[0], hole_position[1]};
    const Vec2 pin_centre = {pin_position[0], pin_position[1]};
    const PinHole pose =
        pin_hole_pose(hole_centre, pin_centre, (Vec2){0.0, 0.0}, data->radius - pin_radius);
    if (!(pose.penetration > 0.0)) {
        return 0;
    }
    const Vec2 point = pin_hole_contact_point(&pose, hole_centre, data->radius);
    *contact = (dContactGeom){
        .pos = {point.x, point.y, 0.0},
        .normal = {-pose.normal.x, -pose.normal.y, 0.0},
        .depth = pose.penetration,
        .g1 = hole,
        .g2 = pin,
        .side1 = -1,
        .side2 = -1,
    };
    return 1;
}

// Finds the side of a polygon that a pin inside it touches.
//
// Side i of a regular polygon, outward normal n_i, at the distance a: overlap e . n_i - (a - r).
// The largest e . n_i is that of the normal nearest the direction of e, so that one side is asked
// instead of all N. A broad phase by boxes could not choose: a pin in its hole meets the boxes of
// nearly all sides.

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
