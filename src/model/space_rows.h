// The constraint rows of joints in space, taken as ideal.
//
// A joint has five: its point on body b stays at that on body a (world's x, y, z), and its axis on
// body b stays along that on body a (two directions at right angles to it). A loop of joints whose
// axes are parallel, as every planar mechanism is, has rows that follow from others.
#pragma once

#include "model/space.h"

enum {
    SPACE_JOINT_ROWS = 5,
    SPACE_POINT_ROWS = 3, // of those, the first
    SPACE_FREEDOMS = 6,   // of a body: its velocity, then its angular velocity, in the world
};

// A relative velocity as a sum over two bodies: of each, linear . v + angular . omega. The ground
// has no part in it.
typedef struct SpaceRow {
    int body[2]; // a and b
    Vec3 linear[2];
    Vec3 angular[2];
} SpaceRow;

// Writes the rows of a joint, body b against body a.
void space_rows_of_joint(const Linkage *linkage, const SpaceMotion *motions, size_t joint,
                         SpaceRow rows[SPACE_JOINT_ROWS]);

// The row of a unit vector: the velocity along it of a point of body b against one of body a, both
// given in the world.
SpaceRow space_row_along(const SpaceMotion *motions, int body_a, Vec3 at_a, int body_b, Vec3 at_b,
                         Vec3 direction);

// How far the joint is open in each of its rows: m, m, m, rad, rad.
void space_rows_opening(const Linkage *linkage, const SpaceMotion *motions, size_t joint,
                        double openings[SPACE_JOINT_ROWS]);

// The velocity in a row.
double space_row_speed(const SpaceRow *row, const SpaceMotion *motions);

// The freedoms of all bodies, the driven one included, that joints leave: all of them, or the ideal
// ones alone.
size_t space_rows_mobility(const Linkage *linkage, const SpaceMotion *motions, bool ideal_only);

// Chooses rows that are independent, joint by joint in the order of the linkage, of the joints
// whose flag is set (by joint): bit k of chosen[joint] stands for its row k. Bodies that a driver
// moves give no freedom. Returns the number chosen. Joints that fit together leave the others
// redundant at the motions given and nowhere else for certain.
size_t space_rows_choose(const Linkage *linkage, const SpaceMotion *motions, const bool *is_asked,
                         unsigned *chosen);

// The same, but the points of all joints before the directions of their axes: what is left out is
// of axes wherever the points alone are independent. Where some are left out, of a linkage with few
// joints, those are taken of which the most is independent.
size_t space_rows_choose_points(const Linkage *linkage, const SpaceMotion *motions,
                                const bool *is_asked, unsigned *chosen);

// The least share of a chosen row of an axis that is independent of those before it: 1 of rows at
// right angles, 0 where one follows from the others.
double space_rows_least_share(const Linkage *linkage, const SpaceMotion *motions,
                              const bool *is_asked, const unsigned *chosen);
