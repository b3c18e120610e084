// The freedoms of a linkage in space as a tree: one angle for each body that hangs on an ideal
// joint, place and turn for one that floats; ideal joints that close loops have constraint rows
// (reference/space_loops.h).
//
// As in the plane (reference/tree.h) the ideal joints of the tree hold exactly, by construction,
// and time and coordinates are those since the base, which is kept in long double: how far a pin
// has moved in its hole since then carries all the digits of a double.
#pragma once

#include "model/space_rows.h"

enum {
    SPACE_TREE_COORDINATE_MAX = SPACE_COLUMN_MAX,
    SPACE_TREE_LOOP_MAX = SPACE_JOINT_MAX,
    SPACE_TREE_END_MAX = 2 * SPACE_JOINT_MAX, // end 2 j on joint j's body a, 2 j + 1 on body b
};

typedef struct SpaceNode {
    int body;           // number of a body that is free to move
    int joint;          // ideal joint it hangs on, or -1 for a floating body
    int parent;         // body at the other end of that joint, or LINKAGE_GROUND
    int parent_end;     // of the joint, on the parent
    int own_end;        // and on the body
    size_t first;       // coordinate: the angle; of a floating body x, y, z and the turn's x, y, z
    size_t chain_count; // coordinates that move it, its own last, and which
    size_t chain[SPACE_TREE_COORDINATE_MAX];
} SpaceNode;

// In the world, m, and a rotation.
typedef struct LongVec3 {
    long double x;
    long double y;
    long double z;
} LongVec3;

typedef struct LongQuat {
    long double w;
    long double x;
    long double y;
    long double z;
} LongQuat;

// Bodies by number + 1: the ground stands before the first.
enum { SPACE_TREE_BODY_MAX = SPACE_BODY_MAX + 1 };

typedef struct SpaceTree {
    const Linkage *linkage;
    int driven;                             // number of the driven body or LINKAGE_GROUND
    size_t node_count;                      // free bodies, parents before children
    SpaceNode nodes[SPACE_BODY_MAX];        //
    int node_of[SPACE_BODY_MAX];            // by body; -1 for the driven one
    bool is_carried[SPACE_BODY_MAX];        // the driven body, and all that hang on it
    bool has_floating;                      // whether a body hangs on nothing
    bool is_driven_hung_on;                 // whether others do, or loops close there
    SpaceEnd ends[SPACE_TREE_END_MAX];      // in the bodies' frames
    size_t end_counts[SPACE_TREE_BODY_MAX]; // ends each body has (by number + 1), and which
    int ends_of[SPACE_TREE_BODY_MAX][SPACE_TREE_END_MAX];
    size_t coordinate_count;
    size_t loop_count;
    int loops[SPACE_TREE_LOOP_MAX]; // joints that close loops
    // the base
    long double base_time_s;
    long double base_angle[SPACE_BODY_MAX]; // rad, of each hanging body's joint since the start
    LongQuat start_turn[SPACE_BODY_MAX];    // at the start: of a hanging body against its parent
    LongQuat base_turn[SPACE_TREE_BODY_MAX];
    LongVec3 base_position[SPACE_TREE_BODY_MAX]; // of the centres
    Mat3 base_inertia[SPACE_BODY_MAX];           // kg m^2, in the world
    Vec3 base_arms[SPACE_TREE_END_MAX];          // from the body's centre to each end, m
    Vec3 base_axes[SPACE_TREE_END_MAX];          // of the joint, unit
    Vec3 base_gaps[SPACE_JOINT_MAX];             // from the end on body a to that on body b, m
} SpaceTree;

// A body at one instant, in the world.
typedef struct SpaceBodyState {
    Mat3 turned;       // its rotation since the base, less 1
    Vec3 moved;        // of its centre since the base, m
    Vec3 velocity;     // m/s
    Vec3 omega;        // rad/s
    Vec3 bias;         // m/s^2, its acceleration with all coordinates' rates steady
    Vec3 spin_bias;    // rad/s^2, likewise
    Vec3 acceleration; // after space_tree_accelerate
    Vec3 alpha;
} SpaceBodyState;

// The velocity and angular velocity of a body by the rate of a coordinate.
typedef struct SpaceColumn {
    Vec3 linear;
    Vec3 angular;
} SpaceColumn;

// Where the tree's bodies are and how their velocities depend on the coordinates' rates. Made of
// zeros: the ground's are never written.
typedef struct SpaceTreeState {
    SpaceBodyState bodies[SPACE_TREE_BODY_MAX];
    Vec3 arms[SPACE_TREE_END_MAX]; // from the body's centre to each end, m; of the ground from 0
    SpaceColumn columns[SPACE_BODY_MAX][SPACE_TREE_COORDINATE_MAX]; // by node, along its chain
} SpaceTreeState;

// Finds the tree of the linkage's ideal joints.
void space_tree_build(const Linkage *linkage, SpaceTree *tree);

// Puts the base at given motions at time zero, and writes the coordinates' rates there.
void space_tree_start(SpaceTree *tree, const SpaceMotion *motions, double *u);

// Moves the base on to a time, coordinates and rates since the present one: zeroes the coordinates,
// and writes the rates as they count from there.
void space_tree_rebase(SpaceTree *tree, double since_s, double *q, double *u);

// Positions, velocities, columns and bias, from time and coordinates since the base and from rates.
void space_tree_evaluate(const SpaceTree *tree, double since_s, const double *q, const double *u,
                         SpaceTreeState *state);

// Fills in the accelerations from the coordinates' second rates.
void space_tree_accelerate(const SpaceTree *tree, const double *rates, SpaceTreeState *state);

// How all bodies move, for people.
void space_tree_motions(const SpaceTree *tree, const SpaceTreeState *state, SpaceMotion *motions);

// A point of the base in the frame of a body at the base: its arm from the centre there, and the
// joint's axis, both in the world with all the digits of a long double.
LongVec3 space_tree_base_arm(const SpaceTree *tree, int body, Vec3 local);
LongVec3 space_tree_base_point(const SpaceTree *tree, int body, Vec3 local);

static inline LongVec3 long_vec3(Vec3 a)
{
    return (LongVec3){a.x, a.y, a.z};
}

static inline LongVec3 long_vec3_add(LongVec3 a, LongVec3 b)
{
    return (LongVec3){a.x + b.x, a.y + b.y, a.z + b.z};
}

static inline LongVec3 long_vec3_scale(long double factor, LongVec3 a)
{
    return (LongVec3){factor * a.x, factor * a.y, factor * a.z};
}

static inline long double long_vec3_dot(LongVec3 a, LongVec3 b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

static inline Vec3 long_vec3_round(LongVec3 a)
{
    return (Vec3){(double)a.x, (double)a.y, (double)a.z};
}

static inline const SpaceBodyState *space_tree_body(const SpaceTreeState *state, int body)
{
    return &state->bodies[body + 1];
}

// A direction that a body carries, given at the base, now.
static inline Vec3 space_tree_direction(const SpaceTreeState *state, int body, Vec3 base)
{
    return vec3_add(base, mat3_apply(&space_tree_body(state, body)->turned, base));
}

// The axis of a joint on one of its ends.
static inline Vec3 space_tree_axis(const SpaceTree *tree, const SpaceTreeState *state, int end)
{
    return space_tree_direction(state, tree->ends[end].body, tree->base_axes[end]);
}

// How far a point of a body has moved since the base, by its arm there, m.
static inline Vec3 space_tree_moved(const SpaceTreeState *state, int body, Vec3 base_arm)
{
    const SpaceBodyState *at = space_tree_body(state, body);
    return vec3_add(at->moved, mat3_apply(&at->turned, base_arm));
}

// Where the end on body b of a joint is, seen from that on body a, m.
static inline Vec3 space_tree_gap(const SpaceTree *tree, const SpaceTreeState *state, int joint)
{
    const int a = 2 * joint;
    const Vec3 moved_a = space_tree_moved(state, tree->ends[a].body, tree->base_arms[a]);
    const Vec3 moved_b = space_tree_moved(state, tree->ends[a + 1].body, tree->base_arms[a + 1]);
    return vec3_add(tree->base_gaps[joint], vec3_sub(moved_b, moved_a));
}

// The velocity of a body's point on an arm, m/s, and its acceleration with the rates steady and
// after space_tree_accelerate, m/s^2.
static inline Vec3 space_tree_velocity(const SpaceTreeState *state, int body, Vec3 arm)
{
    const SpaceBodyState *at = space_tree_body(state, body);
    return vec3_add(at->velocity, vec3_cross(at->omega, arm));
}

static inline Vec3 space_tree_inwards(const SpaceBodyState *at, Vec3 arm)
{
    return vec3_cross(at->omega, vec3_cross(at->omega, arm));
}

static inline Vec3 space_tree_bias(const SpaceTreeState *state, int body, Vec3 arm)
{
    const SpaceBodyState *at = space_tree_body(state, body);
    return vec3_add(at->bias,
                    vec3_add(vec3_cross(at->spin_bias, arm), space_tree_inwards(at, arm)));
}

static inline Vec3 space_tree_acceleration(const SpaceTreeState *state, int body, Vec3 arm)
{
    const SpaceBodyState *at = space_tree_body(state, body);
    return vec3_add(at->acceleration,
                    vec3_add(vec3_cross(at->alpha, arm), space_tree_inwards(at, arm)));
}

// The inertia of a body in the world, kg m^2.
Mat3 space_tree_inertia(const SpaceTree *tree, const SpaceTreeState *state, int body);
