// How does a body follow the one that it slides on?
//
// It slides by x along the direction t of body a turns with its parent p, w_i = w_p = w, and
// with r = r_i - r_p and + where it is body b, - where it is body a:
//     r_i = r_p + R_p s_p +- x t - R_i s_i
//     v_i = v_p + w z x r +- x' t
//     a_i = a_p + al_p z x r - w^2 r +- (x'' t + 2 w x' z x t)
#include "reference/tree_slide.h"

void tree_slide_move(const Tree *tree, size_t number, const double *q, const double *u,
                     TreeState *state)
{
    const TreeNode *node = &tree->nodes[number];
    Motion *motion = &state->motions[node->body];
    const double slide = q[node->column];
    const double speed = u[node->column];
    // from the direction's normal to what moves the body
    const double sign = node->own_end % 2 == 1 ? -1.0 : 1.0;
    const Vec2 along = vec2_scale(sign, vec2_perp(tree_normal(tree, state, node->joint)));
    const Vec2 turned = vec2_scale(sign, vec2_perp(tree_normal_turned(tree, state, node->joint)));
    const double before = (double)tree->base_slide[node->body];
    const Vec2 moved = vec2_add(vec2_scale(slide, along), vec2_scale(before, turned));
    tree_set_centre(tree, node->body,
                    vec2_add(vec2_sub(tree_end_moved(tree, state, node->parent_end),
                                      state->turned[node->own_end]),
                             moved),
                    state);
    // from the parent's end to the body's centre
    const Vec2 behind = vec2_sub(vec2_scale(before + slide, along), state->arms[node->own_end]);
    const double omega = motion->omega;
    motion->velocity = vec2_add(vec2_add(tree_end_velocity(tree, state, node->parent_end),
                                         vec2_scale(omega, vec2_perp(behind))),
                                vec2_scale(speed, along));
    state->bias[node->body] = vec2_add(
        vec2_sub(tree_end_bias(tree, state, node->parent_end), vec2_scale(omega * omega, behind)),
        vec2_scale(2.0 * omega * speed, vec2_perp(along)));
    const double alpha = tree_bias_alpha(tree, node->body);
    if (alpha != 0.0) {
        state->bias[node->body] =
            vec2_add(state->bias[node->body], vec2_scale(alpha, vec2_perp(behind)));
    }
    state->along[number] = along;
    state->behind[number] =
        node->parent == LINKAGE_GROUND ? behind : vec2_add(state->arms[node->parent_end], behind);
}

Vec2 tree_slide_acceleration(const Tree *tree, size_t number, double rate, const TreeState *state)
{
    const TreeNode *node = &tree->nodes[number];
    const Vec2 acceleration =
        vec2_add(state->bias[node->body], vec2_scale(rate, state->along[number]));
    if (node->parent == LINKAGE_GROUND) {
        return acceleration;
    }
    // what the parent does beyond its own bias
    const Motion *parent = &state->motions[node->parent];
    const Vec2 beyond = vec2_sub(parent->acceleration, state->bias[node->parent]);
    const double spun = parent->alpha - tree_bias_alpha(tree, node->parent);
    return vec2_add(acceleration,
                    vec2_add(beyond, vec2_scale(spun, vec2_perp(state->behind[number]))));
}

void tree_slide_turn(const Tree *tree, const TreeNode *node, const double *q, const double *u,
                     TreeState *state)
{
    Motion *motion = &state->motions[node->body];
    double *turn = &state->turn[node->body];
    if (node->angle_column >= 0) {
        *turn = q[node->angle_column];
        motion->omega = u[node->angle_column];
    } else {
        *turn = node->parent == LINKAGE_GROUND ? 0.0 : state->turn[node->parent];
        motion->omega = tree_omega(state, node->parent);
    }
    motion->angle = (double)tree->base_angle[node->body] + *turn;
}
