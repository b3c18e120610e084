// The two scalar rows in which a joint holds its bodies, or would if it had no play.
//
// Of a revolute joint and of a pin in a hole: x and y, in the world, of the anchor on body b less
// that on body a. Of a prismatic joint and of a block between guides: the distance of body b's
// anchor from the line of body a, along the line's normal (its direction turned by a quarter turn
// counter-clockwise); and the tilt, the angle of body b less that of body a less the angle held. A
// stop has no rows, and nor has a pair of gears.
#pragma once

#include "model/linkage.h"

enum { JOINT_ROWS = 2 };

// What a row's rate is made of: the sum over both sides of x v_x + y v_y + turn omega, v the
// velocity of the body's centre. A side on the ground has coefficients like any other.
typedef struct JointRow {
    double x[2];    // 1, by side: 0 body a, 1 body b
    double y[2];    // 1
    double turn[2]; // m, or 1 of an angle
} JointRow;

typedef struct JointRows {
    JointRow rows[JOINT_ROWS];
    double position[JOINT_ROWS]; // m, or rad of an angle: 0 where the joint is closed
    double rate[JOINT_ROWS];     // m/s, or rad/s
    double bias[JOINT_ROWS];     // m/s^2, or rad/s^2: the rate's own rate without accelerations
} JointRows;

// The number of rows of a kind of joint: JOINT_ROWS, or 0 of stops and gears.
static inline size_t joint_rows_count(JointKind kind)
{
    return joint_holds(kind) ? JOINT_ROWS : 0;
}

// Whether a row of a kind of joint is an angle rather than a length.
static inline bool joint_rows_is_angle(JointKind kind, size_t row)
{
    return row == 1 && joint_slides(kind);
}

// The number of rows of all joints, the drive's apart.
size_t joint_rows_total(const Linkage *linkage);

// How far a joint's rows are from what is asked of them, m: of two lengths the length of the
// vector; an angle counts as the arc that it is at the reach of the joint's bodies.
double joint_rows_size(const Linkage *linkage, int joint, Vec2 rows);

// Where a joint starts, in its rows: 0 of an ideal one.
Vec2 joint_rows_start(const Joint *joint);

// Lets a joint start there; nothing of one that has no play in its rows.
void joint_rows_set_start(Joint *joint, Vec2 rows);

// Writes the rows of a joint where the bodies are and as they move.
void joint_rows_find(const Linkage *linkage, const Motion *motions, int joint, JointRows *rows);

// The unit vector along the line or the guides of a joint (of a stop its normal), in the world.
Vec2 joint_rows_along(const Linkage *linkage, const Motion *motions, int joint);
