// How do a four-bar, or bodies and joints placed in the world, become a linkage that moves at time
// zero?
//
// Frames of a four-bar: origin at mid-link, which is the centre of mass; x along the link from its
// first joint to its second. Crank: ground pivot to crank pin. Coupler: crank pin to follower pin.
// Follower: ground pivot to follower pin, so that its angle is the usual follower angle.
#include "casefile/build.h"

#include "base/zeroed.h"
#include "casefile/bushings.h"
#include "casefile/drives.h"
#include "casefile/keys.h"
#include "casefile/limits.h"
#include "casefile/speeds.h"
#include "casefile/teeth.h"
#include "model/forces.h"
#include "model/joint_rows.h"
#include "model/kinematics.h"
#include "model/nearest.h"
#include "model/space_nearest.h"

#include <math.h>
#include <stdio.h>
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

void build_place_joint(Joint *joint, int body_a, Vec2 anchor_a, int body_b, Vec2 anchor_b)
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
    build_place_joint(&joints[0], LINKAGE_GROUND, (Vec2){0.0, 0.0}, CRANK, first[CRANK]);
    build_place_joint(&joints[1], CRANK, second[CRANK], COUPLER, first[COUPLER]);
    build_place_joint(&joints[2], COUPLER, second[COUPLER], FOLLOWER, second[FOLLOWER]);
    build_place_joint(&joints[3], FOLLOWER, first[FOLLOWER], LINKAGE_GROUND, ground);
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

// A linkage with ideal joints whose hole anchors stand where the pins start; for linkage_free.
static Linkage shift_holes(const Linkage *linkage, const Motion *motions)
{
    Linkage shifted = linkage_copy(linkage);
    for (size_t i = 0; i < shifted.joint_count; i++) {
        Joint *joint = &shifted.joints[i];
        if (joint_has_guides(joint->kind)) {
            // the ideal joint whose line goes through the block's middle and is tilted as the block
            const Vec2 across = vec2_perp(vec2_rotate(joint->direction, (Vec2){1.0, 0.0}));
            joint->anchor_a = vec2_add(joint->anchor_a, vec2_scale(joint->guide.start.x, across));
            joint->held_angle += joint->guide.start.y;
        }
        if (joint_has_hole(joint->kind)) {
            const double angle =
                joint->body_a == LINKAGE_GROUND ? 0.0 : motions[joint->body_a].angle;
            joint->anchor_a =
                vec2_add(joint->anchor_a, vec2_rotate(-angle, joint->clearance.start));
        }
        joint->kind = joint_without_play(joint->kind);
    }
    return shifted;
}

bool build_is_determined(const Linkage *linkage)
{
    return kinematics_is_determined(linkage);
}

bool build_start(Linkage *linkage, Motion *motions, Err *err)
{
    DriveState start[LINKAGE_DRIVE_MAX];
    linkage_drives_since(linkage, 0.0, 0.0, start);
    if (!kinematics_solve_driven(linkage, start, motions, err)) {
        return false;
    }
    for (int i = 0; i < PASS_COUNT; i++) {
        Linkage shifted = shift_holes(linkage, motions);
        const bool is_solved = kinematics_solve_driven(&shifted, start, motions, err);
        linkage_free(&shifted);
        if (!is_solved) {
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
    Motion motions[BODY_COUNT] = {0};
    guess_positions(&scenario->fourbar, scenario->linkage.driver.start, motions);
    return build_start(&scenario->linkage, motions, err);
}

static const double INDEPENDENT = 1e-9; // of the largest pivot, as in model/kinematics.c

static Vec2 to_body(const Motion *motions, int body, Vec2 point)
{
    return body == LINKAGE_GROUND
               ? point
               : vec2_rotate(-motions[body].angle, vec2_sub(point, motions[body].position));
}

static double angle_of(const Motion *motions, int body)
{
    return body == LINKAGE_GROUND ? 0.0 : motions[body].angle;
}

// The ends of springs and bushings, and where forces act on bodies; a force whose place the case
// does not give acts at the centre of mass.
static void set_force_anchors(const Entries *entries, Linkage *linkage, const Motion *motions)
{
    for (size_t i = 0; i < linkage->spring_count; i++) {
        Spring *spring = &linkage->springs[i];
        spring->anchor_a = to_body(motions, spring->body_a, spring->anchor_a);
        spring->anchor_b = to_body(motions, spring->body_b, spring->anchor_b);
    }
    bushings_place(linkage, motions);
    for (size_t i = 0; i < linkage->load_count; i++) {
        Load *load = &linkage->loads[i];
        const Entry *at = entries_find(entries, "loads.*.at", i);
        const bool is_placed = at != NULL && at->node->kind == NODE_LIST;
        load->anchor = is_placed ? to_body(motions, load->body, load->anchor) : (Vec2){0.0, 0.0};
    }
}

// A drive starts where its body is. An ideal joint has no sides: the ground becomes its first.
static void start_drive(Linkage *linkage, const Motion *motions, Driver *driver)
{
    Joint *joint = &linkage->joints[driver->joint];
    if (joint->body_a != LINKAGE_GROUND) {
        const Joint other = *joint;
        joint->body_a = other.body_b;
        joint->anchor_a = other.anchor_b;
        joint->body_b = other.body_a;
        joint->anchor_b = other.anchor_a;
    }
    driver->start = motions[joint->body_b].angle;
}

static void set_anchors(const Entries *entries, Linkage *linkage, const Motion *motions)
{
    for (size_t i = 0; i < linkage->joint_count; i++) {
        Joint *joint = &linkage->joints[i];
        const Vec2 point = joint->anchor_a;
        if (joint_has_teeth(joint->kind)) {
            continue; // its anchors are those of the joints that guide it
        }
        const Vec2 other = joint->is_apart ? joint->anchor_b : point;
        joint->anchor_a = to_body(motions, joint->body_a, point);
        joint->anchor_b = to_body(motions, joint->body_b, other);
        joint->direction -= angle_of(motions, joint->body_a);
        joint->stop.facing -= angle_of(motions, joint->body_b);
        joint->held_angle = angle_of(motions, joint->body_b) - angle_of(motions, joint->body_a);
    }
    set_force_anchors(entries, linkage, motions);
    for (size_t i = 0; i < linkage_drive_count(linkage); i++) {
        start_drive(linkage, motions, i == 0 ? &linkage->driver : &linkage->further[i - 1]);
    }
    teeth_place(linkage, motions);
}

// The first of the further drives that prescribes what others do already; their number where there
// is none.
static size_t excess_drive(const Linkage *linkage, const Motion *motions, const bool *is_ideal)
{
    const size_t count = linkage_drive_count(linkage);
    size_t before = 0;
    size_t excess = count;
    for (size_t used = 1; count > 1 && excess == count && used <= count; used++) {
        Linkage some = *linkage;
        some.further_count = used - 1;
        size_t rows;
        const size_t rank = kinematics_rank(&some, motions, is_ideal, true, INDEPENDENT, &rows);
        excess = used > 1 && rank == before ? used - 1 : excess;
        before = rank;
    }
    return excess;
}

static bool check_redundancy(const Entries *entries, const Linkage *linkage, const Motion *motions,
                             Err *err)
{
    bool *is_ideal = zeroed(linkage->joint_count, sizeof *is_ideal);
    for (size_t i = 0; i < linkage->joint_count; i++) {
        is_ideal[i] = joint_is_ideal(linkage->joints[i].kind);
    }
    size_t rows;
    const size_t rank = kinematics_rank(linkage, motions, is_ideal, true, INDEPENDENT, &rows);
    const size_t drives = linkage_drive_count(linkage);
    const size_t excess = rank < rows ? excess_drive(linkage, motions, is_ideal) : drives;
    free(is_ideal);
    const EntryGroup *joints = entries_group(entries, "joints", 0);
    if (excess < drives) {
        return drives_refuse_redundant(entries, linkage, excess, err);
    }
    return rank == rows ||
           entries_refuse_group(joints, err,
                                "ideal joints%s are redundant: only %zu of their %zu "
                                "constraints are independent at the start\nallowed: play in one of "
                                "them, one joint less, or another start",
                                linkage->driver.is_present ? " and drive" : "", rank, rows);
}

// Where the bodies cannot be moved so that every joint is as it is to start: an eccentricity that a
// joint is given is to blame, and where there is none the positions themselves.
static bool refuse_positions(const Entries *entries, const Linkage *linkage, Err *err)
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
    return start != NULL ? entries_refuse(start, err,
                                          "the pins cannot all have these starts\nallowed: centred")
                         : entries_refuse(at, err,
                                          "the joints cannot all be closed to rounding where they "
                                          "are\nallowed: joints and bodies of one size");
}

// Springs and bushings of which the case does not say where they are relaxed are so at time zero.
static void relax_springs(const Entries *entries, Linkage *linkage)
{
    Motion *motions = zeroed(linkage->body_count, sizeof *motions);
    linkage_start(linkage, motions);
    for (size_t i = 0; i < linkage->spring_count; i++) {
        if (entries_find(entries, "springs.*.length", i) == NULL) {
            linkage->springs[i].length = forces_line(&linkage->springs[i], motions).distance;
        }
    }
    for (size_t i = 0; i < linkage->torsion_count; i++) {
        TorsionSpring *spring = &linkage->torsions[i];
        if (entries_find(entries, "torsion-springs.*.angle", i) == NULL) {
            spring->angle = forces_turn(linkage, spring->joint, motions).angle;
        }
    }
    bushings_relax(entries, motions, linkage);
    free(motions);
}

// Where the bodies start, from where the case has them.
static bool start_linkage(const Entries *entries, Linkage *linkage, Motion *motions, Err *err)
{
    linkage_start(linkage, motions);
    set_anchors(entries, linkage, motions);
    if (!check_redundancy(entries, linkage, motions, err)) {
        return false;
    }
    if (build_is_determined(linkage)) {
        return build_start(linkage, motions, err);
    }
    if (!nearest_positions(linkage, motions)) {
        return refuse_positions(entries, linkage, err);
    }
    if (!speeds_find(entries, linkage, motions, err)) {
        return false;
    }
    for (size_t i = 0; i < linkage->body_count; i++) {
        linkage->bodies[i].start = motions[i];
    }
    return true;
}

bool build_forces(const Entries *entries, Scenario *scenario)
{
    Linkage *linkage = &scenario->linkage;
    Motion *motions = zeroed(linkage->body_count, sizeof *motions);
    linkage_start(linkage, motions);
    set_force_anchors(entries, linkage, motions);
    free(motions);
    relax_springs(entries, linkage);
    return true;
}

bool build_linkage(const Entries *entries, Scenario *scenario, Err *err)
{
    Motion *motions = zeroed(scenario->linkage.body_count, sizeof *motions);
    const bool is_started = start_linkage(entries, &scenario->linkage, motions, err);
    free(motions);
    if (is_started) {
        limits_settle(&scenario->linkage);
        relax_springs(entries, &scenario->linkage);
    }
    return is_started;
}

static bool refuse_spatial_speeds(const Entry *entry, const Linkage *linkage, int joint, Err *err)
{
    return entries_refuse(entry, err,
                          "the speeds at the start %s%s\nallowed: speeds that keep the ideal "
                          "joints closed and follow the drive, or none: then they are found",
                          joint >= 0 ? "open the ideal joint " : "are not those of the drive",
                          joint >= 0 ? linkage->joints[joint].name : "");
}

bool build_spatial(const Entries *entries, Scenario *scenario, Err *err)
{
    Linkage *linkage = &scenario->linkage;
    for (size_t i = 0; i < linkage->joint_count; i++) {
        const Entry *start = entries_blame(entries, "joints.*.start joints.*.at-b", i);
        if (start != NULL && vec2_length(linkage->joints[i].clearance.start) > 0.0) {
            return entries_refuse(start, err,
                                  "with axes that are not all along z a pin starts in the middle "
                                  "of its hole\nallowed: %s",
                                  linkage->joints[i].is_apart ? "at, or at-b where at-a is"
                                                              : "centred");
        }
    }
    Motion *motions = zeroed(linkage->body_count, sizeof *motions);
    linkage_start(linkage, motions);
    set_anchors(entries, linkage, motions);
    free(motions);
    SpaceMotion *space = zeroed(linkage->body_count, sizeof *space);
    space_start(linkage, space);
    const Entry *given = entries_speed(entries, linkage->body_count);
    int joint = -1;
    const bool is_good = given == NULL || space_nearest_check(linkage, space, &joint);
    if (given == NULL) {
        space_nearest_speeds(linkage, linkage->driver.is_present, space);
    }
    for (size_t i = 0; is_good && i < linkage->body_count; i++) {
        space_set_start(&space[i], &linkage->bodies[i]);
    }
    free(space);
    return is_good || refuse_spatial_speeds(given, linkage, joint, err);
}
