// The freedoms of a linkage as a tree: one angle for each body that hangs on an ideal joint, place
// and angle for one that floats, and two constraint rows for each ideal joint that closes a loop.
//
// Ideal joints of the tree hold exactly, by construction. The driven body and the ground are known.
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
    // where each body stood when tree_rebase was called: near there its direction comes cheap
    double base_angle[LINKAGE_BODY_MAX];
    Vec2 base_direction[LINKAGE_BODY_MAX];
} Tree;

// Where the tree's bodies are and how their velocities depend on the coordinates' rates.
typedef struct TreeState {
    Motion motions[LINKAGE_BODY_MAX]; // of all bodies; accelerations after tree_accelerate
    Vec2 arms[TREE_END_MAX];          // from the body's centre to each end, m; not of ground ends
    Vec2 bias[LINKAGE_BODY_MAX]; // acceleration of each centre with all coordinates' rates steady
    // velocity of each node's centre by the rate of each coordinate of its chain
    Vec2 columns[LINKAGE_BODY_MAX][TREE_COORDINATE_MAX];
} TreeState;

// Finds the tree of the linkage's ideal joints.
void tree_build(const Linkage *linkage, Tree *tree);

// Coordinates and their rates of given motions.
void tree_coordinates(const Tree *tree, const Motion *motions, double *q, double *u);

// Says that the coming evaluations will be near these coordinates and this time.
void tree_rebase(Tree *tree, double time_s, const double *q);

// Places, velocities, columns and bias at a time from coordinates and rates.
void tree_evaluate(const Tree *tree, double time_s, const double *q, const double *u,
                   TreeState *state);

// Fills in the accelerations from the coordinates' second rates.
void tree_accelerate(const Tree *tree, const double *rates, TreeState *state);

// An end of a joint: its place, velocity, bias and (after tree_accelerate) acceleration.
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
