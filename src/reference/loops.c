// How are closed loops kept closed?
//
// After a step the coordinates are moved by the least (in the sum of squares) that satisfies
//     Phi + J dq = 0   and   J (u + du) + drift = 0
// with Phi the gaps and drift the anchors' relative velocity at rest coordinates. Two Newton steps
// take the gap of a good step, 1e-12 m, to rounding.
#include "reference/loops.h"

#include "base/dense.h"
#include "reference/tree_line.h"

#include <string.h>

enum { PASSES = 2, ROW_MAX = 2 * TREE_LOOP_MAX };

// m, or rad: a start is closed to some 1e-12; a pin farther from its own was meant to be elsewhere
static const double ROUNDED = 1e-10;

// Adds the velocity of one end by each coordinate, with a sign.
static void add_end(const Tree *tree, const TreeState *state, int end, double sign, Vec2 *row)
{
    const int body = tree->end_bodies[end];
    if (body == LINKAGE_GROUND || body == tree->driven) {
        return;
    }
    const TreeNode *node = &tree->nodes[tree->node_of[body]];
    const Vec2 *columns = state->columns[tree->node_of[body]];
    for (size_t i = 0; i < node->chain_count; i++) {
        Vec2 *entry = &row[node->chain[i]];
        *entry = vec2_add(*entry, vec2_scale(sign, columns[i]));
    }
    if (node->angle_column >= 0) {
        Vec2 *angle = &row[node->angle_column];
        *angle = vec2_add(*angle, vec2_scale(sign, vec2_perp(state->arms[end])));
    }
}

// The coordinate that is a body's angle, or -1.
static int angle_column(const Tree *tree, int body)
{
    return body == LINKAGE_GROUND ? -1 : tree->angle_column[body];
}

void loops_pair_row(const Tree *tree, const TreeState *state, int pair, Vec2 *row)
{
    const int end = 2 * pair;
    for (size_t j = 0; j < tree->coordinate_count; j++) {
        row[j] = (Vec2){0.0, 0.0};
    }
    add_end(tree, state, end, -1.0, row);
    add_end(tree, state, end + 1, 1.0, row);
    const int turning = angle_column(tree, tree->end_bodies[end]);
    if (tree->measures[pair] == TREE_LINE && turning >= 0) {
        row[turning] = vec2_sub(row[turning], vec2_perp(tree_pair_gap(tree, state, pair)));
    }
}

// Whether the rows of a joint are a distance from a line and a tilt.
static bool is_on_line(const Tree *tree, int joint)
{
    const JointKind kind = tree->linkage->joints[joint].kind;
    return kind == JOINT_PRISMATIC || kind == JOINT_GUIDE;
}

void loops_row(const Tree *tree, const TreeState *state, size_t loop, Vec2 *row)
{
    const int joint = tree->loops[loop];
    loops_pair_row(tree, state, joint, row);
    if (!is_on_line(tree, joint)) {
        return;
    }
    const Vec2 normal = tree_normal(tree, state, joint);
    for (size_t j = 0; j < tree->coordinate_count; j++) {
        row[j] = (Vec2){vec2_dot(normal, row[j]), 0.0};
    }
    for (int side = 0; side < 2; side++) {
        const int turning = angle_column(tree, tree->end_bodies[2 * joint + side]);
        if (turning >= 0) {
            row[turning].y += side == 0 ? -1.0 : 1.0;
        }
    }
}

Vec2 loops_bias(const Tree *tree, const TreeState *state, size_t loop)
{
    const int joint = tree->loops[loop];
    if (is_on_line(tree, joint)) {
        return (Vec2){tree_line_bias(tree, state, joint),
                      tree_bias_alpha(tree, tree->end_bodies[2 * joint + 1]) -
                          tree_bias_alpha(tree, tree->end_bodies[2 * joint])};
    }
    return vec2_sub(tree_end_bias(tree, state, 2 * joint + 1),
                    tree_end_bias(tree, state, 2 * joint));
}

// Gap (or its rate) of one loop.
static Vec2 loop_gap(const Tree *tree, const TreeState *state, size_t loop, bool is_rate)
{
    const int joint = tree->loops[loop];
    if (is_on_line(tree, joint)) {
        const double turning = tree_omega(state, tree->end_bodies[2 * joint + 1]) -
                               tree_omega(state, tree->end_bodies[2 * joint]);
        return is_rate ? (Vec2){tree_line_rate(tree, state, joint), turning}
                       : (Vec2){tree_distance(tree, state, joint), tree_tilt(tree, state, joint)};
    }
    return is_rate ? tree_pair_velocity(tree, state, joint) : tree_pair_gap(tree, state, joint);
}

// Changes x by J^T (J J^T)^-1 (-gap).
static void move_least(const Tree *tree, const TreeState *state, bool is_rate, double *x)
{
    const size_t n = tree->coordinate_count;
    const size_t rows = 2 * tree->loop_count;
    double jacobian[ROW_MAX][TREE_COORDINATE_MAX];
    double square[ROW_MAX * ROW_MAX];
    double right[ROW_MAX];
    Vec2 row[TREE_COORDINATE_MAX];
    for (size_t loop = 0; loop < tree->loop_count; loop++) {
        loops_row(tree, state, loop, row);
        const Vec2 gap = loop_gap(tree, state, loop, is_rate);
        right[2 * loop] = -gap.x;
        right[2 * loop + 1] = -gap.y;
        for (size_t j = 0; j < n; j++) {
            jacobian[2 * loop][j] = row[j].x;
            jacobian[2 * loop + 1][j] = row[j].y;
        }
    }
    for (size_t i = 0; i < rows; i++) {
        for (size_t k = 0; k < rows; k++) {
            double sum = 0.0;
            for (size_t j = 0; j < n; j++) {
                sum += jacobian[i][j] * jacobian[k][j];
            }
            square[i * rows + k] = sum;
        }
    }
    if (!dense_solve(rows, square, right)) {
        return;
    }
    for (size_t i = 0; i < rows; i++) {
        for (size_t j = 0; j < n; j++) {
            x[j] += right[i] * jacobian[i][j];
        }
    }
}

double loops_project(const Tree *tree, double since_s, double *q, double *u)
{
    if (tree->loop_count == 0) {
        return 0.0;
    }
    TreeState state;
    for (int pass = 0; pass < PASSES; pass++) {
        tree_evaluate(tree, since_s, q, u, &state);
        move_least(tree, &state, false, q);
    }
    tree_evaluate(tree, since_s, q, u, &state);
    move_least(tree, &state, true, u);
    double largest = 0.0;
    for (size_t loop = 0; loop < tree->loop_count; loop++) {
        largest = fmax(largest, vec2_length(loop_gap(tree, &state, loop, false)));
    }
    return largest;
}

// Counts the gap of a joint from where it starts. Returns whether only rounding is left of it.
static bool starts_rounded(Tree *tree, int joint)
{
    const Joint *of = &tree->linkage->joints[joint];
    if (of->kind == JOINT_GUIDE) {
        tree->base_distances[joint] -= of->guide.start.x;
        tree->base_tilts[joint] -= of->guide.start.y;
        return hypot(tree->base_distances[joint], tree->base_tilts[joint]) <= ROUNDED;
    }
    tree->base_gaps[joint] = vec2_sub(tree->base_gaps[joint], of->clearance.start);
    return vec2_length(tree->base_gaps[joint]) <= ROUNDED;
}

void loops_start(Tree *tree, double *q, double *u)
{
    loops_project(tree, 0.0, q, u);
    tree_rebase(tree, 0.0, q);
    const Linkage *linkage = tree->linkage;
    if (!linkage->driver.is_present) {
        return;
    }
    // pins and blocks are brought to their starts as loops are closed, with speeds that are not
    // used
    Tree pinned = *tree;
    for (int i = 0; i < (int)linkage->joint_count; i++) {
        if (linkage->joints[i].kind == JOINT_CLEARANCE || linkage->joints[i].kind == JOINT_GUIDE) {
            pinned.loops[pinned.loop_count++] = i;
            if (!starts_rounded(&pinned, i)) {
                return;
            }
        }
    }
    double rates[TREE_COORDINATE_MAX] = {0.0};
    if (loops_project(&pinned, 0.0, q, rates) <= ROUNDED) {
        tree_rebase(tree, 0.0, q);
    }
}
