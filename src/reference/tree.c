// Which coordinates move a linkage, and how do its bodies follow them?
//
// A body i that hangs by its anchor s_i on the anchor s_p of its parent p, arms R s:
//     r_i = r_p + R_p s_p - R_i s_i
//     v_i = v_p + w_p z x R_p s_p - w_i z x R_i s_i
//     a_i = a_p + al_p z x R_p s_p - w_p^2 R_p s_p - al_i z x R_i s_i + w_i^2 R_i s_i
// The terms without second rates are the bias. Angles are absolute, so each body's own is one
// coordinate. Source: Haug 1989, velocity transformations.
#include "reference/tree.h"

#include <string.h>

static void add_node(Tree *tree, int body, int joint, int parent)
{
    TreeNode *node = &tree->nodes[tree->node_count++];
    const size_t first = tree->coordinate_count;
    *node = (TreeNode){.body = body, .joint = joint, .parent = parent};
    if (joint >= 0) {
        const bool is_own_b = tree->linkage->joints[joint].body_b == body;
        node->own_end = 2 * joint + (is_own_b ? 1 : 0);
        node->parent_end = 2 * joint + (is_own_b ? 0 : 1);
        node->angle_column = tree->coordinate_count;
        tree->coordinate_count += 1;
        tree->is_driven_hung_on = tree->is_driven_hung_on || parent == tree->driven;
    } else {
        node->angle_column = tree->coordinate_count + 2;
        tree->coordinate_count += 3;
    }
    tree->angle_column[body] = (int)node->angle_column;
    tree->node_of[body] = (int)tree->node_count - 1;
    // what moves the parent moves the child
    if (joint >= 0 && parent != LINKAGE_GROUND && parent != tree->driven) {
        const TreeNode *above = &tree->nodes[tree->node_of[parent]];
        node->chain_count = above->chain_count;
        memcpy(node->chain, above->chain, sizeof node->chain);
    }
    for (size_t column = first; column < tree->coordinate_count; column++) {
        node->chain[node->chain_count++] = column;
    }
}

// Hangs on every body that an unused ideal joint connects with a known one, until none is left.
static void grow(Tree *tree, bool *is_known, bool *is_used)
{
    const Linkage *linkage = tree->linkage;
    bool has_grown = true;
    while (has_grown) {
        has_grown = false;
        for (size_t i = 0; i < linkage->joint_count; i++) {
            const Joint *joint = &linkage->joints[i];
            if (joint->kind != JOINT_REVOLUTE || is_used[i]) {
                continue;
            }
            // the ground is known: it stands one before the first body
            const bool a_known = is_known[joint->body_a + 1];
            const bool b_known = is_known[joint->body_b + 1];
            if (a_known == b_known) {
                continue;
            }
            const int child = a_known ? joint->body_b : joint->body_a;
            add_node(tree, child, (int)i, a_known ? joint->body_a : joint->body_b);
            is_known[child + 1] = true;
            is_used[i] = true;
            has_grown = true;
        }
    }
}

static void list_ends(Tree *tree)
{
    for (int joint = 0; joint < (int)tree->linkage->joint_count; joint++) {
        const int bodies[2] = {tree->linkage->joints[joint].body_a,
                               tree->linkage->joints[joint].body_b};
        const Vec2 anchors[2] = {tree->linkage->joints[joint].anchor_a,
                                 tree->linkage->joints[joint].anchor_b};
        for (int side = 0; side < 2; side++) {
            const int body = bodies[side];
            tree->end_bodies[2 * joint + side] = body;
            tree->anchors[2 * joint + side] = anchors[side];
            if (body != LINKAGE_GROUND) {
                tree->ends[body][tree->end_counts[body]++] = 2 * joint + side;
            }
        }
    }
}

void tree_build(const Linkage *linkage, Tree *tree)
{
    *tree = (Tree){.linkage = linkage, .driven = linkage_driven_body(linkage)};
    list_ends(tree);
    bool is_known[LINKAGE_BODY_MAX + 1] = {true};
    bool is_used[LINKAGE_JOINT_MAX] = {false};
    if (tree->driven >= 0) {
        tree->angle_column[tree->driven] = -1;
        tree->node_of[tree->driven] = -1;
        is_known[tree->driven + 1] = true;
        is_used[linkage->driver.joint] = true;
    }
    grow(tree, is_known, is_used);
    for (int body = 0; body < (int)linkage->body_count; body++) {
        if (!is_known[body + 1]) {
            add_node(tree, body, -1, LINKAGE_GROUND);
            is_known[body + 1] = true;
            grow(tree, is_known, is_used);
        }
    }
    for (int i = 0; i < (int)linkage->joint_count; i++) {
        if (linkage->joints[i].kind == JOINT_REVOLUTE && !is_used[i]) {
            tree->loops[tree->loop_count++] = i;
            tree->is_driven_hung_on = tree->is_driven_hung_on ||
                                      linkage->joints[i].body_a == tree->driven ||
                                      linkage->joints[i].body_b == tree->driven;
        }
    }
}

// Turns a body's ends by an angle d since the base: the change of an arm s is
//     sin d perp s - (1 - cos d) s
// by a series while d is small. Up to 0.01 the first terms left out, d^9 / 9! and d^8 / 8!, are
// below 3e-21.
static inline void set_arms(const Tree *tree, int body, double d, TreeState *state)
{
    const double small = 0.01;
    const double e = d * d;
    double s = d * (1.0 - e * (1.0 / 6.0) * (1.0 - e * (1.0 / 20.0) * (1.0 - e * (1.0 / 42.0))));
    double r = 0.5 * e * (1.0 - e * (1.0 / 12.0) * (1.0 - e * (1.0 / 30.0)));
    if (!(fabs(d) <= small)) {
        s = sin(d);
        r = 2.0 * sin(0.5 * d) * sin(0.5 * d);
    }
    for (size_t i = 0; i < tree->end_counts[body]; i++) {
        const int end = tree->ends[body][i];
        const Vec2 arm = tree->base_arms[end];
        state->turned[end] = (Vec2){-s * arm.y - r * arm.x, s * arm.x - r * arm.y};
        state->arms[end] = vec2_add(arm, state->turned[end]);
    }
}

// Puts a body's centre where it has moved to.
static inline void set_centre(const Tree *tree, int body, Vec2 moved, TreeState *state)
{
    const TreePoint base = tree->base_position[body];
    state->moved[body] = moved;
    state->motions[body].position = (Vec2){(double)base.x + moved.x, (double)base.y + moved.y};
}

static void set_driven(const Tree *tree, double since_s, TreeState *state)
{
    const Driver *driver = &tree->linkage->driver;
    Motion *motion = &state->motions[tree->driven];
    const double turned = driver->speed * since_s;
    motion->angle = (double)tree->base_angle[tree->driven] + turned;
    motion->omega = driver->speed;
    motion->alpha = 0.0;
    set_arms(tree, tree->driven, turned, state);
    const int end = 2 * driver->joint + 1;
    const Vec2 arm = state->arms[end];
    set_centre(tree, tree->driven, vec2_scale(-1.0, state->turned[end]), state);
    motion->velocity = vec2_scale(-driver->speed, vec2_perp(arm));
    motion->acceleration = vec2_scale(driver->speed * driver->speed, arm);
    state->bias[tree->driven] = motion->acceleration;
}

static void set_floating(const Tree *tree, const TreeNode *node, const double *q, const double *u,
                         Vec2 *columns, TreeState *state)
{
    const size_t column = node->angle_column;
    Motion *motion = &state->motions[node->body];
    set_centre(tree, node->body, (Vec2){q[column - 2], q[column - 1]}, state);
    motion->velocity = (Vec2){u[column - 2], u[column - 1]};
    state->bias[node->body] = (Vec2){0.0, 0.0};
    columns[0] = (Vec2){1.0, 0.0};
    columns[1] = (Vec2){0.0, 1.0};
    columns[2] = (Vec2){0.0, 0.0};
}

static void set_hanging(const Tree *tree, const TreeNode *node, Vec2 *columns, TreeState *state)
{
    Motion *motion = &state->motions[node->body];
    const Vec2 arm = state->arms[node->own_end];
    const Vec2 lever = vec2_perp(arm);
    const Vec2 parent_moved = tree_end_moved(tree, state, node->parent_end);
    set_centre(tree, node->body, vec2_sub(parent_moved, state->turned[node->own_end]), state);
    motion->velocity = vec2_sub(tree_end_velocity(tree, state, node->parent_end),
                                vec2_scale(motion->omega, lever));
    state->bias[node->body] = vec2_add(tree_end_bias(tree, state, node->parent_end),
                                       vec2_scale(motion->omega * motion->omega, arm));
    const size_t own = node->chain_count - 1;
    if (own > 0) {
        // the parent's chain, whose last coordinate is the parent's angle
        const Vec2 *above = state->columns[tree->node_of[node->parent]];
        for (size_t i = 0; i < own; i++) {
            columns[i] = above[i];
        }
        columns[own - 1] = vec2_add(columns[own - 1], vec2_perp(state->arms[node->parent_end]));
    }
    columns[own] = vec2_scale(-1.0, lever);
}

void tree_evaluate(const Tree *tree, double since_s, const double *q, const double *u,
                   TreeState *state)
{
    if (tree->driven >= 0) {
        set_driven(tree, since_s, state);
    }
    for (size_t i = 0; i < tree->node_count; i++) {
        const TreeNode *node = &tree->nodes[i];
        Motion *motion = &state->motions[node->body];
        motion->angle = (double)tree->base_angle[node->body] + q[node->angle_column];
        motion->omega = u[node->angle_column];
        set_arms(tree, node->body, q[node->angle_column], state);
        if (node->joint < 0) {
            set_floating(tree, node, q, u, state->columns[i], state);
        } else {
            set_hanging(tree, node, state->columns[i], state);
        }
    }
}

void tree_accelerate(const Tree *tree, const double *rates, TreeState *state)
{
    for (size_t i = 0; i < tree->node_count; i++) {
        const TreeNode *node = &tree->nodes[i];
        Vec2 acceleration = state->bias[node->body];
        for (size_t j = 0; j < node->chain_count; j++) {
            acceleration =
                vec2_add(acceleration, vec2_scale(rates[node->chain[j]], state->columns[i][j]));
        }
        state->motions[node->body].acceleration = acceleration;
        state->motions[node->body].alpha = rates[node->angle_column];
    }
}
