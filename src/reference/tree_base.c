// Where does the linkage stand at the start of a step, to more digits than a double has?
//
// A play of 10 um between links of a metre: of 16 digits of a position eleven are left for the pin
// in its hole. So the base, from which the coordinates of a step count, is held in long double, and
// the gap of each joint there comes from positions in long double. It is worked out once a step.
#include "reference/tree.h"

#include "base/sincos.h"
#include "model/joint_rows.h"
#include "reference/tree_coordinate.h"
#include "reference/tree_line.h"

#include <float.h>

// of the time at a base: the stepper takes a kink that is no further for reached, too
static const double REACHED = 16.0 * DBL_EPSILON;

static TreePoint add(TreePoint a, TreePoint b)
{
    return (TreePoint){a.x + b.x, a.y + b.y};
}

static TreePoint subtract(TreePoint a, TreePoint b)
{
    return (TreePoint){a.x - b.x, a.y - b.y};
}

static void set_arms(Tree *tree, int body)
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

static TreePoint end_point(const Tree *tree, int end)
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
    const long double held = is_b ? joint->held_angle : -(long double)joint->held_angle;
    tree->base_angle[node->body] =
        held + (node->parent == LINKAGE_GROUND ? 0.0L : tree->base_angle[node->parent]);
    set_arms(tree, node->body);
    const TreePoint normal = normal_of(tree, node->joint);
    const long double slide = is_b ? tree->base_slide[node->body] : -tree->base_slide[node->body];
    const TreePoint moved = {slide * normal.y, -slide * normal.x};
    tree->base_position[node->body] =
        subtract(add(end_point(tree, node->parent_end), moved), tree->long_arms[node->own_end]);
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
        const TreePoint gap = subtract(end_point(tree, 2 * pair + 1), end_point(tree, 2 * pair));
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
        if (joint->limits.kind != LIMIT_NONE && joint->kind != JOINT_PRISMATIC) {
            tree_coordinate_settle(tree, i);
        }
    }
}

// Centres of the bodies that hang, arms and gaps, from the angles and the floating bodies' centres.
static void settle(Tree *tree)
{
    if (tree->driven >= 0) {
        const int joint = tree->linkage->driver.joint;
        set_arms(tree, tree->driven);
        tree->base_position[tree->driven] =
            subtract(end_point(tree, 2 * joint), tree->long_arms[2 * joint + 1]);
    }
    for (size_t i = 0; i < tree->node_count; i++) {
        const TreeNode *node = &tree->nodes[i];
        if (node->is_sliding) {
            settle_sliding(tree, node);
            continue;
        }
        set_arms(tree, node->body);
        if (node->joint >= 0) {
            tree->base_position[node->body] =
                subtract(end_point(tree, node->parent_end), tree->long_arms[node->own_end]);
        }
    }
    for (int pair = 0; pair < (int)tree->pair_count; pair++) {
        const TreePoint gap = subtract(end_point(tree, 2 * pair + 1), end_point(tree, 2 * pair));
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

// The driven body at the base. A kink of its speed that is nearer than rounding has been reached.
static void put_drive(Tree *tree)
{
    const Driver *driver = &tree->linkage->driver;
    const double time_s = (double)tree->base_time_s;
    tree->base_angle[tree->driven] = drive_angle_exact(driver, tree->base_time_s);
    tree->base_drive = drive_at(driver, time_s * (1.0 + REACHED));
}

void tree_start(Tree *tree, const Motion *motions, double *u)
{
    tree->base_time_s = 0.0L;
    if (tree->driven >= 0) {
        put_drive(tree);
    }
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
    settle(tree);
}

void tree_rebase(Tree *tree, double since_s, double *q)
{
    tree->base_time_s += since_s;
    if (tree->driven >= 0) {
        put_drive(tree);
    }
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
    settle(tree);
}

double tree_time(const Tree *tree, double since_s)
{
    return (double)(tree->base_time_s + since_s);
}
