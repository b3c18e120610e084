// How do bodies follow the coordinates that move a linkage?
//
// A body i that hangs by its anchor s_i on the anchor s_p of its parent p, arms R s:
//     r_i = r_p + R_p s_p - R_i s_i
//     v_i = v_p + w_p z x R_p s_p - w_i z x R_i s_i
//     a_i = a_p + al_p z x R_p s_p - w_p^2 R_p s_p - al_i z x R_i s_i + w_i^2 R_i s_i
// The terms without second rates are the bias. Angles are absolute, so each body's own is one
// coordinate. Source: Haug 1989, velocity transformations.
#include "reference/tree.h"

#include "reference/tree_slide.h"
#include "reference/turned.h"

// Turns a body's ends by an angle d since the base.
static inline void set_arms(const Tree *tree, int body, double d, TreeState *state)
{
    const TurnedBy by = turned_by(d);
    const size_t last = tree->end_firsts[body + 1];
    for (size_t i = tree->end_firsts[body]; i < last; i++) {
        const int end = tree->ends[i];
        const Vec2 arm = tree->base_arms[end];
        const Vec2 turned = turned_arm(&by, arm);
        state->turned[end] = turned;
        state->arms[end] = vec2_add(arm, turned);
    }
}

static void set_driven(const Tree *tree, double since_s, TreeState *state)
{
    const DriveState *base = &tree->base_drive;
    Motion *motion = &state->motions[tree->driven];
    const double turned = (base->omega + 0.5 * base->alpha * since_s) * since_s;
    const double omega = base->omega + base->alpha * since_s;
    motion->angle = tree->base_motions[tree->driven].angle + turned;
    motion->omega = omega;
    motion->alpha = base->alpha;
    state->turn[tree->driven] = turned;
    set_arms(tree, tree->driven, turned, state);
    const int end = 2 * tree->linkage->driver.joint + 1;
    const Vec2 arm = state->arms[end];
    tree_set_centre(tree, tree->driven, vec2_scale(-1.0, state->turned[end]), state);
    motion->velocity = vec2_scale(-omega, vec2_perp(arm));
    motion->acceleration =
        vec2_sub(vec2_scale(omega * omega, arm), vec2_scale(base->alpha, vec2_perp(arm)));
    state->bias[tree->driven] = motion->acceleration;
}

static inline void set_floating(const Tree *tree, const TreeNode *node, const double *q,
                                const double *u, TreeState *state)
{
    const size_t column = node->column;
    tree_set_centre(tree, node->body, (Vec2){q[column - 2], q[column - 1]}, state);
    state->motions[node->body].velocity = (Vec2){u[column - 2], u[column - 1]};
    state->bias[node->body] = (Vec2){0.0, 0.0};
}

static inline void set_hanging(const Tree *tree, const TreeNode *node, TreeState *state)
{
    Motion *motion = &state->motions[node->body];
    const double omega = motion->omega;
    const Vec2 arm = state->arms[node->own_end];
    Vec2 moved = vec2_scale(-1.0, state->turned[node->own_end]);
    Vec2 velocity = vec2_scale(-omega, vec2_perp(arm));
    Vec2 bias = vec2_scale(omega * omega, arm);
    if (node->parent != LINKAGE_GROUND) {
        const Motion *parent = &state->motions[node->parent];
        const Vec2 outer = state->arms[node->parent_end];
        moved =
            vec2_add(moved, vec2_add(state->moved[node->parent], state->turned[node->parent_end]));
        velocity = vec2_add(
            velocity, vec2_add(parent->velocity, vec2_scale(parent->omega, vec2_perp(outer))));
        bias = vec2_add(bias, vec2_sub(state->bias[node->parent],
                                       vec2_scale(parent->omega * parent->omega, outer)));
        const double alpha = tree_bias_alpha(tree, node->parent);
        if (alpha != 0.0) {
            bias = vec2_add(bias, vec2_scale(alpha, vec2_perp(outer)));
        }
    }
    tree_set_centre(tree, node->body, moved, state);
    motion->velocity = velocity;
    state->bias[node->body] = bias;
}

static inline void set_node(const Tree *tree, size_t number, const double *q, const double *u,
                            TreeState *state)
{
    const TreeNode *node = &tree->nodes[number];
    if (node->is_sliding) {
        tree_slide_turn(tree, node, q, u, state);
        set_arms(tree, node->body, state->turn[node->body], state);
        tree_slide_move(tree, number, q, u, state);
        return;
    }
    const double turn = q[node->angle_column];
    Motion *motion = &state->motions[node->body];
    state->turn[node->body] = turn;
    motion->angle = tree->base_motions[node->body].angle + turn;
    motion->omega = u[node->angle_column];
    set_arms(tree, node->body, turn, state);
    if (node->joint < 0) {
        set_floating(tree, node, q, u, state);
    } else {
        set_hanging(tree, node, state);
    }
}

void tree_evaluate(const Tree *tree, double since_s, const double *q, const double *u,
                   TreeState *state)
{
    if (tree->driven >= 0) {
        set_driven(tree, since_s, state);
    }
    for (size_t i = 0; i < tree->node_count; i++) {
        set_node(tree, i, q, u, state);
    }
}

// A body and all that it hangs on, the outermost last.
static void evaluate_up_to(const Tree *tree, int body, const double *q, const double *u,
                           TreeState *state)
{
    int count = 0;
    for (int at = tree_node_of(tree, body); at >= 0; at = tree->nodes[at].parent_node) {
        state->path[count++] = at;
    }
    while (count > 0) {
        set_node(tree, (size_t)state->path[--count], q, u, state);
    }
}

static size_t depth_of(const Tree *tree, int body)
{
    const int node = tree_node_of(tree, body);
    return node >= 0 ? tree->nodes[node].depth : 0;
}

// Whether all nodes are evaluated at least as soon as those of a pair.
static bool needs_all(const Tree *tree, int pair)
{
    return depth_of(tree, tree->end_bodies[2 * pair]) +
               depth_of(tree, tree->end_bodies[2 * pair + 1]) >=
           tree->node_count;
}

void tree_evaluate_pair(const Tree *tree, int pair, double since_s, const double *q,
                        const double *u, TreeState *state)
{
    if (needs_all(tree, pair)) {
        tree_evaluate(tree, since_s, q, u, state);
        return;
    }
    if (tree->driven >= 0) {
        set_driven(tree, since_s, state);
    }
    evaluate_up_to(tree, tree->end_bodies[2 * pair], q, u, state);
    evaluate_up_to(tree, tree->end_bodies[2 * pair + 1], q, u, state);
}

// Writes the coordinates that move a body.
static size_t coordinates_of(const Tree *tree, int body, size_t *columns)
{
    size_t count = 0;
    for (int at = tree_node_of(tree, body); at >= 0; at = tree->nodes[at].parent_node) {
        const TreeNode *node = &tree->nodes[at];
        for (size_t k = node->joint < 0 ? 3 : 1; k-- > 0;) {
            columns[count++] = node->column - k;
        }
    }
    return count;
}

size_t tree_pair_coordinates(const Tree *tree, int pair, size_t *columns)
{
    if (needs_all(tree, pair)) {
        return 0;
    }
    const size_t count = coordinates_of(tree, tree->end_bodies[2 * pair], columns);
    return count + coordinates_of(tree, tree->end_bodies[2 * pair + 1], columns + count);
}

void tree_accelerate(const Tree *tree, const double *rates, TreeState *state)
{
    for (size_t i = 0; i < tree->node_count; i++) {
        const TreeNode *node = &tree->nodes[i];
        Motion *motion = &state->motions[node->body];
        motion->alpha =
            node->angle_column >= 0 ? rates[node->angle_column] : tree_alpha(state, node->parent);
        if (node->joint < 0) {
            motion->acceleration = (Vec2){rates[node->column - 2], rates[node->column - 1]};
            continue;
        }
        if (node->is_sliding) {
            motion->acceleration = tree_slide_acceleration(tree, i, rates[node->column], state);
            continue;
        }
        const Vec2 arm = state->arms[node->own_end];
        const Vec2 own = vec2_sub(vec2_scale(motion->omega * motion->omega, arm),
                                  vec2_scale(motion->alpha, vec2_perp(arm)));
        motion->acceleration = vec2_add(tree_end_acceleration(tree, state, node->parent_end), own);
    }
}

void tree_point_row(const Tree *tree, const TreeState *state, int body, Vec2 arm, double sign,
                    Vec2 *row)
{
    for (int at = tree_node_of(tree, body); at >= 0; at = tree->nodes[at].parent_node) {
        const TreeNode *node = &tree->nodes[at];
        Vec2 *own = &row[node->column];
        if (node->is_sliding) {
            *own = vec2_add(*own, vec2_scale(sign, state->along[at]));
            arm = vec2_add(arm, state->behind[at]);
            continue;
        }
        if (node->joint >= 0) {
            arm = vec2_sub(arm, state->arms[node->own_end]);
        } else {
            own[-2].x += sign;
            own[-1].y += sign;
        }
        *own = vec2_add(*own, vec2_scale(sign, vec2_perp(arm)));
        arm = node->joint >= 0 ? state->arms[node->parent_end] : arm;
    }
}
