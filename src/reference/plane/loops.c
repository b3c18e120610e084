// Keeps closed loops closed.
//
// After a step the coordinates are moved by the least that satisfies
//     Phi + J dq = 0   and   J (u + du) + drift = 0
// with Phi the gaps and drift the anchors' relative velocity at rest coordinates: by
//     M^-1 J^T (J M^-1 J^T)^-1 (-Phi)
// which the equations of motion give, with no force but the gaps on the right side. One Newton step
// takes the gap of a good step, 1e-9 m, to rounding, and two that of a stage.
#include "reference/plane/articulated.h"

#include "reference/plane/tree.h"

#include <assert.h>
#include <float.h>
#include <stdlib.h>
#include <string.h>

enum { LOOPS_PASSES = 2 };

// 1, of the arms that a gap is between
static const double LOOPS_ROUNDING = 2.0 * DBL_EPSILON;

// m, or rad: a start is closed to some 1e-12; a pin farther from its own was meant to be elsewhere
static const double LOOPS_CLOSED_SHARE = 1e-10;

// 1: the root of what is left of the pivot of a loop that others do not close, of its own; of one
// that they close rounding leaves some 1e-8
static const double LOOPS_INDEPENDENT = 1e-6;

void loops_pair_row(const Tree *tree, const TreeState *state, int pair, Vec2 *row)
{
    const int end = 2 * pair;
    const Vec2 *arms = state->arms;
    Vec2 arm_a = arms[end];
    if (tree->measures[pair] == TREE_LINE) {
        arm_a = vec2_add(arm_a, tree_pair_gap(tree, state, pair));
    }
    tree_point_row(tree, state, tree->end_bodies[end], arm_a, -1.0, row);
    tree_point_row(tree, state, tree->end_bodies[end + 1], arms[end + 1], 1.0, row);
}

// Whether the rows of a joint are a distance from a line and a tilt.
static bool is_on_line(const Tree *tree, int joint)
{
    return joint_slides(tree->linkage->joints[joint].kind);
}

Vec2 loops_bias(const Tree *tree, const TreeState *state, size_t loop)
{
    const int joint = tree->loops[loop];
    if (is_on_line(tree, joint)) {
        return (Vec2){tree_line_bias(tree, state, joint),
                      tree_bias_alpha(tree, state, tree->end_bodies[2 * joint + 1]) -
                          tree_bias_alpha(tree, state, tree->end_bodies[2 * joint])};
    }
    return vec2_sub(tree_end_bias(tree, state, 2 * joint + 1),
                    tree_end_bias(tree, state, 2 * joint));
}

// Gap (or its rate) of one loop.
static Vec2 loop_gap(const Tree *tree, const TreeState *state, int joint, bool is_rate)
{
    if (is_on_line(tree, joint)) {
        const double turning = tree_omega(state, tree->end_bodies[2 * joint + 1]) -
                               tree_omega(state, tree->end_bodies[2 * joint]);
        return is_rate ? (Vec2){tree_line_rate(tree, state, joint), turning}
                       : (Vec2){tree_distance(tree, state, joint), tree_tilt(tree, state, joint)};
    }
    return is_rate ? tree_pair_velocity(tree, state, joint) : tree_pair_gap(tree, state, joint);
}

// Changes x by the least that takes the gaps of all loops, or their rates, away.
static void loops_move_least(const LoopsRoom *room, bool is_rate, double *x)
{
    for (size_t loop = 0; loop < room->loop_count; loop++) {
        const Vec2 gap = loop_gap(room->tree, room->state, room->loops[loop], is_rate);
        room->sides[2 * loop] = -gap.x;
        room->sides[2 * loop + 1] = -gap.y;
    }
    if (!articulated_factor(room->articulated, room->state)) {
        return;
    }
    articulated_solve(room->articulated, room->pushes, room->sides, room->solved);
    for (size_t j = 0; j < room->tree->coordinate_count; j++) {
        x[j] += room->solved[j];
    }
}

// Whether nothing but rounding is left of the gaps of all loops.
static bool are_closed(const LoopsRoom *room)
{
    const Tree *tree = room->tree;
    const Vec2 *arms = room->state->arms;
    for (size_t loop = 0; loop < room->loop_count; loop++) {
        const int joint = room->loops[loop];
        const double reach = vec2_length(arms[2 * joint]) + vec2_length(arms[2 * joint + 1]);
        const Vec2 gap = loop_gap(tree, room->state, joint, false);
        if (!(vec2_length(gap) <= LOOPS_ROUNDING * reach)) {
            return false;
        }
    }
    return true;
}

double loops_project(const LoopsRoom *room, double since_s, double *q, double *u)
{
    if (room->loop_count == 0) {
        return 0.0;
    }
    const Tree *tree = room->tree;
    // near a change point the rows turn much in little: each move asks for them anew
    tree_evaluate(tree, since_s, q, u, room->state);
    for (int pass = 0; pass < LOOPS_PASSES && (pass == 0 || !are_closed(room)); pass++) {
        loops_move_least(room, false, q);
        tree_evaluate(tree, since_s, q, u, room->state);
    }
    loops_move_least(room, true, u);
    double largest = 0.0;
    for (size_t loop = 0; loop < room->loop_count; loop++) {
        largest = fmax(largest, vec2_length(loop_gap(tree, room->state, room->loops[loop], false)));
    }
    return largest;
}

// Counts the gap of a joint from where it starts. Returns whether only rounding is left of it.
static bool starts_rounded(Tree *tree, int joint)
{
    const Joint *of = &tree->linkage->joints[joint];
    if (joint_has_guides(of->kind)) {
        tree->base_distances[joint] -= of->guide.start.x;
        tree->base_tilts[joint] -= of->guide.start.y;
        return hypot(tree->base_distances[joint], tree->base_tilts[joint]) <= LOOPS_CLOSED_SHARE;
    }
    tree->base_gaps[joint] = vec2_sub(tree->base_gaps[joint], of->clearance.start);
    return vec2_length(tree->base_gaps[joint]) <= LOOPS_CLOSED_SHARE;
}

// Whether no loop is closed by the others: several pins between two bodies are not brought
// anywhere.
static bool are_independent(const LoopsRoom *room, const double *q, const double *rates)
{
    tree_evaluate(room->tree, 0.0, q, rates, room->state);
    return articulated_factor(room->articulated, room->state) &&
           room->articulated->distance > LOOPS_INDEPENDENT;
}

// Brings the pins and blocks of a start to their own as loops are closed, with speeds that are not
// used. Returns whether they are there.
static bool loops_bring(Tree *tree, const LoopsRoom *of, double *q)
{
    const Linkage *linkage = tree->linkage;
    const size_t n = tree->coordinate_count;
    const size_t most = linkage->joint_count;
    int *loops = malloc((most + 1) * sizeof *loops);
    double *room = calloc(2 * n + 4 * most + 1, sizeof *room);
    assert(loops != NULL && room != NULL);
    LoopsRoom pinned = *of;
    memcpy(loops, of->loops, of->loop_count * sizeof *loops);
    bool are_near = true;
    for (int i = 0; i < (int)linkage->joint_count; i++) {
        if (joint_is_loose(linkage->joints[i].kind)) {
            loops[pinned.loop_count++] = i;
            are_near = starts_rounded(tree, i) && are_near;
        }
    }
    if (are_near) {
        pinned.loops = loops;
        pinned.articulated = articulated_create(tree, pinned.loop_count, loops);
        pinned.sides = room;
        pinned.solved = room + 2 * most;
        double *rates = room + n + 4 * most;
        are_near = are_independent(&pinned, q, rates) &&
                   loops_project(&pinned, 0.0, q, rates) <= LOOPS_CLOSED_SHARE;
        articulated_destroy(pinned.articulated);
    }
    free(room);
    free(loops);
    return are_near;
}

void loops_start(Tree *tree, const LoopsRoom *room, double *q, double *u)
{
    loops_project(room, 0.0, q, u);
    tree_rebase(tree, 0.0, q);
    if (!tree->linkage->driver.is_present) {
        return;
    }
    loops_bring(tree, room, q);
    // where they are not, the gaps count from the base again
    tree_rebase(tree, 0.0, q);
}
