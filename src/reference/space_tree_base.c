// Where does the linkage stand in space at the start of a step, to more digits than a double has?
//
// As in the plane (reference/tree_base.c) the base is held in long double. A floating body keeps
// its place and turn, a hanging one the angle of its joint since the start: the ideal joints of the
// tree hold at every base, however many there have been.
#include "base/zeroed.h"
#include "model/space_coordinate.h"
#include "reference/space_tree.h"
#include "reference/turn.h"

#include <math.h>

static LongQuat product(LongQuat a, LongQuat b)
{
    return (LongQuat){
        a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z,
        a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y,
        a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x,
        a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w,
    };
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

static LongVec3 end_point(const SpaceTree *tree, int end)
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
        tree->base_position[body + 1] = minus(end_point(tree, parent_end), end_arm(tree, own_end));
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
static void settle(SpaceTree *tree)
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

void space_tree_start(SpaceTree *tree, const SpaceMotion *motions, double *u)
{
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
            const Vec3 axis = tree->linkage->joints[node->joint].space.axis;
            rates[0] = vec3_dot(axis, vec3_sub(motion->omega, frame));
            continue;
        }
        tree->base_turn[node->body + 1] = turns[node->body + 1];
        tree->base_position[node->body + 1] = long_vec3(motion->position);
        const double values[6] = {motion->velocity.x, motion->velocity.y, motion->velocity.z,
                                  motion->omega.x,    motion->omega.y,    motion->omega.z};
        for (int k = 0; k < 6; k++) {
            rates[k] = values[k];
        }
    }
    free(turns);
    settle(tree);
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
    settle(tree);
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
