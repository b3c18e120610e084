// Where does the linkage stand at the start of a step, to more digits than a double has?
//
// A play of 10 um between links of a metre: of 16 digits of a position eleven are left for the pin
// in its hole. So the base, from which the coordinates of a step count, is held in long double, and
// the gap of each joint there comes from positions in long double. It is worked out once a step.
#include "reference/tree.h"

static TreePoint add(TreePoint a, TreePoint b)
{
    return (TreePoint){a.x + b.x, a.y + b.y};
}

static TreePoint subtract(TreePoint a, TreePoint b)
{
    return (TreePoint){a.x - b.x, a.y - b.y};
}

static void set_arms(const Tree *tree, int body, TreePoint *arms)
{
    const long double c = cosl(tree->base_angle[body]);
    const long double s = sinl(tree->base_angle[body]);
    for (size_t i = 0; i < tree->end_counts[body]; i++) {
        const int end = tree->ends[body][i];
        const Vec2 anchor = tree->anchors[end];
        arms[end] = (TreePoint){c * anchor.x - s * anchor.y, s * anchor.x + c * anchor.y};
    }
}

static TreePoint end_point(const Tree *tree, const TreePoint *arms, int end)
{
    const int body = tree->end_bodies[end];
    return body == LINKAGE_GROUND ? (TreePoint){tree->anchors[end].x, tree->anchors[end].y}
                                  : add(tree->base_position[body], arms[end]);
}

// Centres of the bodies that hang, arms and gaps, from the angles and the floating bodies' centres.
static void settle(Tree *tree)
{
    TreePoint arms[TREE_END_MAX];
    if (tree->driven >= 0) {
        const int joint = tree->linkage->driver.joint;
        set_arms(tree, tree->driven, arms);
        tree->base_position[tree->driven] =
            subtract(end_point(tree, arms, 2 * joint), arms[2 * joint + 1]);
    }
    for (size_t i = 0; i < tree->node_count; i++) {
        const TreeNode *node = &tree->nodes[i];
        set_arms(tree, node->body, arms);
        if (node->joint >= 0) {
            tree->base_position[node->body] =
                subtract(end_point(tree, arms, node->parent_end), arms[node->own_end]);
        }
    }
    for (int joint = 0; joint < (int)tree->linkage->joint_count; joint++) {
        const TreePoint gap =
            subtract(end_point(tree, arms, 2 * joint + 1), end_point(tree, arms, 2 * joint));
        tree->base_gaps[joint] = (Vec2){(double)gap.x, (double)gap.y};
        for (int end = 2 * joint; end <= 2 * joint + 1; end++) {
            if (tree->end_bodies[end] != LINKAGE_GROUND) {
                tree->base_arms[end] = (Vec2){(double)arms[end].x, (double)arms[end].y};
            }
        }
    }
}

void tree_start(Tree *tree, const Motion *motions, double *u)
{
    tree->base_time_s = 0.0L;
    if (tree->driven >= 0) {
        tree->base_angle[tree->driven] = tree->linkage->driver.start;
    }
    for (size_t i = 0; i < tree->node_count; i++) {
        const TreeNode *node = &tree->nodes[i];
        const Motion *motion = &motions[node->body];
        tree->base_angle[node->body] = motion->angle;
        tree->base_position[node->body] = (TreePoint){motion->position.x, motion->position.y};
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
        const Driver *driver = &tree->linkage->driver;
        tree->base_angle[tree->driven] = driver->start + driver->speed * tree->base_time_s;
    }
    for (size_t i = 0; i < tree->node_count; i++) {
        const TreeNode *node = &tree->nodes[i];
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
