// The freedoms of a linkage as a tree (reference/tree_state.h): found, moved and put to use.
#pragma once

#include "base/layout.h"
#include "reference/tree_state.h"

// The pairs that the places of a joint have of their own: those of corners and of a slider's stops.
// Returns how many, with the places.
size_t tree_own_pairs(const Joint *joint, int number, Touch places[TOUCH_CORNERS]);

// Finds the tree of the linkage's ideal joints, which must outlive it (reference/tree_build.c).
void tree_build(const Linkage *linkage, Tree *tree);
void tree_finish(Tree *tree);

// Takes room for the arrays of a state of this tree; the memory must be zeros.
void tree_state_lay(const Tree *tree, Layout *layout, TreeState *state);

// Puts the base at given motions at time zero, and writes the coordinates' rates there.
void tree_start(Tree *tree, const Motion *motions, double *u);

// Moves the base on to a time and coordinates since the present one, and zeroes the coordinates.
void tree_rebase(Tree *tree, double since_s, double *q);

// The time, s, that lies so long after the base.
double tree_time(const Tree *tree, double since_s);

// Positions, velocities and bias, from time and coordinates since the base and from rates.
void tree_evaluate(const Tree *tree, double since_s, const double *q, const double *u,
                   TreeState *state);

// The same of the two bodies of a pair alone, and of those that they hang on.
void tree_evaluate_pair(const Tree *tree, int pair, double since_s, const double *q,
                        const double *u, TreeState *state);

// Writes the coordinates that this depends on. Returns how many there are; 0 where it depends on
// all.
size_t tree_pair_coordinates(const Tree *tree, int pair, size_t *columns);

// Fills in the accelerations from the coordinates' second rates.
void tree_accelerate(const Tree *tree, const double *rates, TreeState *state);

// Adds to a row, a vector for each coordinate, how its rate moves a body's point on an arm from the
// centre, m, with a sign.
void tree_point_row(const Tree *tree, const TreeState *state, int body, Vec2 arm, double sign,
                    Vec2 *row);
