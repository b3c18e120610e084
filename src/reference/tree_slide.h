// Bodies that hang on a prismatic joint: their coordinate is the slide, their angle the parent's.
#pragma once

#include "reference/tree_line.h"

// Puts a body's centre where it has moved to.
static inline void tree_set_centre(const Tree *tree, int body, Vec2 moved, TreeState *state)
{
    state->moved[body] = moved;
    state->motions[body].position = vec2_add(tree->base_motions[body].position, moved);
}

// How a body that slides has turned: as the one it slides on.
void tree_slide_turn(const Tree *tree, const TreeNode *node, const double *q, const double *u,
                     TreeState *state);

// Where a node is and how it moves, after its turn.
void tree_slide_move(const Tree *tree, size_t number, const double *q, const double *u,
                     TreeState *state);

// The acceleration of its centre, m/s^2, from that of its parent and the second rate of its slide.
Vec2 tree_slide_acceleration(const Tree *tree, size_t number, double rate, const TreeState *state);
