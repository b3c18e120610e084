// The ideal joints that close loops of a tree: their constraint rows, and how they are kept.
#pragma once

#include "reference/tree.h"

// Velocity of a pair's end on body b less that of the end on body a, by each coordinate (a vector
// each); of a pair with a line less that of the point of body a under the end on body b.
void loops_pair_row(const Tree *tree, const TreeState *state, int pair, Vec2 *row);

// The two rows of the joint that closes a loop, in x and y (model/joint_rows.h).
void loops_row(const Tree *tree, const TreeState *state, size_t loop, Vec2 *row);

// The rates of these rows while the coordinates' rates are steady, m/s^2 or rad/s^2.
Vec2 loops_bias(const Tree *tree, const TreeState *state, size_t loop);

// Moves coordinates and rates by the least that closes every loop, at a time since the base.
// Returns the largest gap left in any loop, m (of a tilt with a lever of a metre); 0 where there
// are none.
double loops_project(const Tree *tree, double since_s, double *q, double *u);

// Moves the base, coordinates and rates of a start onto the closed loops. Where there is a driver
// each pin is brought to its start in the hole as well, and each block to its own: a start is known
// to the rounding of positions, and a play of a micron has few digits left of that.
void loops_start(Tree *tree, double *q, double *u);
