// How far is a point from a line, or a disc from a disc?
#include "reference/tree_line.h"

double tree_distance(const Tree *tree, const TreeState *state, int pair)
{
    const Vec2 moved = tree_pair_moved(tree, state, pair);
    const Vec2 before = tree->base_gaps[pair];
    if (tree->measures[pair] == TREE_LINE) {
        const Vec2 normal = tree_normal(tree, state, pair);
        const Vec2 turned = tree_normal_turned(tree, state, pair);
        return tree->base_distances[pair] + (vec2_dot(normal, moved) + vec2_dot(turned, before));
    }
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
           tree_bias_alpha(tree, tree->end_bodies[2 * pair]) *
               vec2_dot(across, tree_pair_gap(tree, state, pair));
}

static double turn_of(const TreeState *state, int body)
{
    return body == LINKAGE_GROUND ? 0.0 : state->turn[body];
}

double tree_tilt(const Tree *tree, const TreeState *state, int joint)
{
    return tree->base_tilts[joint] + (turn_of(state, tree->end_bodies[2 * joint + 1]) -
                                      turn_of(state, tree->end_bodies[2 * joint]));
}
