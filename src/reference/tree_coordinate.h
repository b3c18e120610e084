// The limited coordinate of a joint that turns or meshes (model/coordinate.h) in a tree, counted
// from an origin in its play: the angle that the joint's bodies were placed with, the middle of a
// gap between teeth. What it has changed since the base has all the digits of a double, and that at
// the base comes from long double, however many turns the bodies have made.
#pragma once

#include "reference/tree_state.h"

// The parts that bodies' turns have in a coordinate, rad or m per rad: of body a, body b and the
// carrier of gears.
enum { TREE_COORDINATE_PARTS = 3 };

typedef struct TreeCoordinatePart {
    int body; // LINKAGE_GROUND where there is none
    double share;
} TreeCoordinatePart;

void tree_coordinate_parts(const Joint *joint, TreeCoordinatePart parts[TREE_COORDINATE_PARTS]);

// What it counts from, rad or m.
double tree_coordinate_origin(const Joint *joint);

// Works it out at the base.
void tree_coordinate_settle(Tree *tree, int joint);

double tree_coordinate(const Tree *tree, const TreeState *state, int joint);
double tree_coordinate_rate(const Tree *tree, const TreeState *state, int joint);

// After tree_accelerate.
double tree_coordinate_second(const Tree *tree, const TreeState *state, int joint);

// The sums of the sizes of what the coordinate and its rate are made of, for their rounding.
void tree_coordinate_sizes(const Tree *tree, const TreeState *state, int joint, double *position,
                           double *speed);
