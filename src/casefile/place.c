// How do bodies and joints that are placed in the world become a linkage that moves at time zero?
#include "casefile/place.h"

#include "base/dense.h"
#include "casefile/build.h"
#include "casefile/keys.h"
#include "model/kinematics.h"
#include "model/nearest.h"

#include <stdio.h>
#include <string.h>

enum { REASON_SIZE = 192 };

static const double INDEPENDENT = 1e-9; // of the largest pivot, as in model/kinematics.c

static Vec2 to_body(const Motion *motions, int body, Vec2 place)
{
    return body == LINKAGE_GROUND
               ? place
               : vec2_rotate(-motions[body].angle, vec2_sub(place, motions[body].position));
}

static void set_anchors(Linkage *linkage, const Motion *motions)
{
    for (size_t i = 0; i < linkage->joint_count; i++) {
        Joint *joint = &linkage->joints[i];
        const Vec2 place = joint->anchor_a;
        joint->anchor_a = to_body(motions, joint->body_a, place);
        joint->anchor_b = to_body(motions, joint->body_b, place);
    }
    Driver *driver = &linkage->driver;
    if (driver->is_present) {
        Joint *joint = &linkage->joints[driver->joint];
        // an ideal joint has no sides: the ground becomes its first
        if (joint->body_a != LINKAGE_GROUND) {
            const Joint other = *joint;
            joint->body_a = other.body_b;
            joint->anchor_a = other.anchor_b;
            joint->body_b = other.body_a;
            joint->anchor_b = other.anchor_a;
        }
        driver->start = motions[joint->body_b].angle;
    }
}

static bool check_redundancy(const Entries *entries, const Linkage *linkage, const Motion *motions,
                             Err *err)
{
    bool is_ideal[LINKAGE_JOINT_MAX];
    for (size_t i = 0; i < linkage->joint_count; i++) {
        is_ideal[i] = linkage->joints[i].kind == JOINT_REVOLUTE;
    }
    Jacobian jacobian;
    kinematics_jacobian(linkage, motions, is_ideal, true, &jacobian);
    const size_t rows = jacobian.rows;
    const size_t rank = dense_rank(rows, jacobian.columns, jacobian.entries, INDEPENDENT);
    const EntryGroup *joints = entries_group(entries, "joints", 0);
    return rank == rows ||
           entries_refuse_group(joints, err,
                                "ideal joints%s hold what others hold already: %zu of their %zu "
                                "constraints are independent at the start\nallowed: play in one of "
                                "them, one joint less, or another start",
                                linkage->driver.is_present ? " and drive" : "", rank, rows);
}

// The driven body moves as the drive says, unless the case says how it moves.
static void turn_driven_body(const Entries *entries, const Linkage *linkage, Motion *motions)
{
    const int body = linkage_driven_body(linkage);
    if (body != LINKAGE_GROUND &&
        entries_find(entries, "bodies.*.velocity", (size_t)body) == NULL &&
        entries_find(entries, "bodies.*.spin", (size_t)body) == NULL) {
        const Vec2 pivot = linkage->joints[linkage->driver.joint].anchor_a;
        const Vec2 arm = vec2_sub(motions[body].position, pivot);
        motions[body].omega = linkage->driver.speed;
        motions[body].velocity = vec2_scale(linkage->driver.speed, vec2_perp(arm));
    }
}

static bool refuse_speeds(const Entry *entry, const Linkage *linkage, int joint, double distance,
                          const Motion *nearest, Err *err)
{
    char reason[REASON_SIZE] = "the driven body does not turn as the drive does";
    const Motion *motion = &nearest[entry->index];
    if (joint >= 0) {
        snprintf(reason, sizeof reason,
                 "the speeds at the start pull the ideal joint '%s' apart by %.4g m/s",
                 linkage->joints[joint].name, distance);
    }
    return entries_refuse(entry, err,
                          "%s\nallowed: speeds that keep the joints closed, for %s next to these "
                          "velocity: [%.12g m/s, %.12g m/s], spin: %.12g rad/s",
                          reason, linkage->bodies[entry->index].name, motion->velocity.x,
                          motion->velocity.y, motion->omega);
}

// Speeds that the case gives must agree with ideal joints and drive. Where it gives none, a drive
// takes the bodies with it, as slow as the joints leave them, play or not.
static bool find_speeds(const Entries *entries, const Linkage *linkage, Motion *motions, Err *err)
{
    const Entry *given = entries_speed(entries, linkage->body_count);
    turn_driven_body(entries, linkage, motions);
    Motion nearest[LINKAGE_BODY_MAX];
    memcpy(nearest, motions, linkage->body_count * sizeof *motions);
    if (given == NULL && linkage->driver.is_present) {
        nearest_speeds(linkage, true, nearest);
    }
    nearest_speeds(linkage, false, nearest);
    nearest_speeds(linkage, false, nearest); // what rounding has left
    int joint;
    double distance;
    if (given != NULL && !nearest_check(linkage, motions, &joint, &distance)) {
        return refuse_speeds(given, linkage, joint, distance, nearest, err);
    }
    memcpy(motions, nearest, linkage->body_count * sizeof *motions);
    return true;
}

// Where the bodies cannot be moved so that every joint is as it is to start: an eccentricity that a
// joint is given is to blame, and where there is none the places themselves.
static bool refuse_places(const Entries *entries, const Linkage *linkage, Err *err)
{
    const Entry *start = NULL;
    const Entry *at = NULL;
    for (size_t i = 0; i < linkage->joint_count; i++) {
        start = start == NULL ? entries_find(entries, "joints.*.start", i) : start;
        at = at == NULL ? entries_find(entries, "joints.*.at", i) : at;
    }
    if (start == NULL && at == NULL) {
        return err_set(err, ERR_CASE, "the joints cannot all be closed");
    }
    return start != NULL
               ? entries_refuse(
                     start, err,
                     "the pins cannot all stand where they are to start\nallowed: centred")
               : entries_refuse(at, err,
                                "the joints cannot all be closed to rounding where they "
                                "are\nallowed: joints and bodies of one size");
}

bool place_linkage(const Entries *entries, Scenario *scenario, Err *err)
{
    Linkage *linkage = &scenario->linkage;
    Motion motions[LINKAGE_BODY_MAX];
    linkage_start(linkage, motions);
    set_anchors(linkage, motions);
    if (!check_redundancy(entries, linkage, motions, err)) {
        return false;
    }
    if (build_is_determined(linkage)) {
        return build_start(linkage, motions, err);
    }
    if (!nearest_places(linkage, motions)) {
        return refuse_places(entries, linkage, err);
    }
    if (!find_speeds(entries, linkage, motions, err)) {
        return false;
    }
    for (size_t i = 0; i < linkage->body_count; i++) {
        linkage->bodies[i].start = motions[i];
    }
    return true;
}
