// How are closed loops in space kept closed, and by which rows?
//
// With a and b the ends of a joint and u their axes the rows hold
//     e_k . (r_b - r_a) = 0,  k = x, y, z        s_k . u_b = 0,  s_k carried by body a, across u_a
// whose second rates are, with t_k = u_b x s_k,
//     e_k . (a_b - a_a)       t_k . (al_b - al_a) + t_k' . (w_b - w_a),
//     t_k' = (w_b x u_b) x s_k + u_b x (w_a x s_k)
#include "reference/space_loops.h"

#include "base/dense.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { PASSES = 2 };

// rad, or of a body's reach: the lengths and axes of a case have at least five digits
static const double TORN = 1e-5;

// m: a start is closed to some 1e-12; a pin farther from its own was meant to be elsewhere
static const double ROUNDED = 1e-10;

static Vec3 side_of(const SpaceTree *tree, const SpaceTreeState *state, const SpaceLoops *loops,
                    const SpaceLoopRow *row)
{
    const Vec3 base = loops->base_sides[row->joint][row->which - SPACE_POINT_ROWS];
    return space_tree_direction(state, tree->ends[2 * row->joint].body, base);
}

static Vec3 point_axis(int which)
{
    static const Vec3 AXES[SPACE_POINT_ROWS] = {{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}};
    return AXES[which];
}

Vec3 space_loops_direction(const SpaceTree *tree, const SpaceTreeState *state,
                           const SpaceLoops *loops, size_t number)
{
    const SpaceLoopRow *row = &loops->rows[number];
    if (row->which < SPACE_POINT_ROWS) {
        return point_axis(row->which);
    }
    return vec3_cross(space_tree_axis(tree, state, 2 * row->joint + 1),
                      side_of(tree, state, loops, row));
}

// Adds what one end has of a row, with a sign.
static void add_end(const SpaceTree *tree, const SpaceTreeState *state, int end, bool is_point,
                    Vec3 direction, double *by_coordinate)
{
    const int body = tree->ends[end].body;
    if (body == LINKAGE_GROUND || body == tree->driven) {
        return;
    }
    const SpaceNode *node = &tree->nodes[tree->node_of[body]];
    const SpaceColumn *columns = state->columns[tree->node_of[body]];
    const Vec3 moment = is_point ? vec3_cross(state->arms[end], direction) : direction;
    for (size_t i = 0; i < node->chain_count; i++) {
        double by = vec3_dot(columns[i].angular, moment);
        by += is_point ? vec3_dot(columns[i].linear, direction) : 0.0;
        by_coordinate[node->chain[i]] += by;
    }
}

void space_loops_row(const SpaceTree *tree, const SpaceTreeState *state, const SpaceLoops *loops,
                     size_t number, double *by_coordinate)
{
    const SpaceLoopRow *row = &loops->rows[number];
    const Vec3 direction = space_loops_direction(tree, state, loops, number);
    const bool is_point = row->which < SPACE_POINT_ROWS;
    memset(by_coordinate, 0, tree->coordinate_count * sizeof *by_coordinate);
    const int end = 2 * row->joint;
    add_end(tree, state, end, is_point, vec3_scale(-1.0, direction), by_coordinate);
    add_end(tree, state, end + 1, is_point, direction, by_coordinate);
}

double space_loops_bias(const SpaceTree *tree, const SpaceTreeState *state, const SpaceLoops *loops,
                        size_t number)
{
    const SpaceLoopRow *row = &loops->rows[number];
    const int end = 2 * row->joint;
    const int a = tree->ends[end].body;
    const int b = tree->ends[end + 1].body;
    const Vec3 direction = space_loops_direction(tree, state, loops, number);
    if (row->which < SPACE_POINT_ROWS) {
        return vec3_dot(direction, vec3_sub(space_tree_bias(state, b, state->arms[end + 1]),
                                            space_tree_bias(state, a, state->arms[end])));
    }
    const SpaceBodyState *at_a = space_tree_body(state, a);
    const SpaceBodyState *at_b = space_tree_body(state, b);
    const Vec3 side = side_of(tree, state, loops, row);
    const Vec3 axis = space_tree_axis(tree, state, end + 1);
    const Vec3 turning = vec3_add(vec3_cross(vec3_cross(at_b->omega, axis), side),
                                  vec3_cross(axis, vec3_cross(at_a->omega, side)));
    return vec3_dot(direction, vec3_sub(at_b->spin_bias, at_a->spin_bias)) +
           vec3_dot(turning, vec3_sub(at_b->omega, at_a->omega));
}

// How far a row is open, m or rad, or how fast it opens.
static double opening_of(const SpaceTree *tree, const SpaceTreeState *state,
                         const SpaceLoops *loops, size_t number, bool is_rate)
{
    const SpaceLoopRow *row = &loops->rows[number];
    const int end = 2 * row->joint;
    const int a = tree->ends[end].body;
    const int b = tree->ends[end + 1].body;
    const Vec3 direction = space_loops_direction(tree, state, loops, number);
    const bool is_point = row->which < SPACE_POINT_ROWS;
    if (is_rate && is_point) {
        return vec3_dot(direction, vec3_sub(space_tree_velocity(state, b, state->arms[end + 1]),
                                            space_tree_velocity(state, a, state->arms[end])));
    }
    if (is_rate) {
        return vec3_dot(direction, vec3_sub(space_tree_body(state, b)->omega,
                                            space_tree_body(state, a)->omega));
    }
    return is_point
               ? vec3_dot(direction, space_tree_gap(tree, state, row->joint))
               : vec3_dot(space_tree_axis(tree, state, end + 1), side_of(tree, state, loops, row));
}

static double product(size_t n, const double *a, const double *b)
{
    double sum = 0.0;
    for (size_t i = 0; i < n; i++) {
        sum += a[i] * b[i];
    }
    return sum;
}

// Changes x by J^T (J J^T)^-1 (-opening).
static void move_least(const SpaceTree *tree, const SpaceTreeState *state, const SpaceLoops *loops,
                       bool is_rate, double *x)
{
    const size_t n = tree->coordinate_count;
    const size_t rows = loops->row_count;
    double *jacobian = malloc((rows * n + rows * rows + rows) * sizeof *jacobian);
    assert(jacobian != NULL);
    double *square = jacobian + rows * n;
    double *right = square + rows * rows;
    for (size_t i = 0; i < rows; i++) {
        space_loops_row(tree, state, loops, i, jacobian + i * n);
        right[i] = -opening_of(tree, state, loops, i, is_rate);
    }
    for (size_t i = 0; i < rows; i++) {
        for (size_t k = 0; k < rows; k++) {
            square[i * rows + k] = product(n, jacobian + i * n, jacobian + k * n);
        }
    }
    if (dense_solve(rows, square, right)) {
        for (size_t i = 0; i < rows; i++) {
            for (size_t j = 0; j < n; j++) {
                x[j] += right[i] * jacobian[i * n + j];
            }
        }
    }
    free(jacobian);
}

double space_loops_project(const SpaceTree *tree, const SpaceLoops *loops, double since_s,
                           double *q, double *u, SpaceTreeState *scratch)
{
    if (loops->row_count == 0) {
        return 0.0;
    }
    for (int pass = 0; pass < PASSES; pass++) {
        space_tree_evaluate(tree, since_s, q, u, scratch);
        move_least(tree, scratch, loops, false, q);
    }
    space_tree_evaluate(tree, since_s, q, u, scratch);
    move_least(tree, scratch, loops, true, u);
    double largest = 0.0;
    for (size_t i = 0; i < loops->row_count; i++) {
        largest = fmax(largest, fabs(opening_of(tree, scratch, loops, i, false)));
    }
    return largest;
}

int space_loops_torn(const SpaceTree *tree, const SpaceTreeState *state, const SpaceLoops *loops)
{
    SpaceLoops one = *loops;
    for (size_t i = 0; i < tree->loop_count; i++) {
        const int joint = tree->loops[i];
        for (int which = 0; which < SPACE_JOINT_ROWS; which++) {
            const int body = tree->ends[2 * joint + 1].body;
            const double reach = linkage_reach(
                tree->linkage, body == LINKAGE_GROUND ? tree->ends[2 * joint].body : body);
            one.rows[0] = (SpaceLoopRow){joint, which};
            const double opening = fabs(opening_of(tree, state, &one, 0, false));
            if (!(opening <= TORN * (which < SPACE_POINT_ROWS ? reach : 1.0))) {
                return joint;
            }
        }
    }
    return -1;
}

void space_loops_start(SpaceTree *tree, SpaceLoops *loops, double *q, double *u,
                       SpaceTreeState *scratch)
{
    space_tree_evaluate(tree, 0.0, q, u, scratch);
    space_loops_choose(tree, scratch, true, loops);
    space_loops_project(tree, loops, 0.0, q, u, scratch);
    space_tree_rebase(tree, 0.0, q, u);
    const Linkage *linkage = tree->linkage;
    if (!linkage->driver.is_present) {
        return;
    }
    // pins are brought to their starts as loops are closed, with speeds that are not used
    SpaceTree *pinned = malloc(sizeof *pinned);
    assert(pinned != NULL);
    *pinned = *tree;
    bool are_near = true;
    for (int i = 0; i < (int)linkage->joint_count; i++) {
        if (linkage->joints[i].kind == JOINT_CLEARANCE) {
            const Vec2 start = linkage->joints[i].clearance.start;
            pinned->loops[pinned->loop_count++] = i;
            pinned->base_gaps[i] = vec3_sub(tree->base_gaps[i], (Vec3){start.x, start.y, 0.0});
            are_near = are_near && vec3_length(pinned->base_gaps[i]) <= ROUNDED;
        }
    }
    SpaceLoops pins = {.row_count = 0};
    double rates[SPACE_TREE_COORDINATE_MAX] = {0.0};
    if (are_near) {
        space_tree_evaluate(pinned, 0.0, q, rates, scratch);
        space_loops_choose(pinned, scratch, true, &pins);
        if (space_loops_project(pinned, &pins, 0.0, q, rates, scratch) <= ROUNDED) {
            space_tree_rebase(tree, 0.0, q, u);
        }
    }
    free(pinned);
}
