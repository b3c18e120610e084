// Draws starts of a mechanism from what its play allows.
//
// A start has a point of the unit cube: coordinates for where each pin, block, tooth and stop is,
// and one for the speed. The points are those of the additive recurrence
//     u_k = 1/2 + k (1/g, 1/g^2, ... 1/g^d)  modulo 1,     g the root above 1 of g^(d+1) = g + 1
// (Roberts, 2018; of d = 1 the golden ratio), which fill the cube evenly however many there are, so
// that with one freedom no two starts are alike.
//
// Pins and blocks are put where they are to be in their play, and the bodies move as little as that
// needs; those that share freedoms are put together (run/settle_together.h). Limited coordinates
// and stops follow one by one, each along the direction of least kinetic energy that ideal joints
// and drive leave. Speeds are those of the mechanism without relative motion in pins, and a
// multiple of a random change that ideal joints and drive allow. The multiple takes the fastest
// joint to its share of its largest speed,
//     v = max(closing speed at which contacts began, 2 play / period)
#include "run/settle_draw.h"

#include "base/lcg.h"
#include "base/zeroed.h"
#include "contact/touch.h"
#include "model/nearest.h"
#include "run/settle.h"
#include "run/settle_together.h"

#include <math.h>
#include <stdlib.h>

enum {
    ATTEMPTS = 24,    // until a start has no overlap
    NEWTON_STEPS = 8, // to put a coordinate where it is to be
    ROOT_STEPS = 64,  // of the fixed-point iteration for g, which gains a digit in three
};

// 1: of the play, how far pins and blocks go: what is on the wall touches
static const double INSIDE = 0.999;

// 1: of the gap, how near a coordinate is put to where it is drawn
static const double PLACED = 1e-6;

// 1: of the gap, overlaps that are rounding
static const double OVERLAP = 1e-9;

// 1: of the reach of a body, a change of its place that tells how a gap changes
static const double NUDGE = 1e-7;

// 1: of what two bodies could do alone, how much of a gap's rate joints and drive have to leave for
// it to be free
static const double FREE_LEAST = 1e-6;

// Of the drive's speed at the bodies' reach, in space, by which starts differ there.
static const double SPACE_SIZES[] = {0.05, 0.2, 0.01, 0.5};
enum { SPACE_SIZE_COUNT = sizeof SPACE_SIZES / sizeof *SPACE_SIZES };

// A start under way.
typedef struct Draw {
    Linkage *linkage; // of the scenario
    const SettleReach *reach;
    double period_s;
    Motion *motions; // owned
    bool is_shared;  // whether pins and blocks share freedoms
    double shrink;   // 1/g
    double share;    // of the last coordinate drawn: a power of it
    size_t point;    // k above
    uint64_t seed;   // of directions
} Draw;

// 1/g of so many dimensions.
static double recurrence_share(size_t dimensions)
{
    double g = 1.5;
    for (int i = 0; i < ROOT_STEPS; i++) {
        g = pow(1.0 + g, 1.0 / (double)(dimensions + 1));
    }
    return 1.0 / g;
}

// The next coordinate of the point, in [0, 1).
static double next_coordinate(Draw *draw)
{
    draw->share *= draw->shrink;
    const double at = 0.5 + (double)draw->point * draw->share;
    return at - floor(at);
}

// How many coordinates a joint takes.
static size_t joint_coordinates(const Joint *joint)
{
    const bool is_placed = joint_is_loose(joint->kind);
    return is_placed ? 2 : linkage_has_play(joint) ? 1 : 0;
}

static size_t coordinate_count(const Linkage *linkage)
{
    size_t count = 1;
    for (size_t i = 0; i < linkage->joint_count; i++) {
        count += joint_coordinates(&linkage->joints[i]);
    }
    return count;
}

// Where pins and blocks are in their play: evenly over its area.
static void place_in_play(Draw *draw, Joint *joint)
{
    const double first = next_coordinate(draw);
    const double second = next_coordinate(draw);
    const double play = INSIDE * linkage_radial_clearance(joint);
    if (joint_has_hole(joint->kind)) {
        const double distance = play * sqrt(first);
        const double angle = 2.0 * M_PI * second;
        joint->clearance.start = (Vec2){distance * cos(angle), distance * sin(angle)};
        return;
    }
    const double offset = (2.0 * first - 1.0) * play;
    double tilt = (2.0 * second - 1.0) * INSIDE * linkage_guide_tilt(&joint->guide);
    while (linkage_guide_gap(&joint->guide, offset, tilt) < 0.0) {
        tilt *= 0.5;
    }
    joint->guide.start = (Vec2){offset, tilt};
}

static double gap_at(const Draw *draw, int joint)
{
    Touch places[TOUCH_CORNERS];
    touch_places(draw->linkage, joint, places);
    return touch_pose(draw->linkage, &places[0], draw->motions).gap;
}

// How wide the gap of a limited coordinate or a stop is, m or rad: as far as the motion went where
// it has no end.
static double gap_width(const Draw *draw, int number)
{
    const Joint *joint = &draw->linkage->joints[number];
    if (!joint_has_disc(joint->kind)) {
        const double width = coordinate_high(joint) - coordinate_low(joint);
        if (isfinite(width)) {
            return width;
        }
    }
    return draw->reach[number].gap;
}

static double *place_of(Motion *motion, int coordinate)
{
    return coordinate == 0   ? &motion->position.x
           : coordinate == 1 ? &motion->position.y
                             : &motion->angle;
}

// The steepest change of a joint's gap in the norm of kinetic energy that ideal joints and drive
// allow, each body's as speeds; returns the rate of the gap in it, and what it would be of the
// bodies alone.
static double steepest_change(Draw *draw, int joint, SpeedChange *changes, double *alone)
{
    const Linkage *linkage = draw->linkage;
    const double before = gap_at(draw, joint);
    *alone = 0.0;
    for (size_t i = 0; i < linkage->body_count; i++) {
        changes[i] = (SpeedChange){.omega = 0.0};
        const Body *body = &linkage->bodies[i];
        const double reach = linkage_reach(linkage, (int)i);
        double slopes[3];
        for (int k = 0; k < 3; k++) {
            double *place = place_of(&draw->motions[i], k);
            const double stood = *place;
            const double by = k < 2 ? NUDGE * reach : NUDGE;
            *place += by;
            slopes[k] = (gap_at(draw, joint) - before) / by;
            *place = stood;
        }
        changes[i].velocity = (Vec2){slopes[0] / body->mass, slopes[1] / body->mass};
        changes[i].omega = slopes[2] / body->inertia;
        *alone += slopes[0] * changes[i].velocity.x + slopes[1] * changes[i].velocity.y +
                  slopes[2] * changes[i].omega;
    }
    nearest_change(linkage, draw->motions, changes);
    // the nearest change is the projection, whose rate is the square of its own norm
    double rate = 0.0;
    for (size_t i = 0; i < linkage->body_count; i++) {
        const Body *body = &linkage->bodies[i];
        rate += body->mass * vec2_dot(changes[i].velocity, changes[i].velocity) +
                body->inertia * changes[i].omega * changes[i].omega;
    }
    return rate;
}

static void move_along(Draw *draw, const SpeedChange *changes, double factor)
{
    for (size_t i = 0; i < draw->linkage->body_count; i++) {
        Motion *motion = &draw->motions[i];
        motion->position = vec2_add(motion->position, vec2_scale(factor, changes[i].velocity));
        motion->angle += factor * changes[i].omega;
    }
}

// Closes the joints, pins and blocks at their starts; where these share freedoms, their starts
// where they are.
static bool close_joints(Draw *draw)
{
    return draw->is_shared ? settle_close_together(draw->linkage, draw->motions)
                           : nearest_positions(draw->linkage, draw->motions);
}

// Moves the bodies until the gap of a joint is what is drawn, if it is free to be that. False where
// they cannot be put together then.
static bool place_gap(Draw *draw, int joint)
{
    const double width = gap_width(draw, joint);
    const double wanted = next_coordinate(draw) * width;
    SpeedChange *changes = zeroed(draw->linkage->body_count, sizeof *changes);
    bool is_placed = true;
    for (int i = 0; i < NEWTON_STEPS && is_placed; i++) {
        const double missing = wanted - gap_at(draw, joint);
        double alone;
        if (!(fabs(missing) > PLACED * width)) {
            break;
        }
        const double rate = steepest_change(draw, joint, changes, &alone);
        if (!(rate > FREE_LEAST * alone)) {
            break;
        }
        move_along(draw, changes, missing / rate);
        is_placed = close_joints(draw);
    }
    free(changes);
    return is_placed;
}

// Puts all bodies where the draw has them.
static bool place_bodies(Draw *draw)
{
    Linkage *linkage = draw->linkage;
    if (draw->is_shared) {
        settle_place_together(linkage, draw->motions, &draw->seed);
    }
    for (size_t i = 0; i < linkage->joint_count && !draw->is_shared; i++) {
        if (joint_coordinates(&linkage->joints[i]) == 2) {
            place_in_play(draw, &linkage->joints[i]);
        }
    }
    bool is_placed = close_joints(draw);
    for (size_t i = 0; is_placed && i < linkage->joint_count; i++) {
        if (joint_coordinates(&linkage->joints[i]) == 1) {
            is_placed = place_gap(draw, (int)i);
        }
    }
    return is_placed;
}

// Whether nothing overlaps.
static bool is_clear(const Draw *draw)
{
    const Linkage *linkage = draw->linkage;
    for (size_t i = 0; i < linkage->joint_count; i++) {
        const Joint *joint = &linkage->joints[i];
        const double width = joint_coordinates(joint) == 2 ? linkage_radial_clearance(joint)
                                                           : gap_width(draw, (int)i);
        Touch places[TOUCH_CORNERS];
        const size_t count = touch_places(linkage, (int)i, places);
        for (size_t k = 0; k < count; k++) {
            const double gap = touch_pose(linkage, &places[k], draw->motions).gap;
            if (!(gap >= -OVERLAP * fmax(width, fabs(places[k].clearance)))) {
                return false;
            }
        }
    }
    return true;
}

// How fast the bodies of a joint with play move against each other in changes of their speeds, m/s
// or rad/s.
static double relative_rate(const Linkage *linkage, const Motion *changed, int number)
{
    const Joint *joint = &linkage->joints[number];
    if (joint->limits.kind != LIMIT_NONE) {
        return fabs(coordinate_rate(linkage, changed, number));
    }
    const double moving = vec2_length(linkage_joint_gap(linkage, changed, number).velocity);
    if (!joint_has_guides(joint->kind)) {
        return moving;
    }
    const double omega_a = joint->body_a == LINKAGE_GROUND ? 0.0 : changed[joint->body_a].omega;
    const double omega_b = joint->body_b == LINKAGE_GROUND ? 0.0 : changed[joint->body_b].omega;
    return moving + 0.5 * joint->guide.length * fabs(omega_b - omega_a);
}

// The fastest relative motion that a start gives a joint.
static double rate_most(const Draw *draw, int joint)
{
    const Joint *of = &draw->linkage->joints[joint];
    const double play =
        joint_coordinates(of) == 2 ? 2.0 * linkage_radial_clearance(of) : gap_width(draw, joint);
    return fmax(draw->reach[joint].approach, 2.0 * play / draw->period_s);
}

// A random change that ideal joints and drive allow, with a sign that does not depend on chance.
// False where they allow none.
static bool random_change(Draw *draw, SpeedChange *changes)
{
    const Linkage *linkage = draw->linkage;
    double largest = 0.0;
    for (size_t i = 0; i < linkage->body_count; i++) {
        const double reach = linkage_reach(linkage, (int)i);
        changes[i] = (SpeedChange){.velocity = {lcg_draw(&draw->seed), lcg_draw(&draw->seed)},
                                   .omega = lcg_draw(&draw->seed) / reach};
    }
    nearest_change(linkage, draw->motions, changes);
    double first = 0.0;
    for (size_t i = 0; i < linkage->body_count; i++) {
        const double reach = linkage_reach(linkage, (int)i);
        const double rates[] = {changes[i].velocity.x, changes[i].velocity.y,
                                changes[i].omega * reach};
        for (int k = 0; k < 3; k++) {
            largest = fmax(largest, fabs(rates[k]));
            first = first == 0.0 && fabs(rates[k]) > FREE_LEAST ? rates[k] : first;
        }
    }
    for (size_t i = 0; first < 0.0 && i < linkage->body_count; i++) {
        changes[i].velocity = vec2_scale(-1.0, changes[i].velocity);
        changes[i].omega = -changes[i].omega;
    }
    return largest > FREE_LEAST;
}

// By what a change is multiplied to take the fastest joint to its largest speed; 0 where it moves
// none.
static double largest_multiple(const Draw *draw, const SpeedChange *changes)
{
    const Linkage *linkage = draw->linkage;
    Motion *changed = zeroed(linkage->body_count, sizeof *changed);
    double multiple = INFINITY;
    for (size_t i = 0; i < linkage->body_count; i++) {
        changed[i] = draw->motions[i];
        changed[i].velocity = changes[i].velocity;
        changed[i].omega = changes[i].omega;
    }
    for (size_t i = 0; i < linkage->joint_count; i++) {
        if (linkage_has_play(&linkage->joints[i])) {
            const double rate = relative_rate(linkage, changed, (int)i);
            const double most = rate_most(draw, (int)i);
            multiple = rate * multiple > most ? most / rate : multiple;
        }
    }
    free(changed);
    return isfinite(multiple) ? multiple : 0.0;
}

// Gives the bodies their speeds.
static void draw_speeds(Draw *draw)
{
    Linkage *linkage = draw->linkage;
    nearest_speeds(linkage, true, draw->motions);
    if (draw->is_shared) {
        nearest_speeds(linkage, false, draw->motions); // where pins cannot all stand still
    }
    SpeedChange *changes = zeroed(linkage->body_count, sizeof *changes);
    const double share = 2.0 * next_coordinate(draw) - 1.0;
    if (random_change(draw, changes)) {
        const double factor = share * largest_multiple(draw, changes);
        for (size_t i = 0; i < linkage->body_count; i++) {
            Motion *motion = &draw->motions[i];
            motion->velocity = vec2_add(motion->velocity, vec2_scale(factor, changes[i].velocity));
            motion->omega += factor * changes[i].omega;
        }
    }
    free(changes);
}

// One attempt.
static bool draw_once(Scenario *scenario, const SettleReach *reach, size_t point)
{
    Linkage drawn = linkage_copy(&scenario->linkage);
    Draw draw = {
        .linkage = &drawn,
        .reach = reach,
        .period_s = scenario_settling_period(scenario),
        .motions = zeroed(drawn.body_count, sizeof *draw.motions),
        .shrink = recurrence_share(coordinate_count(&drawn)),
        .share = 1.0,
        .point = point,
        .seed = lcg_stirred((unsigned)point),
    };
    linkage_start(&drawn, draw.motions);
    draw.is_shared = settle_is_shared(&drawn, draw.motions);
    const bool is_drawn = place_bodies(&draw) && is_clear(&draw);
    if (is_drawn) {
        draw_speeds(&draw);
        for (size_t i = 0; i < drawn.body_count; i++) {
            drawn.bodies[i].start = draw.motions[i];
        }
        linkage_free(&scenario->linkage);
        scenario->linkage = drawn;
    } else {
        linkage_free(&drawn);
    }
    free(draw.motions);
    return is_drawn;
}

bool settle_draw(Scenario *scenario, const SettleReach *reach, size_t number, size_t count)
{
    if (scenario->linkage.is_spatial) {
        return settle_change_start(scenario, SPACE_SIZES[number % SPACE_SIZE_COUNT],
                                   (unsigned)number + 1);
    }
    bool is_drawn = false;
    for (size_t attempt = 0; !is_drawn && attempt < ATTEMPTS; attempt++) {
        is_drawn = draw_once(scenario, reach, number + 1 + attempt * count);
    }
    return is_drawn;
}
