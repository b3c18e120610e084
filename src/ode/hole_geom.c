// How does ODE learn of a pin in a hole?
#include "ode/hole_geom.h"

#include "kernel/pin_hole.h"

#include <assert.h>

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
    static int class_number = -1;
    if (class_number < 0) {
        const dGeomClass class = {
            .bytes = sizeof(HoleData),
            .collider = collider_with,
            .aabb = bounding_box,
        };
        class_number = dCreateGeomClass(&class);
    }
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
