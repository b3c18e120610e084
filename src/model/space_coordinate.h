// The angle of a revolute joint in space that flanks or stops limit (model/coordinate.h in space):
// how far body b has turned about the joint's axis against body a, the other way round where b is
// the ground. At time zero it is what it is in the plane where the axis is z; else it is zero.
#pragma once

#include "model/coordinate.h"
#include "model/space_rows.h"

// The angle at time zero, rad.
double space_coordinate_start(const Linkage *linkage, int joint);

// The angle of bodies that move so, rad: of all that differ by turns the one nearest to a value.
double space_coordinate_near(const Linkage *linkage, const SpaceMotion *motions, int joint,
                             double near);

// The axis about which the turned body turns as the angle grows, with the sign of that; unit.
Vec3 space_coordinate_axis(const Linkage *linkage, const SpaceMotion *motions, int joint);

// The rate of the angle, rad/s, and the row that it is.
double space_coordinate_rate(const Linkage *linkage, const SpaceMotion *motions, int joint);
SpaceRow space_coordinate_row(const Linkage *linkage, const SpaceMotion *motions, int joint);
