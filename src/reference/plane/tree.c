// Finds the coordinates that move a linkage in the plane, and how its bodies follow them.
//
// A body i that hangs by its anchor s_i on the anchor s_p of its parent p, arms R s:
//     r_i = r_p + R_p s_p - R_i s_i
//     v_i = v_p + w_p z x R_p s_p - w_i z x R_i s_i
//     a_i = a_p + al_p z x R_p s_p - w_p^2 R_p s_p - al_i z x R_i s_i + w_i^2 R_i s_i
// The terms without second rates are the bias. Angles are absolute, so each body's own is one
// coordinate. Source: Haug 1989, velocity transformations.
#include "reference/plane/tree.h"

#include "base/layout.h"
#include "base/mesh.h"
#include "base/sincos.h"
#include "model/coordinate.h"
#include "model/joint_rows.h"
#include "reference/span.h"

#include <assert.h>
#include <float.h>
#include <math.h>
#include <stdlib.h>

// Puts a body's centre where it has moved to.
static inline void tree_set_centre(const Tree *tree, int body, Vec2 moved, TreeState *state)
{
    state->moved[body] = moved;
    state->motions[body].position = vec2_add(tree->base_motions[body].position, moved);
}

// Distances of a point from a line, and of a disc from a disc.

double tree_line_moved(const Tree *tree, const TreeState *state, int pair)
{
    const Vec2 normal = tree_normal(tree, state, pair);
    const Vec2 turned = tree_normal_turned(tree, state, pair);
    return vec2_dot(normal, tree_pair_moved(tree, state, pair)) +
           vec2_dot(turned, tree->base_gaps[pair]);
}

double tree_distance(const Tree *tree, const TreeState *state, int pair)
{
    if (tree->measures[pair] == TREE_LINE) {
        return tree->base_distances[pair] + tree_line_moved(tree, state, pair);
    }
    const Vec2 moved = tree_pair_moved(tree, state, pair);
    const Vec2 before = tree->base_gaps[pair];
    const Vec2 now = vec2_add(before, moved);
    const double sum = vec2_length(now) + vec2_length(before);
    return tree->base_distances[pair] +
           (sum > 0.0 ? vec2_dot(moved, vec2_add(before, now)) / sum : 0.0);
}

double tree_line_rate(const Tree *tree, const TreeState *state, int pair)
{
    const Vec2 normal = tree_normal(tree, state, pair);
    const double omega = tree_omega(state, tree->end_bodies[2 * pair]);
    return vec2_dot(normal, tree_pair_velocity(tree, state, pair)) +
           omega * vec2_dot(vec2_perp(normal), tree_pair_gap(tree, state, pair));
}

// The second rate from that of d, without what body a's rate of turning adds.
static double second_of(const Tree *tree, const TreeState *state, int pair, Vec2 second)
{
    const Vec2 normal = tree_normal(tree, state, pair);
    const double omega = tree_omega(state, tree->end_bodies[2 * pair]);
    return vec2_dot(normal, second) +
           2.0 * omega * vec2_dot(vec2_perp(normal), tree_pair_velocity(tree, state, pair)) -
           omega * omega * vec2_dot(normal, tree_pair_gap(tree, state, pair));
}

double tree_line_second(const Tree *tree, const TreeState *state, int pair)
{
    const Vec2 across = vec2_perp(tree_normal(tree, state, pair));
    return second_of(tree, state, pair, tree_pair_acceleration(tree, state, pair)) +
           tree_alpha(state, tree->end_bodies[2 * pair]) *
               vec2_dot(across, tree_pair_gap(tree, state, pair));
}

double tree_line_bias(const Tree *tree, const TreeState *state, int pair)
{
    const Vec2 across = vec2_perp(tree_normal(tree, state, pair));
    return second_of(tree, state, pair,
                     vec2_sub(tree_end_bias(tree, state, 2 * pair + 1),
                              tree_end_bias(tree, state, 2 * pair))) +
           tree_bias_alpha(tree, state, tree->end_bodies[2 * pair]) *
               vec2_dot(across, tree_pair_gap(tree, state, pair));
}

static double tree_turn_of(const TreeState *state, int body)
{
    return body == LINKAGE_GROUND ? 0.0 : state->turn[body];
}

double tree_tilt(const Tree *tree, const TreeState *state, int joint)
{
    return tree->base_tilts[joint] + (tree_turn_of(state, tree->end_bodies[2 * joint + 1]) -
                                      tree_turn_of(state, tree->end_bodies[2 * joint]));
}

// Slides: how a body follows the one that it slides on.
//
// It slides by x along the direction t of body a turns with its parent p, w_i = w_p = w, and
// with r = r_i - r_p and + where it is body b, - where it is body a:
//     r_i = r_p + R_p s_p +- x t - R_i s_i
//     v_i = v_p + w z x r +- x' t
//     a_i = a_p + al_p z x r - w^2 r +- (x'' t + 2 w x' z x t)

// Where a node is and how it moves, after its turn.
static void tree_slide_move(const Tree *tree, size_t number, const double *q, const double *u,
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
    const double alpha = tree_bias_alpha(tree, state, node->body);
    if (alpha != 0.0) {
        state->bias[node->body] =
            vec2_add(state->bias[node->body], vec2_scale(alpha, vec2_perp(behind)));
    }
    state->along[number] = along;
    state->behind[number] =
        node->parent == LINKAGE_GROUND ? behind : vec2_add(state->arms[node->parent_end], behind);
}

// The acceleration of its centre, m/s^2, from that of its parent and the second rate of its slide.
static Vec2 tree_slide_acceleration(const Tree *tree, size_t number, double rate,
                                    const TreeState *state)
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
    const double spun = parent->alpha - tree_bias_alpha(tree, state, node->parent);
    return vec2_add(acceleration,
                    vec2_add(beyond, vec2_scale(spun, vec2_perp(state->behind[number]))));
}

// How a body that slides has turned: as the one it slides on.
static void tree_slide_turn(const Tree *tree, const TreeNode *node, const double *q,
                            const double *u, TreeState *state)
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

// Turns a body's ends by an angle d since the base.
static inline void tree_set_arms(const Tree *tree, int body, double d, TreeState *state)
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

static void tree_set_driven(const Tree *tree, size_t number, double since_s, TreeState *state)
{
    const TreeDrive *drive = &tree->drives[number];
    const int body = drive->body;
    const DriveState now = state->drives[number] = drive_piece_at(&drive->base, since_s);
    Motion *motion = &state->motions[body];
    motion->angle = tree->base_motions[body].angle + now.angle;
    motion->omega = now.omega;
    motion->alpha = now.alpha;
    state->turn[body] = now.angle;
    tree_set_arms(tree, body, now.angle, state);
    const int end = 2 * drive->driver->joint + 1;
    const Vec2 arm = state->arms[end];
    tree_set_centre(tree, body, vec2_scale(-1.0, state->turned[end]), state);
    motion->velocity = vec2_scale(-now.omega, vec2_perp(arm));
    motion->acceleration =
        vec2_sub(vec2_scale(now.omega * now.omega, arm), vec2_scale(now.alpha, vec2_perp(arm)));
    state->bias[body] = motion->acceleration;
}

static void tree_set_all_driven(const Tree *tree, double since_s, TreeState *state)
{
    for (size_t i = 0; i < tree->drive_count; i++) {
        tree_set_driven(tree, i, since_s, state);
    }
}

static inline void tree_set_floating(const Tree *tree, const TreeNode *node, const double *q,
                                     const double *u, TreeState *state)
{
    const size_t column = node->column;
    tree_set_centre(tree, node->body, (Vec2){q[column - 2], q[column - 1]}, state);
    state->motions[node->body].velocity = (Vec2){u[column - 2], u[column - 1]};
    state->bias[node->body] = (Vec2){0.0, 0.0};
}

static inline void tree_set_hanging(const Tree *tree, const TreeNode *node, TreeState *state)
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
        const double alpha = tree_bias_alpha(tree, state, node->parent);
        if (alpha != 0.0) {
            bias = vec2_add(bias, vec2_scale(alpha, vec2_perp(outer)));
        }
    }
    tree_set_centre(tree, node->body, moved, state);
    motion->velocity = velocity;
    state->bias[node->body] = bias;
}

static inline void tree_set_node(const Tree *tree, size_t number, const double *q, const double *u,
                                 TreeState *state)
{
    const TreeNode *node = &tree->nodes[number];
    if (node->is_sliding) {
        tree_slide_turn(tree, node, q, u, state);
        tree_set_arms(tree, node->body, state->turn[node->body], state);
        tree_slide_move(tree, number, q, u, state);
        return;
    }
    const double turn = q[node->angle_column];
    Motion *motion = &state->motions[node->body];
    state->turn[node->body] = turn;
    motion->angle = tree->base_motions[node->body].angle + turn;
    motion->omega = u[node->angle_column];
    tree_set_arms(tree, node->body, turn, state);
    if (node->joint < 0) {
        tree_set_floating(tree, node, q, u, state);
    } else {
        tree_set_hanging(tree, node, state);
    }
}

void tree_evaluate(const Tree *tree, double since_s, const double *q, const double *u,
                   TreeState *state)
{
    tree_set_all_driven(tree, since_s, state);
    for (size_t i = 0; i < tree->node_count; i++) {
        tree_set_node(tree, i, q, u, state);
    }
}

// A body and all that it hangs on, the outermost last.
static void tree_evaluate_up_to(const Tree *tree, int body, const double *q, const double *u,
                                TreeState *state)
{
    int count = 0;
    for (int at = tree_node_of(tree, body); at >= 0; at = tree->nodes[at].parent_node) {
        state->path[count++] = at;
    }
    while (count > 0) {
        tree_set_node(tree, (size_t)state->path[--count], q, u, state);
    }
}

static size_t tree_depth_of(const Tree *tree, int body)
{
    const int node = tree_node_of(tree, body);
    return node >= 0 ? tree->nodes[node].depth : 0;
}

// Whether all nodes are evaluated at least as soon as those of a pair.
static bool tree_needs_all(const Tree *tree, int pair)
{
    return tree_depth_of(tree, tree->end_bodies[2 * pair]) +
               tree_depth_of(tree, tree->end_bodies[2 * pair + 1]) >=
           tree->node_count;
}

void tree_evaluate_pair(const Tree *tree, int pair, double since_s, const double *q,
                        const double *u, TreeState *state)
{
    if (tree_needs_all(tree, pair)) {
        tree_evaluate(tree, since_s, q, u, state);
        return;
    }
    tree_set_all_driven(tree, since_s, state);
    tree_evaluate_up_to(tree, tree->end_bodies[2 * pair], q, u, state);
    tree_evaluate_up_to(tree, tree->end_bodies[2 * pair + 1], q, u, state);
}

// Writes the coordinates that move a body.
static size_t tree_coordinates_of(const Tree *tree, int body, size_t *columns)
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
    if (tree_needs_all(tree, pair)) {
        return 0;
    }
    const size_t count = tree_coordinates_of(tree, tree->end_bodies[2 * pair], columns);
    return count + tree_coordinates_of(tree, tree->end_bodies[2 * pair + 1], columns + count);
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

// The base: where the linkage stands at the start of a step, in long double.
//
// A play of 10 um between links of a metre: of 16 digits of a position eleven are left for the pin
// in its hole. So the base, from which the coordinates of a step count, is held in long double, and
// the gap of each joint there comes from positions in long double. It is worked out once a step.

// of the time at a base: the stepper takes a kink that is no further for reached, too
static const double REACHED = 16.0 * DBL_EPSILON;

double tree_from(const Tree *tree)
{
    return (double)tree->base_time_s * (1.0 + REACHED);
}

static TreePoint add(TreePoint a, TreePoint b)
{
    return (TreePoint){a.x + b.x, a.y + b.y};
}

static TreePoint subtract(TreePoint a, TreePoint b)
{
    return (TreePoint){a.x - b.x, a.y - b.y};
}

static void tree_base_set_arms(Tree *tree, int body)
{
    long double s;
    long double c;
    sincos_find(tree->base_angle[body], &s, &c);
    for (size_t i = tree->end_firsts[body]; i < tree->end_firsts[body + 1]; i++) {
        const int end = tree->ends[i];
        const Vec2 anchor = tree->anchors[end];
        tree->long_arms[end] =
            (TreePoint){c * anchor.x - s * anchor.y, s * anchor.x + c * anchor.y};
    }
}

static TreePoint tree_base_end_point(const Tree *tree, int end)
{
    const int body = tree->end_bodies[end];
    return body == LINKAGE_GROUND ? (TreePoint){tree->anchors[end].x, tree->anchors[end].y}
                                  : add(tree->base_position[body], tree->long_arms[end]);
}

// The normal of a pair's line; of a body that does not move that of its frame.
static TreePoint normal_of(const Tree *tree, int pair)
{
    const int end = tree->normals + pair;
    return tree->end_bodies[end] == LINKAGE_GROUND
               ? (TreePoint){tree->anchors[end].x, tree->anchors[end].y}
               : tree->long_arms[end];
}

// Where a body that slides is, with the angle that it has on its parent.
static void settle_sliding(Tree *tree, const TreeNode *node)
{
    const Joint *joint = &tree->linkage->joints[node->joint];
    const bool is_b = node->own_end % 2 == 1;
    const long double slide_angle = is_b ? joint->held_angle : -(long double)joint->held_angle;
    tree->base_angle[node->body] =
        slide_angle + (node->parent == LINKAGE_GROUND ? 0.0L : tree->base_angle[node->parent]);
    tree_base_set_arms(tree, node->body);
    const TreePoint normal = normal_of(tree, node->joint);
    const long double slide = is_b ? tree->base_slide[node->body] : -tree->base_slide[node->body];
    const TreePoint moved = {slide * normal.y, -slide * normal.x};
    tree->base_position[node->body] = subtract(
        add(tree_base_end_point(tree, node->parent_end), moved), tree->long_arms[node->own_end]);
}

static long double base_angle_of(const Tree *tree, int body)
{
    return body == LINKAGE_GROUND ? 0.0L : tree->base_angle[body];
}

// Distances from lines and between discs, and tilts.
static void measure(Tree *tree)
{
    for (size_t i = 0; i < tree->measured_count; i++) {
        const int pair = tree->measured[i];
        const TreePoint gap =
            subtract(tree_base_end_point(tree, 2 * pair + 1), tree_base_end_point(tree, 2 * pair));
        long double distance = hypotl(gap.x, gap.y);
        if (tree->measures[pair] == TREE_LINE) {
            const TreePoint normal = normal_of(tree, pair);
            tree->base_arms[tree->normals + pair] = (Vec2){(double)normal.x, (double)normal.y};
            distance = normal.x * gap.x + normal.y * gap.y;
        }
        tree->base_distances[pair] = (double)(distance - tree->offsets[pair]);
    }
    for (size_t i = 0; tree->measured_count > 0 && i < tree->linkage->joint_count; i++) {
        const Joint *joint = &tree->linkage->joints[i];
        tree->base_tilts[i] = (double)(base_angle_of(tree, joint->body_b) -
                                       base_angle_of(tree, joint->body_a) - joint->held_angle);
    }
    for (int i = 0; i < (int)tree->linkage->joint_count; i++) {
        const Joint *joint = &tree->linkage->joints[i];
        if (joint->limits.kind != LIMIT_NONE && !joint_has_position(joint->kind)) {
            const int pair = 2 * i;
            const TreePoint gap =
                subtract(tree_base_end_point(tree, pair + 1), tree_base_end_point(tree, pair));
            tree_coordinate_settle(tree, i, gap, normal_of(tree, i));
        }
    }
}

// Centres of the bodies that hang, arms and gaps, from the angles and the floating bodies' centres.
static void tree_base_settle(Tree *tree)
{
    for (size_t i = 0; i < tree->drive_count; i++) {
        const int joint = tree->drives[i].driver->joint;
        tree_base_set_arms(tree, tree->drives[i].body);
        tree->base_position[tree->drives[i].body] =
            subtract(tree_base_end_point(tree, 2 * joint), tree->long_arms[2 * joint + 1]);
    }
    for (size_t i = 0; i < tree->node_count; i++) {
        const TreeNode *node = &tree->nodes[i];
        if (node->is_sliding) {
            settle_sliding(tree, node);
            continue;
        }
        tree_base_set_arms(tree, node->body);
        if (node->joint >= 0) {
            tree->base_position[node->body] = subtract(tree_base_end_point(tree, node->parent_end),
                                                       tree->long_arms[node->own_end]);
        }
    }
    for (int pair = 0; pair < (int)tree->pair_count; pair++) {
        const TreePoint gap =
            subtract(tree_base_end_point(tree, 2 * pair + 1), tree_base_end_point(tree, 2 * pair));
        tree->base_gaps[pair] = (Vec2){(double)gap.x, (double)gap.y};
        for (int end = 2 * pair; end <= 2 * pair + 1; end++) {
            if (tree->end_bodies[end] != LINKAGE_GROUND) {
                const TreePoint arm = tree->long_arms[end];
                tree->base_arms[end] = (Vec2){(double)arm.x, (double)arm.y};
            }
        }
    }
    for (size_t i = 0; i < tree->linkage->body_count; i++) {
        const TreePoint centre = tree->base_position[i];
        tree->base_motions[i].angle = (double)tree->base_angle[i];
        tree->base_motions[i].position = (Vec2){(double)centre.x, (double)centre.y};
    }
    measure(tree);
}

// The driven bodies at the base. A kink that is nearer than rounding has been reached.
static void put_drives(Tree *tree)
{
    for (size_t i = 0; i < tree->drive_count; i++) {
        TreeDrive *drive = &tree->drives[i];
        tree->base_angle[drive->body] = drive_angle_exact(drive->driver, tree->base_time_s);
        drive->base = drive_piece(drive->driver, tree_from(tree));
    }
}

void tree_start(Tree *tree, const Motion *motions, double *u)
{
    tree->base_time_s = 0.0L;
    put_drives(tree);
    for (size_t i = 0; i < tree->node_count; i++) {
        const TreeNode *node = &tree->nodes[i];
        const Motion *motion = &motions[node->body];
        tree->base_angle[node->body] = motion->angle;
        tree->base_position[node->body] = (TreePoint){motion->position.x, motion->position.y};
        if (node->is_sliding) {
            const Vec2 along = joint_rows_along(tree->linkage, motions, node->joint);
            const JointGap gap = linkage_joint_gap(tree->linkage, motions, node->joint);
            tree->base_slide[node->body] = vec2_dot(along, gap.position);
            u[node->column] = vec2_dot(along, gap.velocity);
            continue;
        }
        u[node->angle_column] = motion->omega;
        if (node->joint < 0) {
            u[node->angle_column - 2] = motion->velocity.x;
            u[node->angle_column - 1] = motion->velocity.y;
        }
    }
    tree_base_settle(tree);
}

void tree_rebase(Tree *tree, double since_s, double *q)
{
    tree->base_time_s += since_s;
    put_drives(tree);
    for (size_t i = 0; i < tree->node_count; i++) {
        const TreeNode *node = &tree->nodes[i];
        if (node->is_sliding) {
            tree->base_slide[node->body] += q[node->column];
            continue;
        }
        tree->base_angle[node->body] += q[node->angle_column];
        if (node->joint < 0) {
            TreePoint *centre = &tree->base_position[node->body];
            *centre =
                add(*centre, (TreePoint){q[node->angle_column - 2], q[node->angle_column - 1]});
        }
    }
    for (size_t i = 0; i < tree->coordinate_count; i++) {
        q[i] = 0.0;
    }
    tree_base_settle(tree);
}

double tree_time(const Tree *tree, double since_s)
{
    return (double)(tree->base_time_s + since_s);
}

// Building: which coordinates move a linkage.
//
// Found once: bodies hang on known ones by ideal joints, those that hang on nothing float, and
// ideal joints that are left over close loops (reference/span.h).

static void tree_add_node(Tree *tree, int body, int joint, int parent)
{
    TreeNode *node = &tree->nodes[tree->node_count++];
    *node =
        (TreeNode){.body = body, .joint = joint, .parent = parent, .parent_node = -1, .depth = 1};
    tree->coordinate_count += joint >= 0 ? 1 : 3;
    node->column = tree->coordinate_count - 1;
    node->angle_column = (int)node->column;
    if (joint >= 0) {
        const Joint *of = &tree->linkage->joints[joint];
        const bool is_own_b = of->body_b == body;
        node->own_end = 2 * joint + (is_own_b ? 1 : 0);
        node->parent_end = 2 * joint + (is_own_b ? 0 : 1);
        node->is_sliding = joint_slides(of->kind);
        node->parent_node = parent == LINKAGE_GROUND ? -1 : tree->node_of[parent];
        node->depth = node->parent_node >= 0 ? tree->nodes[node->parent_node].depth + 1 : 1;
        if (node->is_sliding) {
            node->angle_column = parent == LINKAGE_GROUND ? -1 : tree->angle_column[parent];
            tree->carried_by[body] = parent == LINKAGE_GROUND ? -1 : tree->carried_by[parent];
        }
        tree->is_driven_hung_on = tree->is_driven_hung_on || tree_drive_of(tree, parent) >= 0;
    }
    tree->angle_column[body] = node->angle_column;
    tree->node_of[body] = (int)tree->node_count - 1;
}

static void set_end(Tree *tree, int end, int body, Vec2 anchor)
{
    tree->end_bodies[end] = body;
    tree->anchors[end] = anchor;
    if (body == LINKAGE_GROUND && end >= tree->normals) {
        tree->base_arms[end] = anchor;
    }
}

// Sets the ends of a pair; with a line on body a whose normal has a direction there, rad.
static void set_pair(Tree *tree, int pair, const Joint *joint, const Touch *ends,
                     TreeMeasure measure)
{
    set_end(tree, 2 * pair, joint->body_a, ends->anchor_a);
    set_end(tree, 2 * pair + 1, joint->body_b, ends->anchor_b);
    tree->measures[pair] = measure;
    tree->offsets[pair] = ends->clearance;
    if (measure != TREE_POINTS) {
        tree->measured[tree->measured_count++] = pair;
    }
    if (measure == TREE_LINE) {
        set_end(tree, tree->normals + pair, joint->body_a,
                vec2_rotate(ends->direction, (Vec2){1.0, 0.0}));
    }
}

// The ends of each body, in the order of the pairs.
static void tree_list_ends(Tree *tree)
{
    const size_t bodies = tree->linkage->body_count;
    const int pairs = (int)tree->pair_count;
    for (int pass = 0; pass < 2; pass++) {
        for (int i = 0; i < 3 * pairs; i++) {
            const int end = i % 3 < 2 ? 2 * (i / 3) + i % 3 : tree->normals + i / 3;
            const int body = tree->end_bodies[end];
            if (body == LINKAGE_GROUND || (i % 3 == 2 && tree->measures[i / 3] != TREE_LINE)) {
                continue;
            }
            // the first pass counts; after the second each list begins where the one before ends
            if (pass == 1) {
                tree->ends[tree->end_firsts[body]] = end;
            }
            tree->end_firsts[body + (pass == 0 ? 1 : 0)]++;
        }
        for (size_t body = 0; pass == 0 && body < bodies; body++) {
            tree->end_firsts[body + 1] += tree->end_firsts[body];
        }
    }
    for (size_t body = bodies; body > 0; body--) {
        tree->end_firsts[body] = tree->end_firsts[body - 1];
    }
    tree->end_firsts[0] = 0;
}

// The centres of the arcs at the ends of a slot, the first one along it first.
static size_t ends_of_slot(const Joint *joint, Touch ends[TOUCH_CORNERS])
{
    const Vec2 along = vec2_perp(vec2_rotate(joint->direction, (Vec2){1.0, 0.0}));
    for (int i = 0; i < 2; i++) {
        const double way = (i == 0 ? -0.5 : 0.5) * joint->stop.slot;
        ends[i] = (Touch){
            .shape = TOUCH_SLOT,
            .anchor_a = vec2_add(joint->anchor_a, vec2_scale(way, along)),
            .anchor_b = joint->anchor_b,
        };
    }
    return 2;
}

size_t tree_own_pairs(const Linkage *linkage, int number, Touch sites[TOUCH_CORNERS])
{
    if (linkage_has_slot(&linkage->joints[number])) {
        return ends_of_slot(&linkage->joints[number], sites);
    }
    const bool has_own = joint_slides(linkage->joints[number].kind);
    return has_own ? touch_places(linkage, number, sites) : 0;
}

static void set_pairs(Tree *tree)
{
    const Linkage *linkage = tree->linkage;
    Touch sites[TOUCH_CORNERS];
    int corner = (int)linkage->joint_count;
    for (int i = 0; i < (int)linkage->joint_count; i++) {
        const Joint *joint = &linkage->joints[i];
        sites[0] = (Touch){
            .anchor_a = joint->anchor_a,
            .anchor_b = joint->anchor_b,
            .direction = joint->direction + 0.5 * M_PI,
        };
        TreeMeasure measure = TREE_POINTS;
        if (joint_has_disc(joint->kind)) {
            touch_places(linkage, i, sites);
            // of a cam the line from which its profile's angles count
            measure = sites[0].shape == TOUCH_DISC ? TREE_DISC : TREE_LINE;
            // of a slot its middle line
            sites[0].clearance = touch_has_walls(&sites[0]) ? 0.0 : sites[0].clearance;
        } else if (joint_has_mesh(joint->kind)) {
            // how far apart the centres are, beyond where the pitch circles touch
            sites[0].clearance = mesh_distance(&joint->gear);
            measure = TREE_DISC;
        } else if (joint_has_rack(joint->kind)) {
            // the way along the line is part of the coordinate
            sites[0].direction = joint->direction;
            measure = TREE_LINE;
        } else if (joint_slides(joint->kind)) {
            measure = TREE_LINE;
        }
        set_pair(tree, i, joint, &sites[0], measure);
    }
    for (int i = 0; i < (int)linkage->joint_count; i++) {
        const Joint *joint = &linkage->joints[i];
        tree->corners[i] = corner;
        const size_t own = tree_own_pairs(linkage, i, sites);
        for (size_t k = 0; k < own; k++) {
            set_pair(tree, corner++, joint, &sites[k],
                     touch_has_walls(&sites[k]) ? TREE_POINTS : TREE_LINE);
        }
    }
    tree_list_ends(tree);
}

// All arrays, from a layout that counts or has the memory.
static void tree_lay(Tree *tree, MemoryLayout *layout)
{
    const size_t bodies = tree->linkage->body_count;
    const size_t joints = tree->linkage->joint_count;
    const size_t pairs = tree->pair_count;
    const size_t ends = 3 * pairs;
    tree->nodes = layout_take(layout, bodies, sizeof *tree->nodes);
    tree->angle_column = layout_take(layout, bodies, sizeof *tree->angle_column);
    tree->node_of = layout_take(layout, bodies, sizeof *tree->node_of);
    tree->corners = layout_take(layout, joints, sizeof *tree->corners);
    tree->measured = layout_take(layout, pairs, sizeof *tree->measured);
    tree->measures = layout_take(layout, pairs, sizeof *tree->measures);
    tree->offsets = layout_take(layout, pairs, sizeof *tree->offsets);
    tree->end_bodies = layout_take(layout, ends, sizeof *tree->end_bodies);
    tree->anchors = layout_take(layout, ends, sizeof *tree->anchors);
    tree->end_firsts = layout_take(layout, bodies + 1, sizeof *tree->end_firsts);
    tree->ends = layout_take(layout, ends, sizeof *tree->ends);
    tree->carried_by = layout_take(layout, bodies, sizeof *tree->carried_by);
    tree->loops = layout_take(layout, joints, sizeof *tree->loops);
    tree->base_angle = layout_take(layout, bodies, sizeof *tree->base_angle);
    tree->base_position = layout_take(layout, bodies, sizeof *tree->base_position);
    tree->base_slide = layout_take(layout, bodies, sizeof *tree->base_slide);
    tree->base_motions = layout_take(layout, bodies, sizeof *tree->base_motions);
    tree->long_arms = layout_take(layout, ends, sizeof *tree->long_arms);
    tree->base_arms = layout_take(layout, ends, sizeof *tree->base_arms);
    tree->base_gaps = layout_take(layout, pairs, sizeof *tree->base_gaps);
    tree->base_distances = layout_take(layout, pairs, sizeof *tree->base_distances);
    tree->base_tilts = layout_take(layout, joints, sizeof *tree->base_tilts);
    tree->base_coordinates = layout_take(layout, joints, sizeof *tree->base_coordinates);
}

static void tree_make_room(Tree *tree)
{
    const Linkage *linkage = tree->linkage;
    tree->pair_count = linkage->joint_count;
    Touch sites[TOUCH_CORNERS];
    for (size_t i = 0; i < linkage->joint_count; i++) {
        tree->pair_count += tree_own_pairs(linkage, (int)i, sites);
    }
    tree->normals = 2 * (int)tree->pair_count;
    tree->end_count = 3 * tree->pair_count;
    MemoryLayout layout = {NULL, 0};
    tree_lay(tree, &layout);
    tree->memory_size = layout.used;
    tree->memory = calloc(1, layout.used);
    assert(tree->memory != NULL);
    tree_lay(tree, &(MemoryLayout){tree->memory, 0});
}

// The joints that the tree has not used, which close loops.
static void tree_list_loops(Tree *tree, const bool *is_used)
{
    const Linkage *linkage = tree->linkage;
    for (int i = 0; i < (int)linkage->joint_count; i++) {
        if (joint_is_ideal(linkage->joints[i].kind) && !is_used[i]) {
            tree->loops[tree->loop_count++] = i;
            tree->is_driven_hung_on = tree->is_driven_hung_on ||
                                      tree_drive_of(tree, linkage->joints[i].body_a) >= 0 ||
                                      tree_drive_of(tree, linkage->joints[i].body_b) >= 0;
        }
    }
}

// Puts all driven bodies outside the tree.
static void list_drives(Tree *tree)
{
    const Linkage *linkage = tree->linkage;
    for (size_t i = 0; i < linkage->body_count; i++) {
        tree->carried_by[i] = -1;
    }
    tree->drive_count = linkage_drive_count(linkage);
    for (size_t i = 0; i < tree->drive_count; i++) {
        const int body = linkage_drive_body(linkage, i);
        tree->drives[i] = (TreeDrive){.driver = linkage_drive(linkage, i), .body = body};
        tree->angle_column[body] = -1;
        tree->node_of[body] = -1;
        tree->carried_by[body] = (int)i;
    }
}

void tree_build(const Linkage *linkage, Tree *tree)
{
    *tree = (Tree){.linkage = linkage, .driven = linkage_driven_body(linkage)};
    tree_make_room(tree);
    set_pairs(tree);
    list_drives(tree);
    Span span = span_find(linkage);
    for (size_t i = 0; i < span.count; i++) {
        tree_add_node(tree, span.steps[i].body, span.steps[i].joint, span.steps[i].parent);
    }
    tree_list_loops(tree, span.is_used);
    span_finish(&span);
}

void tree_finish(Tree *tree)
{
    free(tree->memory);
}

void tree_state_lay(const Tree *tree, MemoryLayout *layout, TreeState *state)
{
    const size_t bodies = tree->linkage->body_count;
    state->motions = layout_take(layout, bodies, sizeof *state->motions);
    state->arms = layout_take(layout, tree->end_count, sizeof *state->arms);
    state->turned = layout_take(layout, tree->end_count, sizeof *state->turned);
    state->moved = layout_take(layout, bodies, sizeof *state->moved);
    state->turn = layout_take(layout, bodies, sizeof *state->turn);
    state->bias = layout_take(layout, bodies, sizeof *state->bias);
    state->along = layout_take(layout, tree->node_count, sizeof *state->along);
    state->behind = layout_take(layout, tree->node_count, sizeof *state->behind);
    state->path = layout_take(layout, tree->node_count, sizeof *state->path);
}
