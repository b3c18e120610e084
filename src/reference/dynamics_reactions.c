// With which forces do the ideal joints hold their bodies?
//
// Of joints that close loops the multipliers' negatives. Of those that bodies hang on, children
// before parents, what the body's own equations leave over:
//     force  m a - F,   couple about the anchor  I al - M - s x force
// F, M: the other forces on the body and their moment about its centre; s from the centre to the
// anchor. A prismatic joint's force acts where the anchor on body b is, on both bodies.
#include "reference/dynamics_reactions.h"

#include "reference/tree.h"

// Where the force of a joint acts on one of its sides: from the end to the anchor on body b.
static Vec2 beside(const Tree *tree, const TreeState *state, int end)
{
    const bool is_on_line = tree->measures[end / 2] == TREE_LINE;
    return is_on_line && end % 2 == 0 ? tree_pair_gap(tree, state, end / 2) : (Vec2){0.0, 0.0};
}

// The joint's force and couple on its body b, on its bodies.
static void load_joint(const Tree *tree, int joint, Loads *loads, DynamicsState *state)
{
    for (int side = 0; side < 2; side++) {
        const double sign = side == 0 ? -1.0 : 1.0;
        const int end = 2 * joint + side;
        dynamics_load_end(tree, &state->tree, end, beside(tree, &state->tree, end),
                          vec2_scale(sign, state->reactions[joint]), loads);
        if (tree->measures[joint] == TREE_LINE) {
            dynamics_load_couple(tree, &state->tree, tree->end_bodies[end],
                                 sign * state->couples[joint], loads);
        }
    }
}

static void find_loops(const Tree *tree, const double *solved, Loads *loads, DynamicsState *state)
{
    for (size_t loop = 0; loop < tree->loop_count; loop++) {
        const int joint = tree->loops[loop];
        const double *lambda = solved + tree->coordinate_count + 2 * loop;
        state->reactions[joint] = (Vec2){-lambda[0], -lambda[1]};
        state->couples[joint] = 0.0;
        if (tree->measures[joint] == TREE_LINE) {
            const Vec2 normal = tree_normal(tree, &state->tree, joint);
            state->reactions[joint] = vec2_scale(-lambda[0], normal);
            state->couples[joint] = -lambda[1];
        }
        load_joint(tree, joint, loads, state);
    }
}

// What a body that hangs needs of its joint beyond its other forces, on the body: the force, and
// the couple where that force acts.
static void find_held(const Tree *tree, const TreeNode *node, const Loads *loads,
                      DynamicsState *state)
{
    const Body *body = &tree->linkage->bodies[node->body];
    const Motion *motion = &state->tree.motions[node->body];
    const Vec2 held =
        vec2_sub(vec2_scale(body->mass, motion->acceleration), loads->pushes[node->body].force);
    const double sign = node->own_end % 2 == 1 ? 1.0 : -1.0;
    state->reactions[node->joint] = sign > 0.0 ? held : vec2_scale(-1.0, held);
    state->couples[node->joint] = 0.0;
    if (node->is_sliding) {
        const Vec2 arm =
            vec2_add(state->tree.arms[node->own_end], beside(tree, &state->tree, node->own_end));
        const double moment = body->inertia * motion->alpha - loads->pushes[node->body].moment;
        state->couples[node->joint] = sign * (moment - vec2_cross(arm, held));
    }
}

// Fills in the reactions of the joints that bodies hang on.
static void find_tree(const Tree *tree, Loads *loads, DynamicsState *state)
{
    for (size_t i = tree->node_count; i-- > 0;) {
        const TreeNode *node = &tree->nodes[i];
        if (node->joint >= 0) {
            find_held(tree, node, loads, state);
            const double sign = node->own_end % 2 == 1 ? -1.0 : 1.0;
            dynamics_load_end(tree, &state->tree, node->parent_end,
                              beside(tree, &state->tree, node->parent_end),
                              vec2_scale(sign, state->reactions[node->joint]), loads);
            if (node->is_sliding) {
                dynamics_load_couple(tree, &state->tree, node->parent,
                                     sign * state->couples[node->joint], loads);
            }
        }
    }
}

void dynamics_reactions_find(const Dynamics *dynamics, const double *solved, Loads *loads,
                             DynamicsState *state)
{
    tree_accelerate(&dynamics->tree, solved, &state->tree);
    find_loops(&dynamics->tree, solved, loads, state);
    find_tree(&dynamics->tree, loads, state);
}
