// Draws where pins and blocks that share freedoms are in their play.
//
// Six pins between two plates have the three freedoms of the plates against each other: drawn one
// by one, they would ask for what no position of the plates gives. The positions that all joints
// allow together are, but for the curvature of the freedoms, a convex set, on which hit-and-run
// (Smith, 1984) comes to every position equally often: from a position within, along a random
// direction, to anywhere between the two ends at which something touches. A direction is what
// pushes at one pin change at once, with R the rows of its joint, l random and P the projection on
// the changes that ideal joints and drives allow:
//     P M^-1 R' l
// so that bodies which no pin holds stay where they are.
#include "run/settle_together.h"

#include "base/lcg.h"
#include "base/zeroed.h"
#include "contact/touch.h"
#include "model/joint_rows.h"
#include "model/kinematics.h"
#include "model/nearest.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
    SWEEPS = 16,       // over all pins: of two plates some hundred moves in three freedoms
    MOVES_MOST = 2000, // of one start, that a large mechanism takes no longer than its revolution
    HALVINGS = 40,     // of the way to where something touches
};

// 1: of the largest pivot, as in casefile/build.c
static const double INDEPENDENT = 1e-9;

// 1: of the play of the pin that moves farthest, beyond which it has left it on any way
static const double FARTHEST = 4.0;

// 1: of the way to the end of the play, how far a move goes: what is on the wall touches
static const double INSIDE = 0.999;

// 1: of a joint's rate in a change of unit energy, the least that moves it
static const double MOVING_LEAST = 1e-9;

bool settle_is_shared(const Linkage *linkage, const Motion *motions)
{
    size_t rows;
    return kinematics_rank(linkage, motions, NULL, true, INDEPENDENT, &rows) < rows;
}

// The least gap of all pins and blocks, over their play: below 0 one is in the metal.
static double least_gap(const Linkage *linkage, const Motion *motions)
{
    double least = 1.0;
    for (size_t i = 0; i < linkage->joint_count; i++) {
        const Joint *joint = &linkage->joints[i];
        if (!joint_is_loose(joint->kind)) {
            continue;
        }
        Touch places[TOUCH_CORNERS];
        const size_t count = touch_places(linkage, (int)i, places);
        for (size_t k = 0; k < count; k++) {
            const double gap = touch_pose(linkage, &places[k], motions).gap;
            least = fmin(least, gap / linkage_radial_clearance(joint));
        }
    }
    return least;
}

// What a push in each row of a joint changes, drawn, that ideal joints and drives allow.
static void push_joint(const Linkage *linkage, const Motion *motions, int number, uint64_t *seed,
                       SpeedChange *changes)
{
    const Joint *joint = &linkage->joints[number];
    JointRows rows;
    joint_rows_find(linkage, motions, number, &rows);
    memset(changes, 0, linkage->body_count * sizeof *changes);
    for (size_t row = 0; row < JOINT_ROWS; row++) {
        const JointRow *of = &rows.rows[row];
        double energy = 0.0; // twice that of what a push of 1 changes
        for (int side = 0; side < 2; side++) {
            const int number_of = linkage_end(joint, side).body;
            if (number_of != LINKAGE_GROUND) {
                const Body *body = &linkage->bodies[number_of];
                energy += (of->x[side] * of->x[side] + of->y[side] * of->y[side]) / body->mass +
                          of->turn[side] * of->turn[side] / body->inertia;
            }
        }
        const double push = lcg_draw(seed) / sqrt(energy);
        for (int side = 0; side < 2; side++) {
            const int number_of = linkage_end(joint, side).body;
            if (number_of != LINKAGE_GROUND) {
                const Body *body = &linkage->bodies[number_of];
                SpeedChange *change = &changes[number_of];
                change->velocity.x += push * of->x[side] / body->mass;
                change->velocity.y += push * of->y[side] / body->mass;
                change->omega += push * of->turn[side] / body->inertia;
            }
        }
    }
    nearest_change(linkage, motions, changes);
}

// How fast a change moves a pin or block in its play, in parts of it; 0 where it does not.
static double rate_in_play(const Linkage *linkage, const Motion *changed, int number)
{
    const Joint *joint = &linkage->joints[number];
    JointRows rows;
    joint_rows_find(linkage, changed, number, &rows);
    const double turning = joint_rows_is_angle(joint->kind, 1) ? 0.5 * joint->guide.length : 1.0;
    return hypot(rows.rate[0], turning * rows.rate[1]) / linkage_radial_clearance(joint);
}

// By what a change is multiplied to move the fastest pin by its play; 0 where it moves none.
static double play_over_change(const Linkage *linkage, const Motion *motions,
                               const SpeedChange *changes, Motion *changed)
{
    double fastest = 0.0;
    double energy = 0.0;
    double least_play = INFINITY;
    for (size_t i = 0; i < linkage->body_count; i++) {
        changed[i] = motions[i];
        changed[i].velocity = changes[i].velocity;
        changed[i].omega = changes[i].omega;
        const double reach = linkage_reach(linkage, (int)i);
        energy = fmax(energy, vec2_length(changes[i].velocity) + reach * fabs(changes[i].omega));
    }
    for (size_t i = 0; i < linkage->joint_count; i++) {
        if (joint_is_loose(linkage->joints[i].kind)) {
            fastest = fmax(fastest, rate_in_play(linkage, changed, (int)i));
            least_play = fmin(least_play, linkage_radial_clearance(&linkage->joints[i]));
        }
    }
    return fastest * least_play > MOVING_LEAST * energy ? 1.0 / fastest : 0.0;
}

static void move_by(const Linkage *linkage, const Motion *from, const SpeedChange *changes,
                    double factor, Motion *to)
{
    for (size_t i = 0; i < linkage->body_count; i++) {
        to[i] = from[i];
        to[i].position = vec2_add(from[i].position, vec2_scale(factor, changes[i].velocity));
        to[i].angle += factor * changes[i].omega;
    }
}

// How far a change can be gone along, from 0 towards `most`, until something touches.
static double way_to_wall(const Linkage *linkage, const Motion *motions, const SpeedChange *changes,
                          double most, Motion *moved)
{
    double free = 0.0;
    double beyond = most;
    for (int i = 0; i < HALVINGS; i++) {
        const double middle = 0.5 * (free + beyond);
        move_by(linkage, motions, changes, middle, moved);
        *(least_gap(linkage, moved) >= 0.0 ? &free : &beyond) = middle;
    }
    return free;
}

// Room for one move.
typedef struct Walk {
    SpeedChange *changes; // owned, like the others
    Motion *changed;
    Motion *moved;
} Walk;

// One move of hit-and-run from a joint; none where it would end in the metal or open a joint.
static void move_once(const Linkage *linkage, int joint, const Walk *walk, Motion *motions,
                      uint64_t *seed)
{
    push_joint(linkage, motions, joint, seed, walk->changes);
    const double share = 0.5 * (lcg_draw(seed) + 1.0); // drawn whether it moves or not
    const double unit = play_over_change(linkage, motions, walk->changes, walk->changed);
    if (unit == 0.0) {
        return;
    }
    const double forth = way_to_wall(linkage, motions, walk->changes, FARTHEST * unit, walk->moved);
    const double back = way_to_wall(linkage, motions, walk->changes, -FARTHEST * unit, walk->moved);
    const double by = INSIDE * (back + share * (forth - back));
    move_by(linkage, motions, walk->changes, by, walk->moved);
    if (nearest_ideal_positions(linkage, walk->moved) && least_gap(linkage, walk->moved) >= 0.0) {
        memcpy(motions, walk->moved, linkage->body_count * sizeof *motions);
    }
}

// Lets pins and blocks start where their bodies have them.
static void start_here(Linkage *linkage, const Motion *motions)
{
    for (size_t i = 0; i < linkage->joint_count; i++) {
        if (joint_is_loose(linkage->joints[i].kind)) {
            joint_rows_set_start(&linkage->joints[i], kinematics_opening(linkage, motions, (int)i));
        }
    }
}

void settle_place_together(Linkage *linkage, Motion *motions, uint64_t *seed)
{
    const Walk walk = {
        .changes = zeroed(linkage->body_count, sizeof *walk.changes),
        .changed = zeroed(linkage->body_count, sizeof *walk.changed),
        .moved = zeroed(linkage->body_count, sizeof *walk.moved),
    };
    size_t moves = 0;
    for (int sweep = 0; sweep < SWEEPS; sweep++) {
        for (size_t i = 0; i < linkage->joint_count && moves < MOVES_MOST; i++) {
            if (joint_is_loose(linkage->joints[i].kind)) {
                move_once(linkage, (int)i, &walk, motions, seed);
                moves++;
            }
        }
    }
    free(walk.changes);
    free(walk.changed);
    free(walk.moved);
    start_here(linkage, motions);
}

bool settle_close_together(Linkage *linkage, Motion *motions)
{
    const bool is_closed = nearest_ideal_positions(linkage, motions);
    start_here(linkage, motions);
    return is_closed;
}
