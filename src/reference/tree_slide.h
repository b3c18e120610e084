// Bodies that hang on a prismatic joint: their coordinate is the slide, their angle the parent's.
#pragma once

#include "reference/tree_line.h"

// Puts a body's centre where it has moved to.
static inline void tree_set_centre(const Tree *tree, int body, Vec2 moved, TreeState *state)
{
    const TreePoint base = tree->base_position[body];
    state->moved[body] = moved;
    state->motions[body].position = (Vec2){(double)base.x + moved.x, (double)base.y + moved.y};
}

// The columns of the parent's chain.
static inline void tree_copy_chain(const Tree *tree, const TreeNode *node, Vec2 *columns,
                                   const TreeState *state)
{
    if (node->chain_count > 1) {
        const Vec2 *above = state->columns[tree->node_of[node->parent]];
        for (size_t i = 0; i + 1 < node->chain_count; i++) {
            columns[i] = above[i];
        }
    }
}

// How a body that slides has turned: as the one it slides on.
void tree_slide_turn(const Tree *tree, const TreeNode *node, const double *q, const double *u,
                     TreeState *state);

// Where it is and how it moves, after its turn.
void tree_slide_move(const Tree *tree, const TreeNode *node, const double *q, const double *u,
                     Vec2 *columns, TreeState *state);
