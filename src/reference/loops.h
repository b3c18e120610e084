// The ideal joints that close loops of a tree: their constraint rows, and how they are kept.
#pragma once

#include "reference/tree.h"

// Velocity of a joint's anchor on body b less that on body a, by each coordinate (a vector each).
void loops_joint_row(const Tree *tree, const TreeState *state, int joint, Vec2 *row);

// Likewise, of the joint that closes a loop.
void loops_row(const Tree *tree, const TreeState *state, size_t loop, Vec2 *row);

// Moves coordinates and rates by the least that closes every loop, at a time since the base.
// Returns the largest gap left in any loop, m; 0 where there are none.
double loops_project(const Tree *tree, double since_s, double *q, double *u);

// Moves the base, coordinates and rates of a start onto the closed loops. Where there is a driver
// each pin is brought to its start in the hole as well: a start is known to the rounding of
// positions, and a play of a micron has few digits left of that.
void loops_start(Tree *tree, double *q, double *u);
