// The freedoms of a linkage in space as a tree: one angle for each body that hangs on an ideal
// joint, position and turn for one that floats; ideal joints that close loops have constraint rows
// (reference/space/space_articulated.h).
//
// As in the plane (reference/plane/tree.h) the ideal joints of the tree hold exactly, by
// construction, and time and coordinates are those since the base, which is kept in long double:
// how far a pin has moved in its hole since then carries all the digits of a double.
#pragma once

#include "base/layout.h"
#include "model/space_rows.h"

// A body that is free to move.
typedef struct SpaceNode {
    int body;
    int joint;       // ideal joint it hangs on, or -1 for a floating body
    int parent;      // body at the other end of that joint, or LINKAGE_GROUND
    int parent_node; // number of its node; -1: the ground or the driven body
    int parent_end;  // of the joint, on the parent
    int own_end;     // and on the body
    size_t depth;    // how many nodes it hangs on, itself among them
    size_t first;    // coordinate: the angle; of a floating body x, y, z and the turn's x, y, z
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

// Arrays by body begin with the ground where they say so: a body's number + 1. Ends by number: end
// 2 j of joint j on its body a, 2 j + 1 on body b.
typedef struct SpaceTree {
    const Linkage *linkage;
    int driven;             // number of the driven body or LINKAGE_GROUND
    void *memory;           // owned; where the arrays are, none of which holds pointers
    size_t memory_size;     // bytes
    size_t node_count;      // free bodies, parents before children
    SpaceNode *nodes;       //
    int *node_of;           // by body; -1 for the driven one
    double *reaches;        // m, by body: linkage_reach
    bool *is_carried;       // by body: the driven body, and all that hang on it
    bool has_floating;      // whether a body hangs on nothing
    bool is_driven_hung_on; // whether others do, or loops close there
    SpaceEnd *ends;         // in the bodies' frames
    size_t *end_firsts;     // by body, the ground first, and one more: where its ends begin
    int *ends_of;           // body by body
    size_t coordinate_count;
    size_t loop_count;
    int *loops; // joints that close loops
    // the base
    long double base_time_s;
    long double *base_angle;  // rad, by body: of its joint since the start, if it hangs
    LongQuat *start_turn;     // by body, at the start: of a hanging one against its parent
    LongQuat *base_turn;      // by body, the ground first
    LongVec3 *base_position;  // likewise, of the centres
    Mat3 *base_inertia;       // kg m^2, by body, in the world
    Vec3 *base_arms;          // from the body's centre to each end, m
    Vec3 *base_axes;          // of the joint, unit, by end
    double *base_coordinates; // rad, by joint: of a limited one its angle, beyond a turn too
    Vec3 *base_gaps;          // by joint, from the end on body a to that on body b, m
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

// Where the tree's bodies are and how their velocities depend on the coordinates' rates. Made of
// zeros: the ground's are never written.
typedef struct SpaceTreeState {
    SpaceBodyState *bodies; // by number + 1
    Vec3 *arms;             // from the body's centre to each end, m; not of the ground
    Vec3 (*turning)[3];     // by node, the angular velocity by the rate of its angle, the first; of
                            // a floating body by those of its turn
    int *path;              // room for the nodes that a body hangs on
} SpaceTreeState;

// Finds the tree of the linkage's ideal joints, which must outlive it
// (reference/space/space_tree.c).
void space_tree_build(const Linkage *linkage, SpaceTree *tree);
void space_tree_finish(SpaceTree *tree);

// Takes room for the arrays of a state of this tree; the memory must be zeros.
void space_tree_state_lay(const SpaceTree *tree, MemoryLayout *layout, SpaceTreeState *state);

// The node of a body; -1: the ground or the driven body.
static inline int space_tree_node_of(const SpaceTree *tree, int body)
{
    return body == LINKAGE_GROUND ? -1 : tree->node_of[body];
}

// Puts the base at given motions at time zero, and writes the coordinates' rates there.
void space_tree_start(SpaceTree *tree, const SpaceMotion *motions, double *u);

// Moves the base on to a time, coordinates and rates since the present one: zeroes the coordinates,
// and writes the rates as they count from there.
void space_tree_rebase(SpaceTree *tree, double since_s, double *q, double *u);

// Positions, velocities and bias, from time and coordinates since the base and from rates.
void space_tree_evaluate(const SpaceTree *tree, double since_s, const double *q, const double *u,
                         SpaceTreeState *state);

// The same of two bodies alone, and of those that they hang on.
void space_tree_evaluate_pair(const SpaceTree *tree, int body_a, int body_b, double since_s,
                              const double *q, const double *u, SpaceTreeState *state);

// Writes the coordinates that this depends on. Returns how many there are; 0 where it depends on
// all.
size_t space_tree_pair_coordinates(const SpaceTree *tree, int body_a, int body_b, size_t *columns);

// Fills in the accelerations from the coordinates' second rates.
void space_tree_accelerate(const SpaceTree *tree, const double *rates, SpaceTreeState *state);

// How all bodies move, for people.
void space_tree_motions(const SpaceTree *tree, const SpaceTreeState *state, SpaceMotion *motions);

// Adds to a row, a vector for each coordinate, how its rate moves a body's point on an arm from the
// centre, m, with a sign.
void space_tree_point_row(const SpaceTree *tree, const SpaceTreeState *state, int body, Vec3 arm,
                          double sign, Vec3 *row);

// Adds to a row, a number for each coordinate, how its rate turns a body about a direction.
void space_tree_turn_row(const SpaceTree *tree, const SpaceTreeState *state, int body,
                         Vec3 direction, double *row);

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
