// Finds the coordinates that move a linkage in space, and how its bodies follow them.
//
// With R the turn since the base, a body i that hangs about the axis a of its joint, arms s:
//     R_i = R_p (1 + turn about a at the base by q),   r_i = r_p + s_p - s_i
//     w_i = w_p + a q',         v_i = v_p + w_p x s_p - w_i x s_i
//     al_i = al_p + a q'' + w_p x a q'
//     a_i = a_p + al_p x s_p + w_p x (w_p x s_p) - al_i x s_i - w_i x (w_i x s_i)
// The terms without second rates are the bias. A floating body has the position of its centre and
// the vector of its turn (reference/space/turn.h). Everything is in the world's frame.
#include "reference/space/space_tree.h"

#include "base/zeroed.h"
#include "model/space_coordinate.h"
#include "reference/space/turn.h"
#include "reference/span.h"

#include <math.h>

// The arms of a body's ends, from its turn since the base.
static void space_tree_set_arms(const SpaceTree *tree, int body, SpaceTreeState *state)
{
    const Mat3 *turned = &state->bodies[body + 1].turned;
    for (size_t i = tree->end_firsts[body + 1]; i < tree->end_firsts[body + 2]; i++) {
        const int end = tree->ends_of[i];
        const Vec3 arm = tree->base_arms[end];
        state->arms[end] = vec3_add(arm, mat3_apply(turned, arm));
    }
}

static void space_tree_set_driven(const SpaceTree *tree, double since_s, SpaceTreeState *state)
{
    const Driver *driver = &tree->linkage->driver;
    const int end = 2 * driver->joint + 1;
    SpaceBodyState *at = &state->bodies[tree->driven + 1];
    const Vec3 axis = tree->base_axes[2 * driver->joint];
    at->turned = turn_about(axis, driver->speed * since_s);
    space_tree_set_arms(tree, tree->driven, state);
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

static void space_tree_set_floating(const SpaceTree *tree, size_t number, const double *q,
                                    const double *u, SpaceTreeState *state)
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
    space_tree_set_arms(tree, node->body, state);
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

static void space_tree_set_hanging(const SpaceTree *tree, size_t number, const double *q,
                                   const double *u, SpaceTreeState *state)
{
    const SpaceNode *node = &tree->nodes[number];
    const SpaceBodyState *parent = space_tree_body(state, node->parent);
    SpaceBodyState *at = &state->bodies[node->body + 1];
    const Mat3 own = turn_about(tree->base_axes[node->parent_end], q[node->first]);
    at->turned = turn_within(&parent->turned, &own);
    space_tree_set_arms(tree, node->body, state);
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

static void space_tree_set_node(const SpaceTree *tree, size_t number, const double *q,
                                const double *u, SpaceTreeState *state)
{
    if (tree->nodes[number].joint < 0) {
        space_tree_set_floating(tree, number, q, u, state);
    } else {
        space_tree_set_hanging(tree, number, q, u, state);
    }
}

void space_tree_evaluate(const SpaceTree *tree, double since_s, const double *q, const double *u,
                         SpaceTreeState *state)
{
    if (tree->driven >= 0) {
        space_tree_set_driven(tree, since_s, state);
    }
    for (size_t i = 0; i < tree->node_count; i++) {
        space_tree_set_node(tree, i, q, u, state);
    }
}

// A body and all that it hangs on, the outermost last.
static void space_tree_evaluate_up_to(const SpaceTree *tree, int body, const double *q,
                                      const double *u, SpaceTreeState *state)
{
    int count = 0;
    for (int at = space_tree_node_of(tree, body); at >= 0; at = tree->nodes[at].parent_node) {
        state->path[count++] = at;
    }
    while (count > 0) {
        space_tree_set_node(tree, (size_t)state->path[--count], q, u, state);
    }
}

static size_t space_tree_depth_of(const SpaceTree *tree, int body)
{
    const int node = space_tree_node_of(tree, body);
    return node >= 0 ? tree->nodes[node].depth : 0;
}

// Whether all nodes are evaluated at least as soon as those of two bodies.
static bool space_tree_needs_all(const SpaceTree *tree, int body_a, int body_b)
{
    return space_tree_depth_of(tree, body_a) + space_tree_depth_of(tree, body_b) >=
           tree->node_count;
}

void space_tree_evaluate_pair(const SpaceTree *tree, int body_a, int body_b, double since_s,
                              const double *q, const double *u, SpaceTreeState *state)
{
    if (space_tree_needs_all(tree, body_a, body_b)) {
        space_tree_evaluate(tree, since_s, q, u, state);
        return;
    }
    if (tree->driven >= 0) {
        space_tree_set_driven(tree, since_s, state);
    }
    space_tree_evaluate_up_to(tree, body_a, q, u, state);
    space_tree_evaluate_up_to(tree, body_b, q, u, state);
}

// Writes the coordinates that move a body.
static size_t space_tree_coordinates_of(const SpaceTree *tree, int body, size_t *columns)
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
    if (space_tree_needs_all(tree, body_a, body_b)) {
        return 0;
    }
    const size_t count = space_tree_coordinates_of(tree, body_a, columns);
    return count + space_tree_coordinates_of(tree, body_b, columns + count);
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

// The base: where the linkage stands in space at the start of a step, in long double.
//
// As in the plane (reference/plane/tree.c) the base is held in long double. A floating body keeps
// its position and turn, a hanging one the angle of its joint since the start: the ideal joints of
// the tree hold at every base, however many there have been.

static LongQuat product(LongQuat a, LongQuat b)
{
    return (LongQuat){
        a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z,
        a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y,
        a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x,
        a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w,
    };
}

static LongQuat long_quat(Quat a)
{
    return (LongQuat){a.w, a.x, a.y, a.z};
}

static LongQuat back(LongQuat a)
{
    return (LongQuat){a.w, -a.x, -a.y, -a.z};
}

static LongQuat unit(LongQuat a)
{
    const long double scale = 1.0L / sqrtl(a.w * a.w + a.x * a.x + a.y * a.y + a.z * a.z);
    return (LongQuat){scale * a.w, scale * a.x, scale * a.y, scale * a.z};
}

static Quat rounded(LongQuat a)
{
    return (Quat){(double)a.w, (double)a.x, (double)a.y, (double)a.z};
}

static LongQuat about(Vec3 axis, long double angle)
{
    const LongVec3 along = long_vec3(axis);
    const long double length = sqrtl(long_vec3_dot(along, along));
    const long double share = sinl(0.5L * angle) / length;
    return (LongQuat){cosl(0.5L * angle), share * along.x, share * along.y, share * along.z};
}

static LongQuat by_vector(Vec3 turn)
{
    const LongVec3 s = long_vec3(turn);
    const long double angle = sqrtl(long_vec3_dot(s, s));
    const LongQuat none = {1.0L, 0.0L, 0.0L, 0.0L};
    return angle == 0.0L ? none : about(turn, angle);
}

static LongVec3 rotate(LongQuat q, LongVec3 a)
{
    // a + 2 w (v x a) + 2 v x (v x a)
    const LongVec3 once = {q.y * a.z - q.z * a.y, q.z * a.x - q.x * a.z, q.x * a.y - q.y * a.x};
    const LongVec3 twice = {
        q.y * once.z - q.z * once.y,
        q.z * once.x - q.x * once.z,
        q.x * once.y - q.y * once.x,
    };
    return (LongVec3){
        a.x + 2.0L * (q.w * once.x + twice.x),
        a.y + 2.0L * (q.w * once.y + twice.y),
        a.z + 2.0L * (q.w * once.z + twice.z),
    };
}

LongVec3 space_tree_base_arm(const SpaceTree *tree, int body, Vec3 local)
{
    return rotate(tree->base_turn[body + 1], long_vec3(local));
}

LongVec3 space_tree_base_point(const SpaceTree *tree, int body, Vec3 local)
{
    return long_vec3_add(tree->base_position[body + 1], space_tree_base_arm(tree, body, local));
}

static LongVec3 end_arm(const SpaceTree *tree, int end)
{
    return space_tree_base_arm(tree, tree->ends[end].body, tree->ends[end].anchor);
}

static LongVec3 space_tree_base_end_point(const SpaceTree *tree, int end)
{
    return space_tree_base_point(tree, tree->ends[end].body, tree->ends[end].anchor);
}

static LongVec3 minus(LongVec3 a, LongVec3 b)
{
    return (LongVec3){a.x - b.x, a.y - b.y, a.z - b.z};
}

static void settle_body(SpaceTree *tree, int body, int parent_end, int own_end)
{
    if (parent_end >= 0) {
        tree->base_position[body + 1] =
            minus(space_tree_base_end_point(tree, parent_end), end_arm(tree, own_end));
    }
    tree->base_inertia[body] =
        space_world_inertia(&tree->linkage->bodies[body], rounded(tree->base_turn[body + 1]));
}

// The angle of a limited joint, of all that differ by turns the one nearest to the one before.
static double settled_coordinate(const SpaceTree *tree, int joint)
{
    const Linkage *linkage = tree->linkage;
    const Joint *of = &linkage->joints[joint];
    const Vec3 z = {0.0, 0.0, 1.0};
    LongQuat turns[2];
    for (int side = 0; side < 2; side++) {
        const int body = tree->ends[2 * joint + side].body;
        const double start = body == LINKAGE_GROUND ? 0.0 : linkage->bodies[body].start.angle;
        turns[side] = product(tree->base_turn[body + 1], back(about(z, start)));
    }
    // how body b has turned against body a since time zero, when the axis was that of the case
    const LongQuat turned = product(back(turns[0]), turns[1]);
    const LongVec3 along = {turned.x, turned.y, turned.z};
    const long double angle =
        2.0L * atan2l(long_vec3_dot(along, long_vec3(of->space.axis)), turned.w);
    const long double now = space_coordinate_start(linkage, joint) + coordinate_sense(of) * angle;
    const long double before = tree->base_coordinates[joint];
    const long double circle = 4.0L * acosl(0.0L);
    return (double)(before + remainderl(now - before, circle));
}

// Centres and turns of the bodies that are driven or hang, arms and gaps.
static void space_tree_base_settle(SpaceTree *tree)
{
    tree->base_turn[0] = (LongQuat){1.0L, 0.0L, 0.0L, 0.0L};
    if (tree->driven >= 0) {
        const int joint = tree->linkage->driver.joint;
        const long double turned = tree->linkage->driver.speed * tree->base_time_s;
        tree->base_turn[tree->driven + 1] =
            product(about(tree->ends[2 * joint].axis, turned), tree->start_turn[tree->driven]);
        settle_body(tree, tree->driven, 2 * joint, 2 * joint + 1);
    }
    for (size_t i = 0; i < tree->node_count; i++) {
        const SpaceNode *node = &tree->nodes[i];
        if (node->joint < 0) {
            settle_body(tree, node->body, -1, -1);
            continue;
        }
        const LongQuat own = about(tree->ends[node->parent_end].axis, tree->base_angle[node->body]);
        tree->base_turn[node->body + 1] = unit(
            product(tree->base_turn[node->parent + 1], product(own, tree->start_turn[node->body])));
        settle_body(tree, node->body, node->parent_end, node->own_end);
    }
    for (int joint = 0; joint < (int)tree->linkage->joint_count; joint++) {
        LongVec3 points[2];
        for (int side = 0; side < 2; side++) {
            const int end = 2 * joint + side;
            const int body = tree->ends[end].body;
            const LongVec3 arm = end_arm(tree, end);
            points[side] = long_vec3_add(tree->base_position[body + 1], arm);
            tree->base_arms[end] = long_vec3_round(arm);
            // of directions the digits of a double are enough
            const Vec3 axis = quat_rotate(rounded(tree->base_turn[body + 1]), tree->ends[end].axis);
            tree->base_axes[end] = vec3_scale(1.0 / vec3_length(axis), axis);
        }
        tree->base_gaps[joint] = long_vec3_round(minus(points[1], points[0]));
        if (tree->linkage->joints[joint].limits.kind != LIMIT_NONE) {
            tree->base_coordinates[joint] = settled_coordinate(tree, joint);
        }
    }
}

// How far a hanging body has turned about its joint's axis since the joints' points were where the
// case has them.
static long double angle_since_case(const SpaceTree *tree, const SpaceNode *node,
                                    const SpaceMotion *motions)
{
    const Quat none = {1.0, 0.0, 0.0, 0.0};
    const Quat parent = node->parent == LINKAGE_GROUND ? none : motions[node->parent].turn;
    const LongQuat now = product(back(long_quat(parent)), long_quat(motions[node->body].turn));
    const LongQuat turned = product(now, back(tree->start_turn[node->body]));
    const LongVec3 along = {turned.x, turned.y, turned.z};
    const LongVec3 axis = long_vec3(tree->ends[node->parent_end].axis);
    return 2.0L * atan2l(long_vec3_dot(along, axis), turned.w);
}

void space_tree_start(SpaceTree *tree, const SpaceMotion *motions, double *u)
{
    const bool is_elsewhere = space_starts_elsewhere(tree->linkage);
    const Vec3 z = {0.0, 0.0, 1.0};
    LongQuat *turns = zeroed(tree->linkage->body_count + 1, sizeof *turns);
    turns[0] = (LongQuat){1.0L, 0.0L, 0.0L, 0.0L};
    for (int i = 0; i < (int)tree->linkage->body_count; i++) {
        turns[i + 1] = about(z, tree->linkage->bodies[i].start.angle);
    }
    tree->base_time_s = 0.0L;
    for (int i = 0; i < (int)tree->linkage->joint_count; i++) {
        if (tree->linkage->joints[i].limits.kind != LIMIT_NONE) {
            tree->base_coordinates[i] = space_coordinate_start(tree->linkage, i);
        }
    }
    if (tree->driven >= 0) {
        tree->start_turn[tree->driven] = turns[tree->driven + 1];
    }
    for (size_t i = 0; i < tree->node_count; i++) {
        const SpaceNode *node = &tree->nodes[i];
        const SpaceMotion *motion = &motions[node->body];
        double *rates = u + node->first;
        if (node->joint >= 0) {
            tree->base_angle[node->body] = 0.0L;
            tree->start_turn[node->body] =
                product(back(turns[node->parent + 1]), turns[node->body + 1]);
            const Vec3 frame = node->parent == LINKAGE_GROUND ? (Vec3){0.0, 0.0, 0.0}
                                                              : motions[node->parent].omega;
            Vec3 axis = tree->linkage->joints[node->joint].space.axis;
            if (is_elsewhere) {
                tree->base_angle[node->body] = angle_since_case(tree, node, motions);
                axis = space_direction(motions, node->parent, tree->ends[node->parent_end].axis);
            }
            rates[0] = vec3_dot(axis, vec3_sub(motion->omega, frame));
            continue;
        }
        tree->base_turn[node->body + 1] =
            is_elsewhere ? unit(long_quat(motion->turn)) : turns[node->body + 1];
        tree->base_position[node->body + 1] = long_vec3(motion->position);
        const double values[6] = {motion->velocity.x, motion->velocity.y, motion->velocity.z,
                                  motion->omega.x,    motion->omega.y,    motion->omega.z};
        for (int k = 0; k < 6; k++) {
            rates[k] = values[k];
        }
    }
    free(turns);
    space_tree_base_settle(tree);
}

// Takes the move of a floating body into its base.
static void rebase_floating(SpaceTree *tree, const SpaceNode *node, const double *q, double *u)
{
    const double *moved = q + node->first;
    double *rates = u + node->first + 3;
    const Vec3 turned = {moved[3], moved[4], moved[5]};
    Turn turn;
    turn_by_vector(turned, (Vec3){rates[0], rates[1], rates[2]}, &turn);
    LongVec3 *centre = &tree->base_position[node->body + 1];
    LongQuat *base = &tree->base_turn[node->body + 1];
    *centre = long_vec3_add(*centre, (LongVec3){moved[0], moved[1], moved[2]});
    *base = unit(product(by_vector(turned), *base));
    rates[0] = turn.omega.x;
    rates[1] = turn.omega.y;
    rates[2] = turn.omega.z;
}

void space_tree_rebase(SpaceTree *tree, double since_s, double *q, double *u)
{
    tree->base_time_s += since_s;
    for (size_t i = 0; i < tree->node_count; i++) {
        const SpaceNode *node = &tree->nodes[i];
        if (node->joint < 0) {
            rebase_floating(tree, node, q, u);
        } else {
            tree->base_angle[node->body] += q[node->first];
        }
    }
    for (size_t i = 0; i < tree->coordinate_count; i++) {
        q[i] = 0.0;
    }
    space_tree_base_settle(tree);
}

// The rotation of a matrix that is one, from the largest of its parts.
static Quat quat_of(const Mat3 *m)
{
    const Vec3 *r = m->row;
    const double sizes[4] = {r[0].x + r[1].y + r[2].z, r[0].x - r[1].y - r[2].z,
                             r[1].y - r[2].z - r[0].x, r[2].z - r[0].x - r[1].y};
    int largest = 0;
    for (int i = 1; i < 4; i++) {
        largest = sizes[i] > sizes[largest] ? i : largest;
    }
    const double own = 1.0 + sizes[largest];
    const double wx = r[2].y - r[1].z;
    const double wy = r[0].z - r[2].x;
    const double wz = r[1].x - r[0].y;
    const double xy = r[0].y + r[1].x;
    const double xz = r[0].z + r[2].x;
    const double yz = r[1].z + r[2].y;
    const Quat quats[4] = {
        {own, wx, wy, wz}, {wx, own, xy, xz}, {wy, xy, own, yz}, {wz, xz, yz, own}};
    return quat_unit(quats[largest]);
}

void space_tree_motions(const SpaceTree *tree, const SpaceTreeState *state, SpaceMotion *motions)
{
    for (int i = 0; i < (int)tree->linkage->body_count; i++) {
        const SpaceBodyState *at = space_tree_body(state, i);
        Mat3 turned = at->turned;
        turned.row[0].x += 1.0;
        turned.row[1].y += 1.0;
        turned.row[2].z += 1.0;
        motions[i] = (SpaceMotion){
            .position = vec3_add(long_vec3_round(tree->base_position[i + 1]), at->moved),
            .turn = quat_unit(quat_product(quat_of(&turned), rounded(tree->base_turn[i + 1]))),
            .velocity = at->velocity,
            .omega = at->omega,
            .acceleration = at->acceleration,
            .alpha = at->alpha,
        };
    }
}

// Building: which coordinates move a linkage in space.
//
// Found once, from the same tree over its bodies as in the plane (reference/span.h).

enum { HINGE_COORDINATES = 1, FLOATING_COORDINATES = 6 };

static bool space_tree_is_driven(const SpaceTree *tree, int body)
{
    return body != LINKAGE_GROUND && body == tree->driven;
}

static void space_tree_add_node(SpaceTree *tree, const SpanStep *step)
{
    SpaceNode *node = &tree->nodes[tree->node_count];
    *node = (SpaceNode){
        .body = step->body,
        .joint = step->joint,
        .parent = step->parent,
        .parent_node = -1,
        .depth = 1,
        .first = tree->coordinate_count,
    };
    tree->node_of[step->body] = (int)tree->node_count++;
    tree->coordinate_count += step->joint >= 0 ? HINGE_COORDINATES : FLOATING_COORDINATES;
    tree->has_floating = tree->has_floating || step->joint < 0;
    if (step->joint < 0) {
        return;
    }
    const bool is_own_b = tree->linkage->joints[step->joint].body_b == step->body;
    node->own_end = 2 * step->joint + (is_own_b ? 1 : 0);
    node->parent_end = 2 * step->joint + (is_own_b ? 0 : 1);
    node->parent_node = space_tree_node_of(tree, step->parent);
    node->depth = node->parent_node >= 0 ? tree->nodes[node->parent_node].depth + 1 : 1;
    tree->is_carried[step->body] = step->parent != LINKAGE_GROUND && tree->is_carried[step->parent];
    tree->is_driven_hung_on = tree->is_driven_hung_on || space_tree_is_driven(tree, step->parent);
}

// The ends of each body, the ground's first.
static void space_tree_list_ends(SpaceTree *tree)
{
    const int count = 2 * (int)tree->linkage->joint_count;
    size_t *next = zeroed(tree->linkage->body_count + 2, sizeof *next);
    for (int end = 0; end < count; end++) {
        tree->ends[end] = space_end(tree->linkage, (size_t)end / 2, end % 2);
        tree->end_firsts[tree->ends[end].body + 2]++;
    }
    for (size_t i = 0; i <= tree->linkage->body_count; i++) {
        tree->end_firsts[i + 1] += tree->end_firsts[i];
        next[i] = tree->end_firsts[i];
    }
    for (int end = 0; end < count; end++) {
        tree->ends_of[next[tree->ends[end].body + 1]++] = end;
    }
    free(next);
}

// All arrays, from a layout that counts or has the memory.
static void space_tree_lay(SpaceTree *tree, MemoryLayout *layout)
{
    const size_t bodies = tree->linkage->body_count;
    const size_t joints = tree->linkage->joint_count;
    tree->nodes = layout_take(layout, bodies, sizeof *tree->nodes);
    tree->node_of = layout_take(layout, bodies, sizeof *tree->node_of);
    tree->reaches = layout_take(layout, bodies, sizeof *tree->reaches);
    tree->is_carried = layout_take(layout, bodies, sizeof *tree->is_carried);
    tree->ends = layout_take(layout, 2 * joints, sizeof *tree->ends);
    tree->end_firsts = layout_take(layout, bodies + 2, sizeof *tree->end_firsts);
    tree->ends_of = layout_take(layout, 2 * joints, sizeof *tree->ends_of);
    tree->loops = layout_take(layout, joints, sizeof *tree->loops);
    tree->base_angle = layout_take(layout, bodies, sizeof *tree->base_angle);
    tree->start_turn = layout_take(layout, bodies, sizeof *tree->start_turn);
    tree->base_turn = layout_take(layout, bodies + 1, sizeof *tree->base_turn);
    tree->base_position = layout_take(layout, bodies + 1, sizeof *tree->base_position);
    tree->base_inertia = layout_take(layout, bodies, sizeof *tree->base_inertia);
    tree->base_arms = layout_take(layout, 2 * joints, sizeof *tree->base_arms);
    tree->base_axes = layout_take(layout, 2 * joints, sizeof *tree->base_axes);
    tree->base_coordinates = layout_take(layout, joints, sizeof *tree->base_coordinates);
    tree->base_gaps = layout_take(layout, joints, sizeof *tree->base_gaps);
}

static void space_tree_list_loops(SpaceTree *tree, const bool *is_used)
{
    for (int i = 0; i < (int)tree->linkage->joint_count; i++) {
        const Joint *joint = &tree->linkage->joints[i];
        if (joint_is_ideal(joint->kind) && !is_used[i]) {
            tree->loops[tree->loop_count++] = i;
            tree->is_driven_hung_on = tree->is_driven_hung_on ||
                                      space_tree_is_driven(tree, joint->body_a) ||
                                      space_tree_is_driven(tree, joint->body_b);
        }
    }
}

void space_tree_build(const Linkage *linkage, SpaceTree *tree)
{
    *tree = (SpaceTree){.linkage = linkage, .driven = linkage_driven_body(linkage)};
    MemoryLayout layout = {NULL, 0};
    space_tree_lay(tree, &layout);
    tree->memory_size = layout.used;
    tree->memory = zeroed(layout.used, 1);
    space_tree_lay(tree, &(MemoryLayout){tree->memory, 0});
    space_tree_list_ends(tree);
    linkage_reaches(linkage, tree->reaches);
    if (tree->driven >= 0) {
        tree->node_of[tree->driven] = -1;
        tree->is_carried[tree->driven] = true;
    }
    Span span = span_find(linkage);
    for (size_t i = 0; i < span.count; i++) {
        space_tree_add_node(tree, &span.steps[i]);
    }
    space_tree_list_loops(tree, span.is_used);
    span_finish(&span);
}

void space_tree_finish(SpaceTree *tree)
{
    free(tree->memory);
}

void space_tree_state_lay(const SpaceTree *tree, MemoryLayout *layout, SpaceTreeState *state)
{
    const size_t joints = tree->linkage->joint_count;
    state->bodies = layout_take(layout, tree->linkage->body_count + 1, sizeof *state->bodies);
    state->arms = layout_take(layout, 2 * joints, sizeof *state->arms);
    state->turning = layout_take(layout, tree->node_count, sizeof *state->turning);
    state->path = layout_take(layout, tree->node_count, sizeof *state->path);
}
