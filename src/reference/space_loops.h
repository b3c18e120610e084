// The ideal joints that close loops of a tree in space: the rows that hold them, and how they are
// kept.
//
// Of a joint's five rows (model/space_rows.h) only those count that do not follow from others: a
// planar loop needs two, one whose axes lie anyhow five. They are chosen at the base; where others
// have become fitter they are chosen anew.
#pragma once

#include "reference/space_articulated.h"

// Loops that share coordinates, directly or by way of others (reference/space_loops_choose.c).
typedef struct SpaceLoopGroups {
    size_t count;
    size_t *first_loop; // by group and one more: where its loops begin
    size_t *loops;      // group by group
    size_t *widths;     // by group: coordinates that its loops move by
    int *meetings;      // by loop: the innermost node that both its ends hang on, or -1
    size_t *columns;    // by node in a loop: its first coordinate among those of its group
} SpaceLoopGroups;

typedef struct SpaceLoops {
    const SpaceTree *tree;
    size_t count;
    int *joints;           // owned, like all below
    Vec3 (*base_sides)[2]; // of body a: unit, at right angles to the joint's axis
    SpaceLoopRow *rows;    // SPACE_JOINT_ROWS of each
    size_t row_count;      // that are held
    SpaceLoopGroups groups;
    SpaceArticulated *articulated;
    double *sides;  // room: by row
    double *solved; // room: by coordinate and by row
} SpaceLoops;

// For the loops of some joints of a tree, which must outlive them. No row is held yet.
SpaceLoops *space_loops_create(const SpaceTree *tree, size_t count, const int *joints);
void space_loops_destroy(SpaceLoops *loops);

void space_loop_groups_init(const SpaceTree *tree, size_t count, const int *joints,
                            SpaceLoopGroups *groups);
void space_loop_groups_finish(SpaceLoopGroups *groups);

// The number of a node's coordinates, and the node at an end of a joint.
static inline size_t space_loop_groups_freedoms(const SpaceNode *node)
{
    return node->joint < 0 ? SPACE_FREEDOMS : 1;
}

static inline int space_loop_groups_end(const SpaceTree *tree, int joint, int side)
{
    return space_tree_node_of(tree, tree->ends[2 * joint + side].body);
}

// Chooses the rows at the base of the tree; the first time, or anew.
void space_loops_choose(SpaceLoops *loops, const SpaceTreeState *state, bool is_first);

// Direction of a row of a loop: that of its force on body b, or of its moment (3 and 4).
Vec3 space_loops_direction(const SpaceLoops *loops, const SpaceTreeState *state, size_t loop,
                           int which);

// Brings the directions of all rows that are held to a state.
void space_loops_turn(SpaceLoops *loops, const SpaceTreeState *state);

// The acceleration in a row, m/s^2 or rad/s^2, while the coordinates' rates are steady. Its
// direction is that of the state.
double space_loops_bias(const SpaceLoops *loops, const SpaceTreeState *state, size_t loop,
                        int which);

// Moves coordinates and rates by the least in the bodies' kinetic energy that closes every loop, at
// a time since the base. Returns how far the rows are still open, m or rad; 0 where there are none.
double space_loops_project(SpaceLoops *loops, double since_s, double *q, double *u,
                           SpaceTreeState *scratch);

// The joint of a row that was not chosen and has opened, by more than rounding of a case's lengths
// explains: the loop cannot be kept closed. -1 where there is none.
int space_loops_torn(const SpaceLoops *loops, const SpaceTreeState *state);

// Moves the base, coordinates and rates of a start onto the closed loops. Where there is a driver
// each pin is brought to its start in the hole as well, as in the plane (reference/loops.h).
void space_loops_start(SpaceTree *tree, SpaceLoops *loops, double *q, double *u,
                       SpaceTreeState *scratch);
