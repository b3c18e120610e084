// Which coordinates move a linkage in space, and how do its bodies follow them?
//
// With R the turn since the base, a body i that hangs about the axis a of its joint, arms s:
//     R_i = R_p (1 + turn about a at the base by q),   r_i = r_p + s_p - s_i
//     w_i = w_p + a q',         v_i = v_p + w_p x s_p - w_i x s_i
//     al_i = al_p + a q'' + w_p x a q'
//     a_i = a_p + al_p x s_p + w_p x (w_p x s_p) - al_i x s_i - w_i x (w_i x s_i)
// The terms without second rates are the bias. A floating body has the place of its centre and the
// vector of its turn (reference/turn.h). Everything is in the world's frame.
#include "reference/space_tree.h"

#include "reference/turn.h"

#include <string.h>

enum { HINGE_COORDINATES = 1, FLOATING_COORDINATES = 6 };

static void add_node(SpaceTree *tree, int body, int joint, int parent)
{
    SpaceNode *node = &tree->nodes[tree->node_count++];
    *node = (SpaceNode){
        .body = body, .joint = joint, .parent = parent, .first = tree->coordinate_count};
    tree->node_of[body] = (int)tree->node_count - 1;
    if (joint >= 0) {
        const bool is_own_b = tree->linkage->joints[joint].body_b == body;
        node->own_end = 2 * joint + (is_own_b ? 1 : 0);
        node->parent_end = 2 * joint + (is_own_b ? 0 : 1);
        tree->is_carried[body] = parent != LINKAGE_GROUND && tree->is_carried[parent];
        tree->is_driven_hung_on = tree->is_driven_hung_on || parent == tree->driven;
        // what moves the parent moves the child
        if (parent != LINKAGE_GROUND && parent != tree->driven) {
            const SpaceNode *above = &tree->nodes[tree->node_of[parent]];
            node->chain_count = above->chain_count;
            memcpy(node->chain, above->chain, sizeof node->chain);
        }
    }
    tree->has_floating = tree->has_floating || joint < 0;
    const size_t count = joint >= 0 ? HINGE_COORDINATES : FLOATING_COORDINATES;
    for (size_t i = 0; i < count; i++) {
        node->chain[node->chain_count++] = tree->coordinate_count++;
    }
}

// Hangs on every body that an unused ideal joint connects with a known one, until none is left.
static void grow(SpaceTree *tree, bool *is_known, bool *is_used)
{
    const Linkage *linkage = tree->linkage;
    bool has_grown = true;
    while (has_grown) {
        has_grown = false;
        for (size_t i = 0; i < linkage->joint_count; i++) {
            const Joint *joint = &linkage->joints[i];
            // the ground is known: it stands one before the first body
            const bool a_known = is_known[joint->body_a + 1];
            const bool b_known = is_known[joint->body_b + 1];
            if (joint->kind != JOINT_REVOLUTE || is_used[i] || a_known == b_known) {
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

static void list_ends(SpaceTree *tree)
{
    for (int end = 0; end < 2 * (int)tree->linkage->joint_count; end++) {
        tree->ends[end] = space_end(tree->linkage, (size_t)end / 2, end % 2);
        const int body = tree->ends[end].body;
        tree->ends_of[body + 1][tree->end_counts[body + 1]++] = end;
    }
}

void space_tree_build(const Linkage *linkage, SpaceTree *tree)
{
    *tree = (SpaceTree){.linkage = linkage, .driven = linkage_driven_body(linkage)};
    list_ends(tree);
    bool is_known[SPACE_TREE_BODY_MAX] = {true};
    bool is_used[SPACE_JOINT_MAX] = {false};
    if (tree->driven >= 0) {
        tree->node_of[tree->driven] = -1;
        tree->is_carried[tree->driven] = true;
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
        const Joint *joint = &linkage->joints[i];
        if (joint->kind == JOINT_REVOLUTE && !is_used[i]) {
            tree->loops[tree->loop_count++] = i;
            tree->is_driven_hung_on = tree->is_driven_hung_on || joint->body_a == tree->driven ||
                                      joint->body_b == tree->driven;
        }
    }
}

// The arms of a body's ends, from its turn since the base.
static void set_arms(const SpaceTree *tree, int body, SpaceTreeState *state)
{
    const Mat3 *turned = &state->bodies[body + 1].turned;
    for (size_t i = 0; i < tree->end_counts[body + 1]; i++) {
        const int end = tree->ends_of[body + 1][i];
        const Vec3 arm = tree->base_arms[end];
        state->arms[end] = vec3_add(arm, mat3_apply(turned, arm));
    }
}

static void set_driven(const SpaceTree *tree, double since_s, SpaceTreeState *state)
{
    const Driver *driver = &tree->linkage->driver;
    const int end = 2 * driver->joint + 1;
    SpaceBodyState *at = &state->bodies[tree->driven + 1];
    const Vec3 axis = tree->base_axes[2 * driver->joint];
    at->turned = turn_about(axis, driver->speed * since_s);
    set_arms(tree, tree->driven, state);
    const Vec3 arm = vec3_scale(-1.0, state->arms[end]);
    at->moved = vec3_scale(-1.0, mat3_apply(&at->turned, tree->base_arms[end]));
    at->omega = vec3_scale(driver->speed, axis);
    at->velocity = vec3_cross(at->omega, arm);
    at->bias = at->acceleration = vec3_cross(at->omega, at->velocity);
    at->spin_bias = at->alpha = (Vec3){0.0, 0.0, 0.0};
}

static Vec3 vector_at(const double *values)
{
    return (Vec3){values[0], values[1], values[2]};
}

static void set_floating(const SpaceTree *tree, size_t number, const double *q, const double *u,
                         SpaceTreeState *state)
{
    const SpaceNode *node = &tree->nodes[number];
    SpaceBodyState *at = &state->bodies[node->body + 1];
    SpaceColumn *columns = state->columns[number];
    Turn turn;
    turn_by_vector(vector_at(q + node->first + 3), vector_at(u + node->first + 3), &turn);
    at->turned = turn.moved;
    at->moved = vector_at(q + node->first);
    at->velocity = vector_at(u + node->first);
    at->omega = turn.omega;
    at->bias = (Vec3){0.0, 0.0, 0.0};
    at->spin_bias = turn.bias;
    const Vec3 none = {0.0, 0.0, 0.0};
    columns[0] = (SpaceColumn){{1.0, 0.0, 0.0}, none};
    columns[1] = (SpaceColumn){{0.0, 1.0, 0.0}, none};
    columns[2] = (SpaceColumn){{0.0, 0.0, 1.0}, none};
    for (int i = 0; i < 3; i++) {
        columns[3 + i] = (SpaceColumn){none, turn.rate[i]};
    }
    set_arms(tree, node->body, state);
}

// a + a b of two matrices: what a turn by b adds to one by a, if b comes first.
static Mat3 turn_within(const Mat3 *a, const Mat3 *b)
{
    Mat3 sum;
    for (int i = 0; i < 3; i++) {
        sum.row[i] = vec3_add(vec3_add(a->row[i], b->row[i]), mat3_apply_back(b, a->row[i]));
    }
    return sum;
}

static void set_hanging(const SpaceTree *tree, size_t number, const double *q, const double *u,
                        SpaceTreeState *state)
{
    const SpaceNode *node = &tree->nodes[number];
    const SpaceBodyState *parent = space_tree_body(state, node->parent);
    SpaceBodyState *at = &state->bodies[node->body + 1];
    const Mat3 own = turn_about(tree->base_axes[node->parent_end], q[node->first]);
    at->turned = turn_within(&parent->turned, &own);
    set_arms(tree, node->body, state);
    const Vec3 outer = state->arms[node->parent_end];
    const Vec3 inner = state->arms[node->own_end];
    const Vec3 parent_moved =
        space_tree_moved(state, node->parent, tree->base_arms[node->parent_end]);
    at->moved = vec3_sub(parent_moved, mat3_apply(&at->turned, tree->base_arms[node->own_end]));
    const Vec3 axis = space_tree_axis(tree, state, node->parent_end);
    const Vec3 spin = vec3_scale(u[node->first], axis);
    at->omega = vec3_add(parent->omega, spin);
    at->spin_bias = vec3_add(parent->spin_bias, vec3_cross(parent->omega, spin));
    at->velocity =
        vec3_sub(space_tree_velocity(state, node->parent, outer), vec3_cross(at->omega, inner));
    at->bias = vec3_sub(space_tree_bias(state, node->parent, outer),
                        vec3_add(vec3_cross(at->spin_bias, inner), space_tree_inwards(at, inner)));
    // the parent's chain, then the own coordinate
    SpaceColumn *columns = state->columns[number];
    const size_t above_count = node->chain_count - 1;
    if (above_count > 0) {
        const SpaceColumn *above = state->columns[tree->node_of[node->parent]];
        const Vec3 arm = vec3_sub(outer, inner);
        for (size_t i = 0; i < above_count; i++) {
            columns[i].angular = above[i].angular;
            columns[i].linear = vec3_add(above[i].linear, vec3_cross(above[i].angular, arm));
        }
    }
    columns[above_count] = (SpaceColumn){vec3_cross(inner, axis), axis};
}

void space_tree_evaluate(const SpaceTree *tree, double since_s, const double *q, const double *u,
                         SpaceTreeState *state)
{
    for (size_t i = 0; i < tree->end_counts[0]; i++) {
        const int end = tree->ends_of[0][i];
        state->arms[end] = tree->base_arms[end];
    }
    if (tree->driven >= 0) {
        set_driven(tree, since_s, state);
    }
    for (size_t i = 0; i < tree->node_count; i++) {
        if (tree->nodes[i].joint < 0) {
            set_floating(tree, i, q, u, state);
        } else {
            set_hanging(tree, i, q, u, state);
        }
    }
}

void space_tree_accelerate(const SpaceTree *tree, const double *rates, SpaceTreeState *state)
{
    for (size_t i = 0; i < tree->node_count; i++) {
        const SpaceNode *node = &tree->nodes[i];
        SpaceBodyState *at = &state->bodies[node->body + 1];
        at->acceleration = at->bias;
        at->alpha = at->spin_bias;
        for (size_t j = 0; j < node->chain_count; j++) {
            const SpaceColumn *column = &state->columns[i][j];
            const double rate = rates[node->chain[j]];
            at->acceleration = vec3_add(at->acceleration, vec3_scale(rate, column->linear));
            at->alpha = vec3_add(at->alpha, vec3_scale(rate, column->angular));
        }
    }
}

Mat3 space_tree_inertia(const SpaceTree *tree, const SpaceTreeState *state, int body)
{
    // R I R' with R = 1 + turned: rows of R I, then of that times R'
    const Mat3 *turned = &space_tree_body(state, body)->turned;
    const Mat3 *base = &tree->base_inertia[body];
    Mat3 half;
    Mat3 whole;
    for (int i = 0; i < 3; i++) {
        half.row[i] = vec3_add(base->row[i], mat3_apply(base, turned->row[i]));
    }
    for (int i = 0; i < 3; i++) {
        whole.row[i] = vec3_add(half.row[i], mat3_apply(turned, half.row[i]));
    }
    return whole;
}
