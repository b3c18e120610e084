// Reads where a hinge or slider is and how fast, and pushes it.
//
// An angle is that of the turn of the first body seen from the second, about the axis: 2 atan2 of
// its quaternion's part along the axis and its real part. ODE's own getter takes the length of the
// whole vector part, and is wrong near 0 by what the hinge is out of line. A slider's is s = a .
// (x1 - x2), a turning with the second body: s' = a . (v1 - v2 - omega2 x (x1 - x2)), so that a
// force along a acts at the first body's centre.
#include "world/coordinate.h"

#include <math.h>
#include <string.h>

static void turn_of(dBodyID body, dQuaternion turn)
{
    static const dQuaternion NONE = {1.0, 0.0, 0.0, 0.0};
    memcpy(turn, body == NULL ? NONE : dBodyGetQuaternion(body), sizeof(dQuaternion));
}

static void position_of(dBodyID body, dVector3 position)
{
    static const dVector3 ORIGIN = {0.0, 0.0, 0.0, 0.0};
    memcpy(position, body == NULL ? ORIGIN : dBodyGetPosition(body), sizeof(dVector3));
}

static void into_body(dBodyID body, const dReal *world, dVector3 local)
{
    if (body == NULL) {
        memcpy(local, world, sizeof(dVector3));
    } else {
        dBodyVectorFromWorld(body, world[0], world[1], world[2], local);
    }
}

static void into_world(dBodyID body, const dReal *local, dVector3 world)
{
    if (body == NULL) {
        memcpy(world, local, sizeof(dVector3));
    } else {
        dBodyVectorToWorld(body, local[0], local[1], local[2], world);
    }
}

static double dot(const dReal *a, const dReal *b)
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void relative_turn(const Coordinate *coordinate, dQuaternion relative)
{
    dQuaternion first;
    dQuaternion second;
    turn_of(coordinate->bodies[0], first);
    turn_of(coordinate->bodies[1], second);
    dQMultiply1(relative, second, first);
}

// From the second body's centre to the first's, in the world.
static void distance(const Coordinate *coordinate, dVector3 between)
{
    dVector3 first;
    dVector3 second;
    position_of(coordinate->bodies[0], first);
    position_of(coordinate->bodies[1], second);
    for (int i = 0; i < 3; i++) {
        between[i] = first[i] - second[i];
    }
}

Coordinate coordinate_of(dJointID joint)
{
    Coordinate made = {
        .joint = joint,
        .is_angle = dJointGetType(joint) == dJointTypeHinge,
        .bodies = {dJointGetBody(joint, 0), dJointGetBody(joint, 1)},
    };
    dVector3 axis;
    if (made.is_angle) {
        dJointGetHingeAxis(joint, axis);
        made.start = dJointGetHingeAngle(joint);
    } else {
        dJointGetSliderAxis(joint, axis);
        made.start = dJointGetSliderPosition(joint);
    }
    into_body(made.bodies[1], axis, made.axis);
    relative_turn(&made, made.turn);
    dVector3 between;
    distance(&made, between);
    into_body(made.bodies[1], between, made.offset);
    return made;
}

// Since it was made, in (-pi, pi].
static double angle_since(const Coordinate *coordinate)
{
    dQuaternion now;
    dQuaternion since;
    relative_turn(coordinate, now);
    dQMultiply2(since, now, coordinate->turn);
    return remainder(2.0 * atan2(dot(&since[1], coordinate->axis), since[0]), 2.0 * M_PI);
}

double coordinate_read(Coordinate *coordinate)
{
    if (coordinate->is_angle) {
        const double change = remainder(angle_since(coordinate) - coordinate->last, 2.0 * M_PI);
        coordinate->last += change;
        return coordinate->start + coordinate->last;
    }
    dVector3 between;
    dVector3 local;
    distance(coordinate, between);
    into_body(coordinate->bodies[1], between, local);
    return coordinate->start + dot(local, coordinate->axis) -
           dot(coordinate->offset, coordinate->axis);
}

Direction coordinate_direction(const Coordinate *coordinate)
{
    dVector3 axis;
    into_world(coordinate->bodies[1], coordinate->axis, axis);
    if (coordinate->is_angle) {
        return direction_about(coordinate->bodies, axis);
    }
    dVector3 point;
    position_of(coordinate->bodies[coordinate->bodies[0] != NULL ? 0 : 1], point);
    return direction_along(coordinate->bodies, axis, point, point);
}
