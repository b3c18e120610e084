// Finds on which bodies the teeth of gears, or of a rack and its pinion, are, and where.
//
// Gears have pitch radii r = a z / (z_1 + z_2), a the distance of their pivots, z numbers of teeth.
// The pitch line of a rack is the line of its guide, and the radius of its pinion the distance of
// the pivot from that line.
#include "casefile/teeth.h"

#include "base/err.h"

#include <math.h>

bool teeth_store(const Target *target, Gear *gear)
{
    const Node *pair[2];
    const Node *node = target->entry->node;
    TargetNumber teeth[2] = {{.value = 0.0}, {.value = 0.0}};
    if (!target_pair(node, pair)) {
        return target_refuse(target, node->span, "%s takes two numbers of teeth", target->path);
    }
    for (int i = 0; i < 2; i++) {
        if (!target_number(target, pair[i], &teeth[i])) {
            return false;
        }
        if (teeth[i].value != trunc(teeth[i].value)) {
            return source_error(target->entry->source, pair[i]->span,
                                "a whole number; for a ratio alone two whole numbers in it, such "
                                "as [41, 80] for 20.5 to 40",
                                target->err, "%.12g is no number of teeth", teeth[i].value);
        }
    }
    const bool is_internal = teeth[0].value < 0.0 || teeth[1].value < 0.0;
    const double sum = teeth[0].value + teeth[1].value;
    if (teeth[0].value == 0.0 || teeth[1].value == 0.0 || sum == 0.0 ||
        (is_internal && teeth[0].value * teeth[1].value > 0.0)) {
        return source_error(target->entry->source, node->span,
                            "two numbers above 0, or one below 0 of an internal gear, which is the "
                            "larger one",
                            target->err, "no gears have these numbers of teeth");
    }
    gear->teeth[0] = teeth[0].value;
    gear->teeth[1] = teeth[1].value;
    return true;
}

// The body that two joints share; -2 where they share none.
static int shared_body(const Joint *first, const Joint *second)
{
    const int bodies[2] = {first->body_a, first->body_b};
    for (int i = 0; i < 2; i++) {
        if (bodies[i] == second->body_a || bodies[i] == second->body_b) {
            return bodies[i];
        }
    }
    return LINKAGE_GROUND - 1;
}

static int other_body(const Joint *joint, int body)
{
    return joint->body_a == body ? joint->body_b : joint->body_a;
}

// Whether both joints are those that a pair of gears needs.
static bool are_pivots(const Entry *gears, const Joint *const pivots[2], Err *err)
{
    for (int i = 0; i < 2; i++) {
        if (!joint_pivots(pivots[i]->kind)) {
            const bool is_rack = joint_slides(pivots[i]->kind);
            return entries_refuse(gears, err,
                                  "gears turn about pivots or pins, and '%s' is none\nallowed: two "
                                  "of them such as [pinion, wheel]%s",
                                  pivots[i]->name,
                                  is_rack ? "; or, of a rack, 'rack' in place of 'gears'" : "");
        }
    }
    return true;
}

// Whether both joints are those that a rack and pinion need.
static bool are_guide_and_pivot(const Entry *rack, const Joint *const joints[2], Err *err)
{
    const bool is_guide = joint_slides(joints[0]->kind);
    return (is_guide && joint_pivots(joints[1]->kind)) ||
           entries_refuse(rack, err,
                          "a rack %s, and '%s' %s\nallowed: a prismatic joint or guide and a pivot "
                          "or pin, such as [rack-guide, pinion-pivot]",
                          is_guide ? "turns a pinion on a pivot" : "slides",
                          joints[is_guide ? 1 : 0]->name, is_guide ? "is none" : "does not");
}

// How far the pivot is from the line of the guide, positive to its left, m; both as the case places
// them in the world.
static double distance_from_line(const Joint *guide, const Joint *pivot)
{
    const Vec2 across = vec2_perp(vec2_rotate(guide->direction, (Vec2){1.0, 0.0}));
    return vec2_dot(across, vec2_sub(pivot->anchor_a, guide->anchor_a));
}

// Whether a table comes again as often as the gears say in a turn of the first one.
static bool settle_table(const Entry *points, size_t repeats, Profile *table, Err *err)
{
    table->period = 2.0 * M_PI / (double)repeats;
    if (table->radii[table->count - 1] == table->radii[0] &&
        fabs(table->angles[table->count - 1] - table->angles[0] - table->period) < 1e-9) {
        table->count--; // the first point again
    }
    const double reach = table->angles[table->count - 1] - table->angles[0];
    if (reach >= table->period * (1.0 - 1e-9)) {
        return entries_refuse(points, err,
                              "the points reach over %.6g deg, and come again after %.6g deg\n"
                              "allowed: points within one of the %zu repeats in a turn",
                              reach * 180.0 / M_PI, table->period * 180.0 / M_PI, repeats);
    }
    return profile_settle(table, err);
}

static bool settle_tables(const Entries *entries, size_t index, Linkage *linkage, Err *err)
{
    Gear *gear = &linkage->joints[index].gear;
    const Entry *error = entries_find(entries, "joints.*.transmission-error", index);
    const Entry *relief = entries_find(entries, "joints.*.relief", index);
    const Entry *repeats = entries_find(entries, "joints.*.repeats", index);
    if (repeats != NULL && error == NULL && relief == NULL) {
        return entries_refuse(repeats, err,
                              "nothing repeats in a turn of the first gear\nallowed: beside a "
                              "transmission-error or relief");
    }
    gear->repeats = gear->repeats == 0 ? 1 : gear->repeats;
    return (error == NULL ||
            settle_table(error, gear->repeats, &linkage->profiles[gear->error - 1], err)) &&
           (relief == NULL ||
            settle_table(relief, gear->repeats, &linkage->profiles[gear->relief - 1], err));
}

// Whether gears stay as far apart as they are, or push so that they need not.
static bool are_fixed_apart(const Entries *entries, size_t index, const Joint *gears,
                            const Joint *const pivots[2], Err *err)
{
    for (int i = 0; i < 2; i++) {
        if (!joint_is_ideal(pivots[i]->kind) && gears->gear.pressure_angle == 0.0) {
            return entries_refuse(entries_find(entries, "joints.*.gears", index), err,
                                  "the pin '%s' has play, so that the gears come apart\nallowed: a "
                                  "pressure-angle, such as 20 deg, or two ideal pivots",
                                  pivots[i]->name);
        }
    }
    return true;
}

static bool join(const Entries *entries, size_t index, Linkage *linkage, Err *err)
{
    Joint *joint = &linkage->joints[index];
    const bool is_rack = joint_has_rack(joint->kind);
    const Entry *given = entries_find(entries, is_rack ? "joints.*.rack" : "joints.*.gears", index);
    const Joint *joints[2] = {&linkage->joints[joint->gear.pivots[0]],
                              &linkage->joints[joint->gear.pivots[1]]};
    if (!(is_rack ? are_guide_and_pivot : are_pivots)(given, joints, err)) {
        return false;
    }
    const int carrier = shared_body(joints[0], joints[1]);
    const double distance = is_rack
                                ? distance_from_line(joints[0], joints[1])
                                : vec2_length(vec2_sub(joints[0]->anchor_a, joints[1]->anchor_a));
    if (joints[0] == joints[1] || carrier < LINKAGE_GROUND || distance == 0.0) {
        return entries_refuse(given, err,
                              "the %s '%s' and '%s' %s\nallowed: two %s of one body, or of "
                              "the ground, at a distance",
                              is_rack ? "joints" : "pivots", joints[0]->name, joints[1]->name,
                              joints[0] == joints[1]     ? "are one"
                              : carrier < LINKAGE_GROUND ? "are on no common body"
                              : is_rack
                                  ? "leave the pinion no radius: its pivot is on the rack's line"
                                  : "are at the same position",
                              is_rack ? "joints" : "pivots");
    }
    if (!is_rack && !(are_fixed_apart(entries, index, joint, joints, err) &&
                      settle_tables(entries, index, linkage, err))) {
        return false;
    }
    joint->body_a = other_body(joints[0], carrier);
    joint->body_b = other_body(joints[1], carrier);
    joint->gear.radius_a = INFINITY; // until gears are placed
    joint->gear.radius_b = distance;
    return joint->body_a != joint->body_b ||
           entries_refuse(given, err, "both %s %s one body\nallowed: two %s of two bodies",
                          is_rack ? "joints" : "pivots", is_rack ? "are of" : "turn",
                          is_rack ? "joints" : "pivots");
}

bool teeth_join(const Entries *entries, Linkage *linkage, Err *err)
{
    for (size_t i = 0; i < linkage->joint_count; i++) {
        if (joint_has_teeth(linkage->joints[i].kind) && !join(entries, i, linkage, err)) {
            return false;
        }
    }
    return true;
}

// The anchor of a joint on one of its bodies.
static Vec2 anchor_on(const Joint *joint, int body)
{
    return joint->body_a == body ? joint->anchor_a : joint->anchor_b;
}

static double angle_of(const Motion *motions, int body)
{
    return body == LINKAGE_GROUND ? 0.0 : motions[body].angle;
}

// The pitch circles share the distance of the pivots.
static void place_gears(const Linkage *linkage, const Motion *motions, int number, Gear *gear)
{
    const Joint *joint = &linkage->joints[number];
    const double distance = vec2_length(linkage_joint_gap(linkage, motions, number).position);
    const double sum = gear->teeth[0] + gear->teeth[1];
    gear->radius_a = distance * gear->teeth[0] / sum;
    gear->radius_b = distance * gear->teeth[1] / sum;
    gear->zero = gear->teeth[1] / sum *
                 (angle_of(motions, joint->body_a) - angle_of(motions, joint->body_b));
}

// The line of the guide in the rack's frame.
static double direction_on_rack(const Joint *guide, int rack)
{
    return guide->body_a == rack ? guide->direction : guide->direction - guide->held_angle;
}

static void place(Linkage *linkage, const Motion *motions, int number)
{
    Joint *joint = &linkage->joints[number];
    Gear *gear = &joint->gear;
    const Joint *first = &linkage->joints[gear->pivots[0]];
    joint->anchor_a = anchor_on(first, joint->body_a);
    joint->anchor_b = anchor_on(&linkage->joints[gear->pivots[1]], joint->body_b);
    if (joint_has_rack(joint->kind)) {
        joint->direction = direction_on_rack(first, joint->body_a);
    } else {
        place_gears(linkage, motions, number, gear);
    }
    joint->limits.backlash *= gear->is_backlash_angle ? fabs(gear->radius_b) : 1.0;
    joint->limits.start *= gear->is_start_angle ? fabs(gear->radius_b) : 1.0;
    gear->is_backlash_angle = gear->is_start_angle = false;
}

void teeth_place(Linkage *linkage, const Motion *motions)
{
    for (int i = 0; i < (int)linkage->joint_count; i++) {
        if (joint_has_teeth(linkage->joints[i].kind)) {
            place(linkage, motions, i);
        }
    }
}
