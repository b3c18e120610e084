// The freedoms of a linkage as a tree: one angle for each body that hangs on an ideal joint, place
// and angle for one that floats, and two constraint rows for each ideal joint that closes a loop.
//
// Ideal joints of the tree hold exactly, by construction. The driven body and the ground are known.
// Time and coordinates are those since the base: where the linkage stood at the start of the
// present step, kept in long double. How far a pin has moved in its hole since then carries all the
// digits of a double, however long the links and whatever the angles.
#pragma once

#include "model/linkage.h"

enum {
    TREE_COORDINATE_MAX = 3 * LINKAGE_BODY_MAX,
    TREE_LOOP_MAX = LINKAGE_JOINT_MAX,
};

// The ends of the joints: end 2 j is joint j's anchor on body a, end 2 j + 1 that on body b.
enum { TREE_END_MAX = 2 * LINKAGE_JOINT_MAX };

typedef struct TreeNode {
    int body;            // number of a body that is free to move
    int joint;           // ideal joint it hangs on, or -1 for a floating body
    int parent;          // body at the other end of that joint; LINKAGE_GROUND or a body's number
    int parent_end;      // of the joint, on the parent
    int own_end;         // and on the body
    size_t angle_column; // coordinate that is its angle; a floating body's x and y stand before it
    size_t chain_count;  // coordinates that move it, its own last, and which
    size_t chain[TREE_COORDINATE_MAX];
} TreeNode;

// m, in the world
typedef struct TreePoint {
    long double x;
    long double y;
} TreePoint;

typedef struct Tree {
    const Linkage *linkage;
    int driven;        // number of the driven body or LINKAGE_GROUND
    size_t node_count; // free bodies, parents before children
    TreeNode nodes[LINKAGE_BODY_MAX];
    int angle_column[LINKAGE_BODY_MAX];  // by body; -1 for the driven one
    int node_of[LINKAGE_BODY_MAX];       // by body; -1 for the driven one
    int end_bodies[TREE_END_MAX];        // the body of each end, or LINKAGE_GROUND
    Vec2 anchors[TREE_END_MAX];          // of each end in its body's frame, m
    size_t end_counts[LINKAGE_BODY_MAX]; // how many ends each body has, and which
    int ends[LINKAGE_BODY_MAX][TREE_END_MAX];
    size_t coordinate_count;
    bool is_driven_hung_on; // whether a body hangs on the driven one by an ideal joint
    size_t loop_count;
    int loops[TREE_LOOP_MAX]; // ideal joints that close loops
    // the base
    long double base_time_s;
    long double base_angle[LINKAGE_BODY_MAX];  // rad
    TreePoint base_position[LINKAGE_BODY_MAX]; // of the centres
    Vec2 base_arms[TREE_END_MAX];              // from the body's centre to each end, m
    Vec2 base_gaps[LINKAGE_JOINT_MAX];         // from the end on body a to that on body b, m
} Tree;

// Where the tree's bodies are and how their velocities depend on the coordinates' rates.
typedef struct TreeState {
    Motion motions[LINKAGE_BODY_MAX]; // of all bodies; accelerations after tree_accelerate
    Vec2 arms[TREE_END_MAX];          // from the body's centre to each end, m; not of ground ends
    Vec2 turned[TREE_END_MAX];        // change of that arm since the base, m
    Vec2 moved[LINKAGE_BODY_MAX];     // of each centre since the base, m
    Vec2 bias[LINKAGE_BODY_MAX]; // acceleration of each centre with all coordinates' rates steady
    // velocity of each node's centre by the rate of each coordinate of its chain
    Vec2 columns[LINKAGE_BODY_MAX][TREE_COORDINATE_MAX];
} TreeState;

// Finds the tree of the linkage's ideal joints.
void tree_build(const Linkage *linkage, Tree *tree);

// Puts the base at given motions at time zero, and writes the coordinates' rates there.
void tree_start(Tree *tree, const Motion *motions, double *u);

// Moves the base on to a time and coordinates since the present one, and zeroes the coordinates.
void tree_rebase(Tree *tree, double since_s, double *q);

// The time, s, that lies so long after the base.
double tree_time(const Tree *tree, double since_s);

// Positions, velocities, columns and bias, from time and coordinates since the base and from rates.
void tree_evaluate(const Tree *tree, double since_s, const double *q, const double *u,
                   TreeState *state);

// Fills in the accelerations from the coordinates' second rates.
void tree_accelerate(const Tree *tree, const double *rates, TreeState *state);

// How far an end of a joint has moved since the base, m.
static inline Vec2 tree_end_moved(const Tree *tree, const TreeState *state, int end)
{
    const int body = tree->end_bodies[end];
    return body == LINKAGE_GROUND ? (Vec2){0.0, 0.0}
                                  : vec2_add(state->moved[body], state->turned[end]);
}

// Where the end on body b of a joint is, seen from that on body a, m.
static inline Vec2 tree_joint_gap(const Tree *tree, const TreeState *state, int joint)
{
    const Vec2 moved = vec2_sub(tree_end_moved(tree, state, 2 * joint + 1),
                                tree_end_moved(tree, state, 2 * joint));
    return vec2_add(tree->base_gaps[joint], moved);
}

// An end of a joint: its position, velocity, bias and (after tree_accelerate) acceleration.
static inline Vec2 tree_end_point(const Tree *tree, const TreeState *state, int end)
{
    const int body = tree->end_bodies[end];
    return body == LINKAGE_GROUND ? tree->anchors[end]
                                  : vec2_add(state->motions[body].position, state->arms[end]);
}

static inline Vec2 tree_end_velocity(const Tree *tree, const TreeState *state, int end)
{
    const int body = tree->end_bodies[end];
    if (body == LINKAGE_GROUND) {
        return (Vec2){0.0, 0.0};
    }
    const Motion *motion = &state->motions[body];
    return vec2_add(motion->velocity, vec2_scale(motion->omega, vec2_perp(state->arms[end])));
}

static inline Vec2 tree_end_bias(const Tree *tree, const TreeState *state, int end)
{
    const int body = tree->end_bodies[end];
    if (body == LINKAGE_GROUND) {
        return (Vec2){0.0, 0.0};
    }
    const double omega = state->motions[body].omega;
    return vec2_sub(state->bias[body], vec2_scale(omega * omega, state->arms[end]));
}

static inline Vec2 tree_end_acceleration(const Tree *tree, const TreeState *state, int end)
{
    const int body = tree->end_bodies[end];
    if (body == LINKAGE_GROUND) {
        return (Vec2){0.0, 0.0};
    }
    const Motion *motion = &state->motions[body];
    const Vec2 turned = vec2_sub(vec2_scale(motion->alpha, vec2_perp(state->arms[end])),
                                 vec2_scale(motion->omega * motion->omega, state->arms[end]));
    return vec2_add(motion->acceleration, turned);
}

// How the end on body b of a joint moves against that on body a.
static inline Vec2 tree_joint_velocity(const Tree *tree, const TreeState *state, int joint)
{
    return vec2_sub(tree_end_velocity(tree, state, 2 * joint + 1),
                    tree_end_velocity(tree, state, 2 * joint));
}

static inline Vec2 tree_joint_acceleration(const Tree *tree, const TreeState *state, int joint)
{
    return vec2_sub(tree_end_acceleration(tree, state, 2 * joint + 1),
                    tree_end_acceleration(tree, state, 2 * joint));
}
