// The freedoms of a linkage as a tree (reference/tree_state.h): found, moved and put to use.
#pragma once

#include "reference/tree_state.h"

// Finds the tree of the linkage's ideal joints.
void tree_build(const Linkage *linkage, Tree *tree);

// Puts the base at given motions at time zero, and writes the coordinates' rates there.
void tree_start(Tree *tree, const Motion *motions, double *u);

// Moves the base on to a time and coordinates since the present one, and zeroes the coordinates.
void tree_rebase(Tree *tree, double since_s, double *q);

// The time, s, that lies so long after the base.
double tree_time(const Tree *tree, double since_s);

// Positions, velocities, columns and bias, from time and coordinates since the base and from rates.
void tree_evaluate(const Tree *tree, double since_s, const double *q, const double *u,
                   TreeState *state);

// Fills in the accelerations from the coordinates' second rates.
void tree_accelerate(const Tree *tree, const double *rates, TreeState *state);
