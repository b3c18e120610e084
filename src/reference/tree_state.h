// The freedoms of a linkage as a tree: one angle for each body that hangs on a revolute joint, one
// slide for each that hangs on a prismatic joint (its angle is that of the body it hangs on), place
// and angle for one that floats, and two constraint rows for each ideal joint that closes a loop.
//
// Ideal joints of the tree hold exactly, by construction. The driven body and the ground are known.
// Time and coordinates are those since the base: where the linkage stood at the start of the
// present step, kept in long double. How far a pin has moved in its hole since then carries all the
// digits of a double, however long the links and whatever the angles.
#pragma once

#include "contact/touch.h"

// Pairs of points, one on body a and one on body b: pair j has the anchors of joint j, those behind
// the joints' the corners of blocks between guides and points of the guides, and sliders with their
// stops. End 2 p is on body a,
// end 2 p + 1 on body b. Behind all of these are the unit normals of the lines of the pairs that
// have one (Tree.normals): they turn with body a as arms do.

// What the distance between the ends of a pair is measured along (reference/tree_line.h).
typedef enum TreeMeasure {
    TREE_POINTS, // x and y
    TREE_LINE,   // the normal of a line on body a
    TREE_DISC,   // the line from one end to the other: the ends are centres of discs
} TreeMeasure;

typedef struct TreeNode {
    int body;         // number of a body that is free to move
    int joint;        // ideal joint it hangs on, or -1 for a floating body
    bool is_sliding;  // whether that is a prismatic joint
    int parent;       // body at the other end of that joint; LINKAGE_GROUND or a body's number
    int parent_node;  // and its node, -1: of the ground and the driven body, which have none
    int parent_end;   // of the joint, on the parent
    int own_end;      // and on the body
    int angle_column; // coordinate that is its angle, or that of the body on which it slides: -1
                      // where a drive or the ground has it; a floating body's x and y stand
                      // before it
    size_t column;    // its own coordinate: the angle, or the slide
    size_t depth;     // how many nodes move it, itself one of them
} TreeNode;

// m, in the world
typedef struct TreePoint {
    long double x;
    long double y;
} TreePoint;

typedef struct Tree {
    const Linkage *linkage;
    void *memory;      // owned; where all arrays are
    int driven;        // number of the driven body or LINKAGE_GROUND
    size_t node_count; // free bodies, parents before children
    TreeNode *nodes;
    int *angle_column;     // by body; -1 for the driven one and what slides on it
    int *node_of;          // by body; -1 for the driven one
    size_t pair_count;     // those of the joints first
    int *corners;          // first pair of a block's corners or a slider's stops, by joint
    size_t measured_count; // pairs with a line or discs, and which
    int *measured;         //
    TreeMeasure *measures; // by pair
    double *offsets;       // m, by which the distance of that pair counts less
    int normals;           // the first of the normals among the ends
    size_t end_count;      // ends and normals
    int *end_bodies;       // the body of each end, or LINKAGE_GROUND
    Vec2 *anchors;         // of each end in its body's frame, m
    size_t *end_firsts;    // by body, and one more: where its ends begin in the list of ends
    int *ends;             // body by body
    size_t coordinate_count;
    bool *is_carried;       // by body: whether its angle is the driven body's, and follows it
    bool is_driven_hung_on; // whether a body hangs on the driven one by an ideal joint
    size_t loop_count;
    int *loops; // ideal joints that close loops
    // the base
    long double base_time_s;
    DriveState base_drive;    // its acceleration holds through the step
    long double *base_angle;  // rad
    TreePoint *base_position; // of the centres
    long double *base_slide;  // m, of bodies that slide
    Motion *base_motions;     // angles and positions, rounded
    TreePoint *long_arms;     // from the body's centre to each end, m
    Vec2 *base_arms;          // the same, rounded
    Vec2 *base_gaps;          // from the end on body a to that on body b, m
    double *base_distances;   // m, of measured pairs, offset subtracted
    double *base_tilts;       // rad, of prismatic joints and blocks
    double *base_coordinates; // rad or m, of joints whose angle or teeth are limited, by joint
} Tree;

// Where the tree's bodies are and how their velocities depend on the coordinates' rates.
typedef struct TreeState {
    Motion *motions; // of all bodies; accelerations after tree_accelerate
    Vec2 *arms;      // from the body's centre to each end, m; not of ground ends
    Vec2 *turned;    // change of that arm since the base, m
    Vec2 *moved;     // of each centre since the base, m
    double *turn;    // of each body since the base, rad
    Vec2 *bias;      // acceleration of each centre with all coordinates' rates steady
    Vec2 *along;     // of a node that slides: the direction
    Vec2 *behind;    // and from the parent's centre to its own, m
    int *path;       // room for the numbers of nodes
} TreeState;

// The node of a body, or -1 of the driven one and the ground.
static inline int tree_node_of(const Tree *tree, int body)
{
    return body == LINKAGE_GROUND ? -1 : tree->node_of[body];
}

// How far an end of a joint has moved since the base, m.
static inline Vec2 tree_end_moved(const Tree *tree, const TreeState *state, int end)
{
    const int body = tree->end_bodies[end];
    return body == LINKAGE_GROUND ? (Vec2){0.0, 0.0}
                                  : vec2_add(state->moved[body], state->turned[end]);
}

// How far the end on body b of a pair has moved against that on body a since the base, m.
static inline Vec2 tree_pair_moved(const Tree *tree, const TreeState *state, int pair)
{
    return vec2_sub(tree_end_moved(tree, state, 2 * pair + 1),
                    tree_end_moved(tree, state, 2 * pair));
}

// Where the end on body b of a pair is, seen from that on body a, m.
static inline Vec2 tree_pair_gap(const Tree *tree, const TreeState *state, int pair)
{
    return vec2_add(tree->base_gaps[pair], tree_pair_moved(tree, state, pair));
}

// How fast a body's speed of turning changes with all coordinates' rates steady, rad/s^2: as the
// drive's where the body turns with it.
static inline double tree_bias_alpha(const Tree *tree, int body)
{
    const double alpha = tree->base_drive.alpha;
    return alpha != 0.0 && body != LINKAGE_GROUND && tree->is_carried[body] ? alpha : 0.0;
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
    const Vec2 bias = vec2_sub(state->bias[body], vec2_scale(omega * omega, state->arms[end]));
    const double alpha = tree_bias_alpha(tree, body);
    return alpha != 0.0 ? vec2_add(bias, vec2_scale(alpha, vec2_perp(state->arms[end]))) : bias;
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

// How the end on body b of a pair moves against that on body a.
static inline Vec2 tree_pair_velocity(const Tree *tree, const TreeState *state, int pair)
{
    return vec2_sub(tree_end_velocity(tree, state, 2 * pair + 1),
                    tree_end_velocity(tree, state, 2 * pair));
}

static inline Vec2 tree_pair_acceleration(const Tree *tree, const TreeState *state, int pair)
{
    return vec2_sub(tree_end_acceleration(tree, state, 2 * pair + 1),
                    tree_end_acceleration(tree, state, 2 * pair));
}
