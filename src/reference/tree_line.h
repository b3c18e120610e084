// Distances between the ends of a pair that are measured along one direction: the normal n of a
// line that turns with body a, or the line between the centres of two discs.
//
// With d from the end on body a to that on body b, w_a body a's speed of turning, al_a its rate:
//     line    n . d             n . d' + w_a (perp n) . d
//             n . d'' + 2 w_a (perp n) . d' + al_a (perp n) . d - w_a^2 n . d
//     discs   |d|               d . d' / |d|
// An offset is subtracted. What it has changed since the base, m the movement of d and dn that of
// n:
//     line    n . m + dn . d0   discs   m . (2 d0 + m) / (|d0 + m| + |d0|)
// has all the digits of a double, and the distance at the base comes from long double.
#pragma once

#include "reference/tree_state.h"

// How fast a body turns, rad/s, and the rate of that after tree_accelerate.
static inline double tree_omega(const TreeState *state, int body)
{
    return body == LINKAGE_GROUND ? 0.0 : state->motions[body].omega;
}

static inline double tree_alpha(const TreeState *state, int body)
{
    return body == LINKAGE_GROUND ? 0.0 : state->motions[body].alpha;
}

// The unit normal of a pair's line, and its change since the base.
static inline Vec2 tree_normal(const Tree *tree, const TreeState *state, int pair)
{
    const int end = tree->normals + pair;
    return tree->end_bodies[end] == LINKAGE_GROUND ? tree->base_arms[end] : state->arms[end];
}

static inline Vec2 tree_normal_turned(const Tree *tree, const TreeState *state, int pair)
{
    const int end = tree->normals + pair;
    return tree->end_bodies[end] == LINKAGE_GROUND ? (Vec2){0.0, 0.0} : state->turned[end];
}

// The distance of a pair that has a line or discs, m, less its offset.
double tree_distance(const Tree *tree, const TreeState *state, int pair);

// The rate of the distance from a line, m/s, and its second rate, m/s^2, after tree_accelerate; or
// that without accelerations of the coordinates.
double tree_line_rate(const Tree *tree, const TreeState *state, int pair);
double tree_line_second(const Tree *tree, const TreeState *state, int pair);
double tree_line_bias(const Tree *tree, const TreeState *state, int pair);

// The angle of body b of a prismatic joint or a block against the one that is not tilted, rad.
double tree_tilt(const Tree *tree, const TreeState *state, int joint);
