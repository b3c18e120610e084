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

// The arms of a body's ends, from its turn since the base.
static void set_arms(const SpaceTree *tree, int body, SpaceTreeState *state)
{
    const Mat3 *turned = &state->bodies[body + 1].turned;
    for (size_t i = tree->end_firsts[body + 1]; i < tree->end_firsts[body + 2]; i++) {
        const int end = tree->ends_of[i];
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
    Turn turn;
    turn_by_vector(vector_at(q + node->first + 3), vector_at(u + node->first + 3), &turn);
    at->turned = turn.moved;
    at->moved = vector_at(q + node->first);
    at->velocity = vector_at(u + node->first);
    at->omega = turn.omega;
    at->bias = (Vec3){0.0, 0.0, 0.0};
    at->spin_bias = turn.bias;
    for (int i = 0; i < 3; i++) {
        state->turning[number][i] = turn.rate[i];
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
    state->turning[number][0] = axis;
}

static void set_node(const SpaceTree *tree, size_t number, const double *q, const double *u,
                     SpaceTreeState *state)
{
    if (tree->nodes[number].joint < 0) {
        set_floating(tree, number, q, u, state);
    } else {
        set_hanging(tree, number, q, u, state);
    }
}

void space_tree_evaluate(const SpaceTree *tree, double since_s, const double *q, const double *u,
                         SpaceTreeState *state)
{
    if (tree->driven >= 0) {
        set_driven(tree, since_s, state);
    }
    for (size_t i = 0; i < tree->node_count; i++) {
        set_node(tree, i, q, u, state);
    }
}

// A body and all that it hangs on, the outermost last.
static void evaluate_up_to(const SpaceTree *tree, int body, const double *q, const double *u,
                           SpaceTreeState *state)
{
    int count = 0;
    for (int at = space_tree_node_of(tree, body); at >= 0; at = tree->nodes[at].parent_node) {
        state->path[count++] = at;
    }
    while (count > 0) {
        set_node(tree, (size_t)state->path[--count], q, u, state);
    }
}

static size_t depth_of(const SpaceTree *tree, int body)
{
    const int node = space_tree_node_of(tree, body);
    return node >= 0 ? tree->nodes[node].depth : 0;
}

// Whether all nodes are evaluated at least as soon as those of two bodies.
static bool needs_all(const SpaceTree *tree, int body_a, int body_b)
{
    return depth_of(tree, body_a) + depth_of(tree, body_b) >= tree->node_count;
}

void space_tree_evaluate_pair(const SpaceTree *tree, int body_a, int body_b, double since_s,
                              const double *q, const double *u, SpaceTreeState *state)
{
    if (needs_all(tree, body_a, body_b)) {
        space_tree_evaluate(tree, since_s, q, u, state);
        return;
    }
    if (tree->driven >= 0) {
        set_driven(tree, since_s, state);
    }
    evaluate_up_to(tree, body_a, q, u, state);
    evaluate_up_to(tree, body_b, q, u, state);
}

// Writes the coordinates that move a body.
static size_t coordinates_of(const SpaceTree *tree, int body, size_t *columns)
{
    size_t count = 0;
    for (int at = space_tree_node_of(tree, body); at >= 0; at = tree->nodes[at].parent_node) {
        const SpaceNode *node = &tree->nodes[at];
        for (size_t k = 0; k < (node->joint < 0 ? 6 : 1); k++) {
            columns[count++] = node->first + k;
        }
    }
    return count;
}

size_t space_tree_pair_coordinates(const SpaceTree *tree, int body_a, int body_b, size_t *columns)
{
    if (needs_all(tree, body_a, body_b)) {
        return 0;
    }
    const size_t count = coordinates_of(tree, body_a, columns);
    return count + coordinates_of(tree, body_b, columns + count);
}

static void accelerate_floating(const SpaceNode *node, const double *rates, const Vec3 *turning,
                                SpaceBodyState *at)
{
    const double *own = rates + node->first;
    at->acceleration = vec3_add(at->bias, vector_at(own));
    at->alpha = at->spin_bias;
    for (int i = 0; i < 3; i++) {
        at->alpha = vec3_add(at->alpha, vec3_scale(own[3 + i], turning[i]));
    }
}

void space_tree_accelerate(const SpaceTree *tree, const double *rates, SpaceTreeState *state)
{
    for (size_t i = 0; i < tree->node_count; i++) {
        const SpaceNode *node = &tree->nodes[i];
        SpaceBodyState *at = &state->bodies[node->body + 1];
        if (node->joint < 0) {
            accelerate_floating(node, rates, state->turning[i], at);
            continue;
        }
        const SpaceBodyState *parent = space_tree_body(state, node->parent);
        const Vec3 axis = state->turning[i][0];
        const Vec3 own = vec3_sub(at->spin_bias, parent->spin_bias);
        at->alpha = vec3_add(vec3_add(parent->alpha, own), vec3_scale(rates[node->first], axis));
        const Vec3 inner = state->arms[node->own_end];
        at->acceleration =
            vec3_sub(space_tree_acceleration(state, node->parent, state->arms[node->parent_end]),
                     vec3_add(vec3_cross(at->alpha, inner), space_tree_inwards(at, inner)));
    }
}

void space_tree_point_row(const SpaceTree *tree, const SpaceTreeState *state, int body, Vec3 arm,
                          double sign, Vec3 *row)
{
    for (int at = space_tree_node_of(tree, body); at >= 0; at = tree->nodes[at].parent_node) {
        const SpaceNode *node = &tree->nodes[at];
        Vec3 *own = row + node->first;
        if (node->joint < 0) {
            own[0].x += sign;
            own[1].y += sign;
            own[2].z += sign;
            for (int i = 0; i < 3; i++) {
                own[3 + i] =
                    vec3_add(own[3 + i], vec3_scale(sign, vec3_cross(state->turning[at][i], arm)));
            }
            continue;
        }
        arm = vec3_sub(arm, state->arms[node->own_end]);
        own[0] = vec3_add(own[0], vec3_scale(sign, vec3_cross(state->turning[at][0], arm)));
        arm = vec3_add(arm, state->arms[node->parent_end]);
    }
}

void space_tree_turn_row(const SpaceTree *tree, const SpaceTreeState *state, int body,
                         Vec3 direction, double *row)
{
    for (int at = space_tree_node_of(tree, body); at >= 0; at = tree->nodes[at].parent_node) {
        const SpaceNode *node = &tree->nodes[at];
        const size_t count = node->joint < 0 ? 3 : 1;
        double *own = row + node->first + (node->joint < 0 ? 3 : 0);
        for (size_t i = 0; i < count; i++) {
            own[i] += vec3_dot(state->turning[at][i], direction);
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
