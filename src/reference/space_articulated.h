// The equations that say how a tree with loops accelerates in space under forces on its bodies:
// reference/articulated.h with six rows a body, and at most five of each loop.
//     M x = B^T f + J^T lambda,   J x = g
#pragma once

#include "reference/space_articulated_links.h"

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
// the rows: 0 of one that is not held.
void space_articulated_solve(SpaceArticulated *articulated, const SpaceTreeState *state,
                             const SpacePush *pushes, const double *sides, double *rates);

// The same of a part of the tree (SpaceArticulated.parts) and sides of zeros: reads the pushes and
// writes the rates of its bodies and loops alone.
void space_articulated_solve_part(SpaceArticulated *articulated, size_t part,
                                  const SpaceTreeState *state, const SpacePush *pushes,
                                  double *rates);
