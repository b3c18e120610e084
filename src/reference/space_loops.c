// How are closed loops in space kept closed, and by which rows?
//
// With a and b the ends of a joint and u their axes the rows hold
//     e_k . (r_b - r_a) = 0,  k = x, y, z        s_k . u_b = 0,  s_k carried by body a, across u_a
// whose second rates are, with t_k = u_b x s_k,
//     e_k . (a_b - a_a)       t_k . (al_b - al_a) + t_k' . (w_b - w_a),
//     t_k' = (w_b x u_b) x s_k + u_b x (w_a x s_k)
#include "reference/space_loops.h"

#include "base/zeroed.h"

#include <math.h>
#include <string.h>

enum { PASSES = 2 };

// rad, or of a body's reach: the lengths and axes of a case have at least five digits
static const double TORN = 1e-5;

// m: a start is closed to some 1e-12; a pin farther from its own was meant to be elsewhere
static const double ROUNDED = 1e-10;

SpaceLoops *space_loops_create(const SpaceTree *tree, size_t count, const int *joints)
{
    const size_t rows = SPACE_JOINT_ROWS * count;
    SpaceLoops *loops = zeroed(1, sizeof *loops);
    *loops = (SpaceLoops){
        .tree = tree,
        .count = count,
        .joints = zeroed(count, sizeof *loops->joints),
        .base_sides = zeroed(count, sizeof *loops->base_sides),
        .rows = zeroed(rows, sizeof *loops->rows),
        .articulated = space_articulated_create(tree, count, joints),
        .sides = zeroed(rows, sizeof *loops->sides),
        .solved = zeroed(tree->coordinate_count + rows, sizeof *loops->solved),
    };
    for (size_t i = 0; i < count; i++) {
        loops->joints[i] = joints[i];
    }
    space_loop_groups_init(tree, count, joints, &loops->groups);
    return loops;
}

void space_loops_destroy(SpaceLoops *loops)
{
    if (loops == NULL) {
        return;
    }
    space_loop_groups_finish(&loops->groups);
    space_articulated_destroy(loops->articulated);
    free(loops->joints);
    free(loops->base_sides);
    free(loops->rows);
    free(loops->sides);
    free(loops->solved);
    free(loops);
}

static Vec3 side_of(const SpaceLoops *loops, const SpaceTreeState *state, size_t loop, int which)
{
    const int body = loops->tree->ends[2 * loops->joints[loop]].body;
    return space_tree_direction(state, body, loops->base_sides[loop][which - SPACE_POINT_ROWS]);
}

Vec3 space_loops_direction(const SpaceLoops *loops, const SpaceTreeState *state, size_t loop,
                           int which)
{
    static const Vec3 AXES[SPACE_POINT_ROWS] = {{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}};
    if (which < SPACE_POINT_ROWS) {
        return AXES[which];
    }
    return vec3_cross(space_tree_axis(loops->tree, state, 2 * loops->joints[loop] + 1),
                      side_of(loops, state, loop, which));
}

void space_loops_turn(SpaceLoops *loops, const SpaceTreeState *state)
{
    for (size_t i = 0; i < SPACE_JOINT_ROWS * loops->count; i++) {
        if (loops->rows[i].is_held) {
            loops->rows[i].direction = space_loops_direction(loops, state, i / SPACE_JOINT_ROWS,
                                                             (int)(i % SPACE_JOINT_ROWS));
        }
    }
}

double space_loops_bias(const SpaceLoops *loops, const SpaceTreeState *state, size_t loop,
                        int which)
{
    const SpaceTree *tree = loops->tree;
    const int end = 2 * loops->joints[loop];
    const int a = tree->ends[end].body;
    const int b = tree->ends[end + 1].body;
    const Vec3 direction = loops->rows[SPACE_JOINT_ROWS * loop + (size_t)which].direction;
    if (which < SPACE_POINT_ROWS) {
        return vec3_dot(direction, vec3_sub(space_tree_bias(state, b, state->arms[end + 1]),
                                            space_tree_bias(state, a, state->arms[end])));
    }
    const SpaceBodyState *at_a = space_tree_body(state, a);
    const SpaceBodyState *at_b = space_tree_body(state, b);
    const Vec3 side = side_of(loops, state, loop, which);
    const Vec3 axis = space_tree_axis(tree, state, end + 1);
    const Vec3 turning = vec3_add(vec3_cross(vec3_cross(at_b->omega, axis), side),
                                  vec3_cross(axis, vec3_cross(at_a->omega, side)));
    return vec3_dot(direction, vec3_sub(at_b->spin_bias, at_a->spin_bias)) +
           vec3_dot(turning, vec3_sub(at_b->omega, at_a->omega));
}

// How far a row is open, m or rad, or how fast it opens.
static double opening_of(const SpaceLoops *loops, const SpaceTreeState *state, size_t loop,
                         int which, bool is_rate)
{
    const SpaceTree *tree = loops->tree;
    const int joint = loops->joints[loop];
    const int end = 2 * joint;
    const int a = tree->ends[end].body;
    const int b = tree->ends[end + 1].body;
    const Vec3 direction = space_loops_direction(loops, state, loop, which);
    const bool is_point = which < SPACE_POINT_ROWS;
    if (is_rate && is_point) {
        return vec3_dot(direction, vec3_sub(space_tree_velocity(state, b, state->arms[end + 1]),
                                            space_tree_velocity(state, a, state->arms[end])));
    }
    if (is_rate) {
        return vec3_dot(direction, vec3_sub(space_tree_body(state, b)->omega,
                                            space_tree_body(state, a)->omega));
    }
    return is_point ? vec3_dot(direction, space_tree_gap(tree, state, joint))
                    : vec3_dot(space_tree_axis(tree, state, end + 1),
                               side_of(loops, state, loop, which));
}

// Changes x by the least that takes the openings of all rows, or their rates, away.
static void move_least(SpaceLoops *loops, const SpaceTreeState *state, bool is_rate, double *x)
{
    space_loops_turn(loops, state);
    for (size_t i = 0; i < SPACE_JOINT_ROWS * loops->count; i++) {
        loops->sides[i] = loops->rows[i].is_held ? -opening_of(loops, state, i / SPACE_JOINT_ROWS,
                                                               (int)(i % SPACE_JOINT_ROWS), is_rate)
                                                 : 0.0;
    }
    if (!space_articulated_factor(loops->articulated, state, loops->rows)) {
        return;
    }
    space_articulated_solve(loops->articulated, state, NULL, loops->sides, loops->solved);
    for (size_t j = 0; j < loops->tree->coordinate_count; j++) {
        x[j] += loops->solved[j];
    }
}

double space_loops_project(SpaceLoops *loops, double since_s, double *q, double *u,
                           SpaceTreeState *scratch)
{
    const SpaceTree *tree = loops->tree;
    if (loops->row_count == 0) {
        return 0.0;
    }
    for (int pass = 0; pass < PASSES; pass++) {
        space_tree_evaluate(tree, since_s, q, u, scratch);
        move_least(loops, scratch, false, q);
    }
    space_tree_evaluate(tree, since_s, q, u, scratch);
    move_least(loops, scratch, true, u);
    double largest = 0.0;
    for (size_t i = 0; i < SPACE_JOINT_ROWS * loops->count; i++) {
        if (loops->rows[i].is_held) {
            largest = fmax(largest, fabs(opening_of(loops, scratch, i / SPACE_JOINT_ROWS,
                                                    (int)(i % SPACE_JOINT_ROWS), false)));
        }
    }
    return largest;
}

int space_loops_torn(const SpaceLoops *loops, const SpaceTreeState *state)
{
    const SpaceTree *tree = loops->tree;
    for (size_t i = 0; i < loops->count; i++) {
        const int joint = loops->joints[i];
        const int body = tree->ends[2 * joint + 1].body;
        const double reach =
            tree->reaches[body == LINKAGE_GROUND ? tree->ends[2 * joint].body : body];
        for (int which = 0; which < SPACE_JOINT_ROWS; which++) {
            const double opening = fabs(opening_of(loops, state, i, which, false));
            if (!(opening <= TORN * (which < SPACE_POINT_ROWS ? reach : 1.0))) {
                return joint;
            }
        }
    }
    return -1;
}

// Closes the loops with the pins of the joints with play at their starts, if only rounding is left
// of the way there, with speeds that are not used.
static void bring(SpaceTree *tree, double *q, SpaceTreeState *scratch)
{
    const Linkage *linkage = tree->linkage;
    int *joints = zeroed(linkage->joint_count, sizeof *joints);
    double *rates = zeroed(tree->coordinate_count, sizeof *rates);
    size_t count = tree->loop_count;
    memcpy(joints, tree->loops, count * sizeof *joints);
    bool are_near = true;
    for (int i = 0; i < (int)linkage->joint_count; i++) {
        if (linkage->joints[i].kind == JOINT_CLEARANCE) {
            const Vec2 start = linkage->joints[i].clearance.start;
            joints[count++] = i;
            tree->base_gaps[i] = vec3_sub(tree->base_gaps[i], (Vec3){start.x, start.y, 0.0});
            are_near = are_near && vec3_length(tree->base_gaps[i]) <= ROUNDED;
        }
    }
    if (are_near) {
        SpaceLoops *pinned = space_loops_create(tree, count, joints);
        space_tree_evaluate(tree, 0.0, q, rates, scratch);
        space_loops_choose(pinned, scratch, true);
        space_loops_project(pinned, 0.0, q, rates, scratch);
        space_loops_destroy(pinned);
    }
    free(rates);
    free(joints);
}

void space_loops_start(SpaceTree *tree, SpaceLoops *loops, double *q, double *u,
                       SpaceTreeState *scratch)
{
    space_tree_evaluate(tree, 0.0, q, u, scratch);
    space_loops_choose(loops, scratch, true);
    space_loops_project(loops, 0.0, q, u, scratch);
    space_tree_rebase(tree, 0.0, q, u);
    if (tree->linkage->driver.is_present) {
        bring(tree, q, scratch);
        // where they are not near, the gaps count from the base again
        space_tree_rebase(tree, 0.0, q, u);
    }
}
