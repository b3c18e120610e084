// The equations that say how a tree with loops accelerates in space under forces on its bodies:
// reference/plane/articulated.h with six rows a body, and at most five of each loop.
//     M x = B^T f + J^T lambda,   J x = g
#pragma once

#include "reference/articulated_plan.h"
#include "reference/space/space_tree.h"

// What the elimination works with: pushes on the bodies, and the rows of the loops.

// A force at a body's centre, N, and the moment about it, N m.
typedef struct SpacePush {
    Vec3 force;
    Vec3 moment;
} SpacePush;

// A row of a loop: of its point along a direction of the world, or of its turning about one. One
// that is not active has no part in the equations.
typedef struct SpaceLoopRow {
    bool is_active;
    Vec3 direction;
} SpaceLoopRow;

typedef struct SpaceLink SpaceLink;   // of reference/space/space_articulated.c
typedef struct SpaceFront SpaceFront; // likewise

typedef struct SpaceArticulated {
    const SpaceTree *tree;
    Plan plan;
    ArticulatedParts parts;
    int *loops; // joints
    SpaceLink *links;
    SpaceFront *fronts;
} SpaceArticulated;

// For the loops of some joints. The tree must outlive it. Never NULL; the caller destroys it.
SpaceArticulated *space_articulated_create(const SpaceTree *tree, size_t loop_count,
                                           const int *loops);
void space_articulated_destroy(SpaceArticulated *articulated);

// Eliminates the unknowns at a state of the tree, with the loops' rows, SPACE_JOINT_ROWS each, the
// first SPACE_POINT_ROWS of their points. Returns false where the equations have no solution.
bool space_articulated_factor(SpaceArticulated *articulated, const SpaceTreeState *state,
                              const SpaceLoopRow *rows);

// Solves them at that state for pushes, by body (NULL: none), and the right sides of the loops'
// rows (NULL: zeros). Writes the coordinates' rates x, and behind them the negative multipliers of
// the rows: 0 of one that is not active.
void space_articulated_solve(SpaceArticulated *articulated, const SpaceTreeState *state,
                             const SpacePush *pushes, const double *sides, double *rates);

// The same of a part of the tree (SpaceArticulated.parts) and sides of zeros: reads the pushes and
// writes the rates of its bodies and loops alone.
void space_articulated_solve_part(SpaceArticulated *articulated, size_t part,
                                  const SpaceTreeState *state, const SpacePush *pushes,
                                  double *rates);

// The ideal joints that close loops of a tree in space: the rows that hold them, and how they are
// kept.
//
// Of a joint's five rows (model/space_rows.h) only those count that do not follow from others: a
// planar loop needs two, one whose axes lie anyhow five. They are chosen at the base; where others
// have become fitter they are chosen anew.

// Loops that share coordinates, directly or by way of others (reference/space/space_loops.c).
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
    size_t row_count;      // that are active
    SpaceLoopGroups groups;
    SpaceArticulated *articulated;
    double *sides;  // room: by row
    double *solved; // room: by coordinate and by row
} SpaceLoops;

// For the loops of some joints of a tree, which must outlive them. No row is active yet.
SpaceLoops *space_loops_create(const SpaceTree *tree, size_t count, const int *joints);
void space_loops_destroy(SpaceLoops *loops);

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

// Brings the directions of all rows that are active to a state.
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
// each pin is brought to its start in the hole as well, as in the plane
// (reference/plane/articulated.h).
void space_loops_start(SpaceTree *tree, SpaceLoops *loops, double *q, double *u,
                       SpaceTreeState *scratch);
