// How does a four-bar become bodies, joints and a driver, and how do they move at time zero?
//
// Frames: origin at mid-link, which is the centre of mass; x along the link from its first joint
// to its second. Crank: ground pivot to crank pin. Coupler: crank pin to follower pin. Follower:
// ground pivot to follower pin, so that its angle is the usual follower angle.
#include "casefile/build.h"

#include "model/kinematics.h"

#include <math.h>
#include <string.h>

enum {
    BODY_COUNT = 3,
    // a pin off its hole's centre turns the links by some 1e-4 rad, so that each pass leaves
    // about 1e-4 of the error before: four reach the last bit
    PASS_COUNT = 4,
};

typedef enum BodyNumber { CRANK, COUPLER, FOLLOWER } BodyNumber;

static double link_length(const FourBar *fourbar, int body)
{
    const ToleratedLength *lengths[] = {&fourbar->crank, &fourbar->coupler, &fourbar->follower};
    return lengths[body]->nominal;
}

static void place_joint(Joint *joint, int body_a, Vec2 anchor_a, int body_b, Vec2 anchor_b)
{
    joint->body_a = body_a;
    joint->anchor_a = anchor_a;
    joint->body_b = body_b;
    joint->anchor_b = anchor_b;
}

static void place_joints(const FourBar *fourbar, Linkage *linkage)
{
    const Vec2 ground = {fourbar->ground.nominal, 0.0};
    Vec2 first[BODY_COUNT];
    Vec2 second[BODY_COUNT];
    for (int i = 0; i < BODY_COUNT; i++) {
        first[i] = (Vec2){-0.5 * link_length(fourbar, i), 0.0};
        second[i] = (Vec2){0.5 * link_length(fourbar, i), 0.0};
    }
    Joint *joints = linkage->joints;
    place_joint(&joints[0], LINKAGE_GROUND, (Vec2){0.0, 0.0}, CRANK, first[CRANK]);
    place_joint(&joints[1], CRANK, second[CRANK], COUPLER, first[COUPLER]);
    place_joint(&joints[2], COUPLER, second[COUPLER], FOLLOWER, second[FOLLOWER]);
    place_joint(&joints[3], FOLLOWER, first[FOLLOWER], LINKAGE_GROUND, ground);
    linkage->driver.joint = 0;
}

static Motion link_between(Vec2 first, Vec2 second)
{
    const Vec2 along = vec2_sub(second, first);
    return (Motion){
        .position = vec2_scale(0.5, vec2_add(first, second)),
        .angle = atan2(along.y, along.x),
    };
}

// The circles about crank pin and follower pivot meet in two points; the assembly picks one.
static void guess_positions(const FourBar *fourbar, double crank_angle, Motion *motions)
{
    const Vec2 origin = {0.0, 0.0};
    const Vec2 pivot = {fourbar->ground.nominal, 0.0};
    const Vec2 crank_pin = vec2_rotate(crank_angle, (Vec2){fourbar->crank.nominal, 0.0});
    const Vec2 diagonal = vec2_sub(pivot, crank_pin);
    const double d = vec2_length(diagonal);
    const double b = fourbar->coupler.nominal;
    const double c = fourbar->follower.nominal;
    const double along = (d * d + b * b - c * c) / (2.0 * d);
    const double height = sqrt(fmax(0.0, b * b - along * along));
    const double side = fourbar->assembly == ASSEMBLY_OPEN ? height : -height;
    const Vec2 direction = vec2_scale(1.0 / d, diagonal);
    const Vec2 follower_pin = vec2_add(
        crank_pin, vec2_add(vec2_scale(along, direction), vec2_scale(side, vec2_perp(direction))));
    motions[CRANK] = link_between(origin, crank_pin);
    motions[CRANK].angle = crank_angle;
    motions[COUPLER] = link_between(crank_pin, follower_pin);
    motions[FOLLOWER] = link_between(pivot, follower_pin);
}

// A linkage with ideal joints whose hole anchors stand where the pins start.
static Linkage shift_holes(const Linkage *linkage, const Motion *motions)
{
    Linkage shifted = *linkage;
    for (size_t i = 0; i < shifted.joint_count; i++) {
        Joint *joint = &shifted.joints[i];
        if (joint->kind != JOINT_CLEARANCE) {
            continue;
        }
        const double angle = joint->body_a == LINKAGE_GROUND ? 0.0 : motions[joint->body_a].angle;
        joint->anchor_a = vec2_add(joint->anchor_a, vec2_rotate(-angle, joint->clearance.start));
        joint->kind = JOINT_REVOLUTE;
    }
    return shifted;
}

bool build_is_determined(const Linkage *linkage)
{
    return linkage->driver.is_present && 2 * linkage->joint_count + 1 == 3 * linkage->body_count;
}

bool build_start(Linkage *linkage, Motion *motions, Err *err)
{
    const double start = linkage->driver.start;
    if (!kinematics_solve(linkage, start, motions, err)) {
        return false;
    }
    for (int i = 0; i < PASS_COUNT; i++) {
        const Linkage shifted = shift_holes(linkage, motions);
        if (!kinematics_solve(&shifted, start, motions, err)) {
            return false;
        }
    }
    for (size_t i = 0; i < linkage->body_count; i++) {
        linkage->bodies[i].start = motions[i];
    }
    return true;
}

bool build_fourbar(Scenario *scenario, Err *err)
{
    place_joints(&scenario->fourbar, &scenario->linkage);
    scenario->has_fourbar = true;
    for (size_t i = 0; i < scenario->point_count; i++) {
        TracedPoint *point = &scenario->points[i];
        point->local.x -= 0.5 * link_length(&scenario->fourbar, point->body);
    }
    Motion motions[LINKAGE_BODY_MAX] = {0};
    guess_positions(&scenario->fourbar, scenario->linkage.driver.start, motions);
    return build_start(&scenario->linkage, motions, err);
}
