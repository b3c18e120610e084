// The ideal joints that close loops of a tree in space: the rows that hold them, and how they are
// kept.
//
// Of a joint's five rows (model/space_rows.h) only those count that do not follow from others: a
// planar loop needs two, one whose axes lie anyhow five. They are chosen at the base; where others
// have become fitter they are chosen anew.
#pragma once

#include "reference/space_tree.h"

enum { SPACE_LOOPS_ROW_MAX = SPACE_TREE_COORDINATE_MAX };

typedef struct SpaceLoopRow {
    int joint;
    int which; // 0, 1, 2: the gap along the world's x, y, z; 3, 4: the axis across two directions
} SpaceLoopRow;

typedef struct SpaceLoops {
    size_t row_count;
    SpaceLoopRow rows[SPACE_LOOPS_ROW_MAX];
    Vec3 base_sides[SPACE_JOINT_MAX][2]; // of body a: unit, at right angles to the joint's axis
} SpaceLoops;

// Chooses the rows at the base of the tree; the first time, or anew.
void space_loops_choose(const SpaceTree *tree, const SpaceTreeState *state, bool is_first,
                        SpaceLoops *loops);

// The velocity in a row by each coordinate.
void space_loops_row(const SpaceTree *tree, const SpaceTreeState *state, const SpaceLoops *loops,
                     size_t row, double *by_coordinate);

// The acceleration in a row, m/s^2 or rad/s^2, while the coordinates' rates are steady.
double space_loops_bias(const SpaceTree *tree, const SpaceTreeState *state, const SpaceLoops *loops,
                        size_t row);

// Direction of a row: that of its force on body b, or of its moment (which 3 and 4).
Vec3 space_loops_direction(const SpaceTree *tree, const SpaceTreeState *state,
                           const SpaceLoops *loops, size_t row);

// Moves coordinates and rates by the least that closes every loop, at a time since the base.
// Returns how far the rows are still open, m or rad; 0 where there are none.
double space_loops_project(const SpaceTree *tree, const SpaceLoops *loops, double since_s,
                           double *q, double *u, SpaceTreeState *scratch);

// The joint of a row that was not chosen and has opened, by more than rounding of a case's lengths
// explains: the loop cannot be kept closed. -1 where there is none.
int space_loops_torn(const SpaceTree *tree, const SpaceTreeState *state, const SpaceLoops *loops);

// Moves the base, coordinates and rates of a start onto the closed loops. Where there is a driver
// each pin is brought to its start in the hole as well, as in the plane (reference/loops.h).
void space_loops_start(SpaceTree *tree, SpaceLoops *loops, double *q, double *u,
                       SpaceTreeState *scratch);
