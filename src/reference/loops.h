// The ideal joints that close loops of a tree: their constraint rows, and how they are kept.
#pragma once

#include "reference/articulated.h"

// Adds to a row, a vector for each coordinate, the velocity of a pair's end on body b less that of
// the end on body a; of a pair with a line less that of the point of body a under the end on body
// b.
void loops_pair_row(const Tree *tree, const TreeState *state, int pair, Vec2 *row);

// The rates of the two rows of a joint that closes a loop (model/joint_rows.h) while the
// coordinates' rates are steady, m/s^2 or rad/s^2.
Vec2 loops_bias(const Tree *tree, const TreeState *state, size_t loop);

// What closing loops needs: a tree and the loops of some of its joints, and room to work in.
typedef struct LoopsRoom {
    const Tree *tree;
    size_t loop_count;
    const int *loops; // their joints
    Articulated *articulated;
    TreeState *state;
    ArticulatedPush *pushes; // by body: zeros
    double *sides;           // two a loop
    double *solved;          // by coordinate, and two a loop
} LoopsRoom;

// Moves coordinates and rates by the least that closes every loop, at a time since the base: the
// least in the bodies' kinetic energy. Returns the largest gap left in any loop, m (of a tilt with
// a lever of a metre); 0 where there are none.
double loops_project(const LoopsRoom *room, double since_s, double *q, double *u);

// Moves the base, coordinates and rates of a start onto the closed loops. Where there is a driver
// each pin is brought to its start in the hole as well, and each block to its own: a start is known
// to the rounding of positions, and a play of a micron has few digits left of that.
void loops_start(Tree *tree, const LoopsRoom *room, double *q, double *u);
