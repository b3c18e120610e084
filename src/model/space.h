// A linkage in space: what its bodies and joints are beyond the plane, and how they move there.
//
// The mechanism is the one of model/linkage.h; z points out of the plane towards the viewer. At
// time zero every body's frame is turned about z alone, by the angle of its planar start, unless a
// run is continued (BodySpace.is_elsewhere). A joint
// is at the point of its planar anchors, at a height of its own, and has an axis; unless the case
// says otherwise that is z. A pin with play fills the hole's width, tilts and slides in it.
#pragma once

#include "base/vec3.h"
#include "model/linkage.h"

// How a body moves in space at one instant, in the world's frame.
typedef struct SpaceMotion {
    Vec3 position; // of the centre of mass, m
    Quat turn;     // from the body's frame to the world's
    Vec3 velocity; // m/s
    Vec3 omega;    // rad/s
    Vec3 acceleration;
    Vec3 alpha;
} SpaceMotion;

// Motions in the plane as motions in space, the bodies at their heights.
void space_lift(const Linkage *linkage, const Motion *planar, SpaceMotion *motions);

// The motions at time zero, at the speeds of the start.
void space_start(const Linkage *linkage, SpaceMotion *motions);

// Makes the speeds of a motion those of a body's start.
void space_set_start(const SpaceMotion *motion, Body *body);

// The same, and makes the place of a motion that at which the body starts, whatever its joints say.
void space_set_place(const SpaceMotion *motion, Body *body);

// Whether any body starts at such a place.
bool space_starts_elsewhere(const Linkage *linkage);

// The motion of the driven body at a time: about the axis of its joint with the ground.
SpaceMotion space_driven(const Linkage *linkage, double time_s);

// What the plane sees of a motion in space: x, y and the turning about z. The angle is that of the
// body's x axis, in one turn.
Motion space_planar(const SpaceMotion *motion);

// The matrix of inertia about the centre of mass, kg m^2, in the body's frame.
Mat3 space_inertia(const Body *body);

// The same in the world's frame: R I R'.
Mat3 space_world_inertia(const Body *body, Quat turn);

// A joint's point and axis on one of its sides (0 body a, 1 body b), in the frame of that body or
// of the ground.
typedef struct SpaceEnd {
    int body;
    Vec3 anchor;
    Vec3 axis; // unit
} SpaceEnd;

// A direction of the world at time zero in a body's frame.
Vec3 space_own_direction(const Body *body, Vec3 axis);

SpaceEnd space_end(const Linkage *linkage, size_t joint, int side);

// A point given in a body's frame (or the ground's) in the world's, its velocity, and a direction.
Vec3 space_point(const SpaceMotion *motions, int body, Vec3 local);
Vec3 space_direction(const SpaceMotion *motions, int body, Vec3 local);

// The velocity of the point of a body that is at a point of the world now; zero of the ground.
Vec3 space_velocity_at(const SpaceMotion *motions, int body, Vec3 point);

// Likewise its acceleration.
Vec3 space_acceleration_at(const SpaceMotion *motions, int body, Vec3 point);

// Sum (m v^2 + w' I w) / 2, and -sum m g . x, J, with gravity in m/s^2.
double space_kinetic_energy(const Linkage *linkage, const SpaceMotion *motions);
double space_potential_energy(const Linkage *linkage, const SpaceMotion *motions, Vec3 gravity);

// Whether some distribution of mass has the body's moments and products of inertia.
bool space_is_possible(const Body *body);

// Whether every joint's axis is z, so that the plane shows how the linkage moves until a pin tilts.
bool space_is_upright(const Linkage *linkage);

// Whether the plane shows how the linkage moves, but for the tilting of pins: it moves in the
// plane, or in space with upright axes.
bool space_has_plane(const Linkage *linkage);

// Fills in the moments of inertia about x and y that a case leaves out: those of a slender body
// along x.
void space_complete(Linkage *linkage);
