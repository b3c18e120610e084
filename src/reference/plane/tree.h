// The freedoms of a linkage as a tree: one angle for each body that hangs on a revolute joint, one
// slide for each that hangs on a prismatic joint (its angle is that of the body it hangs on),
// position and angle for one that floats, and two constraint rows for each ideal joint that closes
// a loop.
//
// Ideal joints of the tree hold exactly, by construction. The driven body and the ground are known.
// Time and coordinates are those since the base: where the linkage stood at the start of the
// present step, kept in long double. How far a pin has moved in its hole since then carries all the
// digits of a double, however long the links and whatever the angles.
#pragma once

#include "base/layout.h"
#include "base/vec2.h"
#include "contact/touch.h"

// What the distance between the ends of a pair is measured along.
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
    int parent_node;  // and its node, -1: of the ground and driven bodies, which have none
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

// A body that a drive turns.
typedef struct TreeDrive {
    const Driver *driver;
    int body;
    DrivePiece base; // how it goes on from the base, through the step
} TreeDrive;

typedef struct Tree {
    const Linkage *linkage;
    void *memory;       // owned; where all arrays are, none of which holds pointers
    size_t memory_size; // bytes
    int driven;         // number of the crank, the first driven body, or LINKAGE_GROUND
    size_t drive_count; // and all drives
    TreeDrive drives[LINKAGE_DRIVE_MAX];
    size_t node_count; // free bodies, parents before children
    TreeNode *nodes;
    int *angle_column;     // by body; -1 for a driven one and what slides on it
    int *node_of;          // by body; -1 for a driven one
    size_t pair_count;     // those of the joints first
    int *corners;          // first pair of a block's corners, a slider's stops or a slot's ends, by
                           // joint
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
    int *carried_by;        // by body: the drive whose angle it has, of a driven body and of what
                            // slides on it; or -1
    bool is_driven_hung_on; // whether a body hangs on a driven one by an ideal joint
    size_t loop_count;
    int *loops; // ideal joints that close loops
    // the base
    long double base_time_s;
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
    DriveState drives[LINKAGE_DRIVE_MAX]; // angles since the base, rad
} TreeState;

// The node of a body, or -1 of a driven one and the ground.
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

// How fast a body's speed of turning changes with all coordinates' rates steady, rad/s^2: as a
// drive's where the body turns with it.
static inline double tree_bias_alpha(const Tree *tree, const TreeState *state, int body)
{
    const int drive = body == LINKAGE_GROUND ? -1 : tree->carried_by[body];
    return drive >= 0 ? state->drives[drive].alpha : 0.0;
}

// The drive of a driven body, or -1 of all others and the ground.
static inline int tree_drive_of(const Tree *tree, int body)
{
    return body == LINKAGE_GROUND || tree->node_of[body] >= 0 ? -1 : tree->carried_by[body];
}

// Whether the drives turn at constant speeds from the base on.
static inline bool tree_is_steady(const Tree *tree)
{
    bool is_steady = true;
    for (size_t i = 0; i < tree->drive_count; i++) {
        const DrivePiece *base = &tree->drives[i].base;
        is_steady = is_steady && base->is_uniform && base->terms[1] == 0.0;
    }
    return is_steady;
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
    const double alpha = tree_bias_alpha(tree, state, body);
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

// How the arms of a body change when it turns by an angle d since the base: an arm s by
//     sin d perp s - (1 - cos d) s

typedef struct TurnedBy {
    double sine;
    double short_of_one; // 1 - cos d
} TurnedBy;

// By a series while d is small: steps are short. Up to 0.01 the first terms left out, d^9 / 9! and
// d^8 / 8!, are below 3e-21; up to 0.06, of flights, d^13 / 13! and d^12 / 12!, are below 5e-24.
static inline TurnedBy turned_by(double d)
{
    const double small = 0.01;
    const double moderate = 0.06;
    const double e = d * d;
    double sine = 1.0 - e * (1.0 / 42.0);
    double cosine = 1.0 - e * (1.0 / 30.0);
    if (!(fabs(d) <= small)) {
        if (!(fabs(d) <= moderate)) {
            return (TurnedBy){sin(d), 2.0 * sin(0.5 * d) * sin(0.5 * d)};
        }
        sine = 1.0 - e * (1.0 / 42.0) * (1.0 - e * (1.0 / 72.0) * (1.0 - e * (1.0 / 110.0)));
        cosine = 1.0 - e * (1.0 / 30.0) * (1.0 - e * (1.0 / 56.0) * (1.0 - e * (1.0 / 90.0)));
    }
    return (TurnedBy){
        .sine = d * (1.0 - e * (1.0 / 6.0) * (1.0 - e * (1.0 / 20.0) * sine)),
        .short_of_one = 0.5 * e * (1.0 - e * (1.0 / 12.0) * cosine),
    };
}

// The change of an arm.
static inline Vec2 turned_arm(const TurnedBy *by, Vec2 arm)
{
    const double s = by->sine;
    const double r = by->short_of_one;
    return (Vec2){-s * arm.y - r * arm.x, s * arm.x - r * arm.y};
}

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

// By how much the distance from a line has changed since the base, m.
double tree_line_moved(const Tree *tree, const TreeState *state, int pair);

// The rate of the distance from a line, m/s, and its second rate, m/s^2, after tree_accelerate; or
// that without accelerations of the coordinates.
double tree_line_rate(const Tree *tree, const TreeState *state, int pair);
double tree_line_second(const Tree *tree, const TreeState *state, int pair);
double tree_line_bias(const Tree *tree, const TreeState *state, int pair);

// The angle of body b of a prismatic joint or a block against the one that is not tilted, rad.
double tree_tilt(const Tree *tree, const TreeState *state, int joint);

// The functions of the tree: it is built, moved and evaluated.

// The pairs of a joint beside the one of its anchors: those of corners and of a slider's stops,
// which are its sites, and those of the ends of a slot, from the centre of an arc to that of the
// pin. Returns how many, with what they are between.
size_t tree_own_pairs(const Linkage *linkage, int number, Touch sites[TOUCH_CORNERS]);

// Finds the tree of the linkage's ideal joints, which must outlive it (reference/plane/tree.c).
void tree_build(const Linkage *linkage, Tree *tree);
void tree_finish(Tree *tree);

// Takes room for the arrays of a state of this tree; the memory must be zeros.
void tree_state_lay(const Tree *tree, MemoryLayout *layout, TreeState *state);

// Puts the base at given motions at time zero, and writes the coordinates' rates there.
void tree_start(Tree *tree, const Motion *motions, double *u);

// Moves the base on to a time and coordinates since the present one, and zeroes the coordinates.
void tree_rebase(Tree *tree, double since_s, double *q);

// The time from which on the pieces of what is given over time hold in the present step, s: that of
// the base, but a bend nearer to it than rounding has been reached.
double tree_from(const Tree *tree);

// The time, s, that lies so long after the base.
double tree_time(const Tree *tree, double since_s);

// Positions, velocities and bias, from time and coordinates since the base and from rates.
void tree_evaluate(const Tree *tree, double since_s, const double *q, const double *u,
                   TreeState *state);

// The same of the two bodies of a pair alone, and of those that they hang on.
void tree_evaluate_pair(const Tree *tree, int pair, double since_s, const double *q,
                        const double *u, TreeState *state);

// Writes the coordinates that this depends on. Returns how many there are; 0 where it depends on
// all.
size_t tree_pair_coordinates(const Tree *tree, int pair, size_t *columns);

// Fills in the accelerations from the coordinates' second rates.
void tree_accelerate(const Tree *tree, const double *rates, TreeState *state);

// Adds to a row, a vector for each coordinate, how its rate moves a body's point on an arm from the
// centre, m, with a sign.
void tree_point_row(const Tree *tree, const TreeState *state, int body, Vec2 arm, double sign,
                    Vec2 *row);

// The limited coordinate of a joint that turns or meshes (model/coordinate.h) in a tree, counted
// from an origin in its play: the angle that the joint's bodies were placed with, the middle of a
// gap between teeth. Of teeth the way of the pair's ends is part of it beside what the bodies turn:
// of a rack along the pitch line, of gears round each other. What it has changed since the base has
// all the digits of a double, and that at the base comes from long double, however many turns the
// bodies have made.

// The parts that bodies' turns have in a coordinate, rad or m per rad: of body a and body b.
enum { TREE_COORDINATE_PARTS = 2 };

typedef struct TreeCoordinatePart {
    int body; // LINKAGE_GROUND where there is none
    double share;
} TreeCoordinatePart;

void tree_coordinate_parts(const Joint *joint, TreeCoordinatePart parts[TREE_COORDINATE_PARTS]);

// What it counts from, rad or m.
double tree_coordinate_origin(const Joint *joint);

// Fills in that at the base, with the gap between the joint's ends and the normal of its line
// there.
void tree_coordinate_settle(Tree *tree, int joint, TreePoint gap, TreePoint normal);

double tree_coordinate(const Tree *tree, const TreeState *state, int joint);
double tree_coordinate_rate(const Tree *tree, const TreeState *state, int joint);

// After tree_accelerate.
double tree_coordinate_second(const Tree *tree, const TreeState *state, int joint);

// The sums of the sizes of what the coordinate and its rate are made of, for their rounding.
void tree_coordinate_sizes(const Tree *tree, const TreeState *state, int joint, double *position,
                           double *speed);
