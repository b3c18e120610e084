// Positions, velocities and accelerations of any planar linkage whose joints are taken as ideal,
// by Newton's method and linear solves. The motion of the driver is given; everything else follows.
#pragma once

#include "model/linkage.h"

// A mechanism up to this size is small: its rows are solved as one dense matrix, and what takes
// many such solutions or all of the matrix (locks, reactions, the scale of spikes) is worked out of
// small ones alone. A larger one is solved by model/joint_system.h.
enum { KINEMATICS_BODY_MAX = 16, KINEMATICS_JOINT_MAX = 24 };

static inline bool kinematics_is_small(const Linkage *linkage)
{
    return linkage->body_count <= KINEMATICS_BODY_MAX &&
           linkage->joint_count <= KINEMATICS_JOINT_MAX;
}

// One row per scalar constraint, three columns (x, y, angle) per body, row by row.
enum {
    KINEMATICS_COLUMN_MAX = 3 * KINEMATICS_BODY_MAX,
    KINEMATICS_ROW_MAX = 2 * KINEMATICS_JOINT_MAX + LINKAGE_DRIVE_MAX,
};

typedef struct Jacobian {
    size_t rows;
    size_t columns;
    double entries[KINEMATICS_ROW_MAX * KINEMATICS_COLUMN_MAX];
} Jacobian;

// The constraint Jacobian of a small mechanism: two rows a joint for which `include` is true (all
// where it is NULL; a stop has none), then one row a drive where `with_driver` is set.
void kinematics_jacobian(const Linkage *linkage, const Motion *motions, const bool *include,
                         bool with_driver, Jacobian *jacobian);

// Adds a change, three numbers a body, to the positions and angles.
void kinematics_move(const Linkage *linkage, const double *change, Motion *motions);

// How many of these rows are independent, of a linkage of any size, and how many there are. Of a
// small mechanism a pivot counts that is above a share of the largest.
size_t kinematics_rank(const Linkage *linkage, const Motion *motions, const bool *include,
                       bool with_driver, double independent, size_t *rows);

// Whether ideal joints and drives together say where every body is.
bool kinematics_is_determined(const Linkage *linkage);

// The freedoms left with the drives free: three a body less the independent constraint rows.
// With `ideal_only`, joints with clearance are left open (two freedoms more each).
size_t kinematics_mobility(const Linkage *linkage, const Motion *motions, bool ideal_only);

// Moves the bodies so that every joint closes and the driver stands at the angle given, starting
// from the motions given; then sets velocities and accelerations for the driver's constant speed.
// Fails with ERR_SOLVER where the linkage does not close, is at a dead centre, or has not exactly
// one freedom; the motions are then untouched. Further drives stand where they start.
bool kinematics_solve(const Linkage *linkage, double crank_angle, Motion *motions, Err *err);

// The same for the states of all drives at a time, as many as there are; their messages have the
// first's angle.
bool kinematics_solve_driven(const Linkage *linkage, const DriveState *drives, Motion *motions,
                             Err *err);

// The same for the bodies' positions alone; the rest of the motions stays as it is. It fails where
// the other does, but for a large mechanism at a dead centre.
bool kinematics_place_driven(const Linkage *linkage, const DriveState *drives, Motion *motions,
                             Err *err);

// What a joint misses of being closed, in its rows: x and y of the second anchor against the first,
// m; of a prismatic joint or a guide the distance from its line, m, and its tilt, rad; 0 of a stop.
Vec2 kinematics_opening(const Linkage *linkage, const Motion *motions, int joint);

// The largest of what any joint misses of being closed, m; see joint_rows_size.
double kinematics_closure_error(const Linkage *linkage, const Motion *motions);
