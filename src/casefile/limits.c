// Reads what limits the coordinate of a joint, and which gears mesh.
//
// A pivot's coordinate is an angle, that of a slider and of gears a length; a backlash of gears may
// be given as the angle of the second gear with the first one held, and becomes a length once the
// pitch radii are known: r = a z / (z_1 + z_2), a the distance of the pivots, z numbers of teeth.
#include "casefile/limits.h"

#include "base/zeroed.h"
#include "model/space_coordinate.h"

#include <math.h>
#include <string.h>

static const char LIMITING[] = "joints.*.backlash joints.*.low joints.*.high";

static const double CIRCLES = 1e4; // rad: more is a slip of the pen

bool limits_are_given(const Entries *entries, size_t joint)
{
    return entries_blame(entries, LIMITING, joint) != NULL;
}

Limits limits_prepare(const Entries *entries, size_t joint)
{
    const bool has_backlash = entries_find(entries, "joints.*.backlash", joint) != NULL;
    return (Limits){
        .kind = has_backlash                       ? LIMIT_BACKLASH
                : limits_are_given(entries, joint) ? LIMIT_STOPS
                                                   : LIMIT_NONE,
        .low = -INFINITY,
        .high = INFINITY,
    };
}

// The row of a key of a joint whose coordinate is an angle.
static SchemaRow as_angle(const SchemaRow *row)
{
    SchemaRow angular = *row;
    switch (row->type) {
    case SCHEMA_STIFFNESS:
        angular.dimension = DIMENSION_TORSION_SPRING;
        break;
    case SCHEMA_DAMPER:
        angular.dimension = DIMENSION_TORSION_DAMPING;
        break;
    default:
        angular.dimension = DIMENSION_ANGLE;
        angular.low = row->low < 0.0 ? -CIRCLES : 0.0;
        angular.high = CIRCLES;
    }
    return angular;
}

static void put(const Target *target, const TargetNumber *number, Joint *joint)
{
    switch (target->entry->row->type) {
    case SCHEMA_STIFFNESS:
        joint->contact.stiffness = number->value;
        joint->contact.exponent = number->exponent;
        break;
    case SCHEMA_START:
        joint->limits.start = number->value;
        break;
    default:
        *(double *)target->field = number->value;
    }
}

// Whether a number of gears stands as an angle.
static bool is_angle(const Node *node)
{
    double value;
    Complaint unused;
    return node->kind == NODE_SCALAR &&
           quantity_parse(node->text, DIMENSION_ANGLE, &value, &unused);
}

// Whether a length along its coordinate may be given as an angle of body b.
static bool may_be_angle(JointKind kind)
{
    switch (joint_coordinate(kind)) {
    case JOINT_COORDINATE_TEETH:
        return true;
    case JOINT_COORDINATE_NONE:
    case JOINT_COORDINATE_ANGLE:
    case JOINT_COORDINATE_POSITION:
        break;
    }
    return false;
}

static bool is_length(SchemaType type)
{
    return type == SCHEMA_COORDINATE || type == SCHEMA_START;
}

SchemaRow limits_row(const SchemaRow *row, JointKind kind, const Node *value)
{
    const bool is_force = row->family == SCHEMA_JOINT &&
                          (row->type == SCHEMA_STIFFNESS || row->type == SCHEMA_DAMPER);
    const bool is_of_gears = may_be_angle(kind) && is_length(row->type) && is_angle(value);
    const bool is_turned =
        is_of_gears || (joint_has_angle(kind) && (is_force || is_length(row->type)));
    SchemaRow own = is_turned ? as_angle(row) : *row;
    own.type = is_length(row->type) ? SCHEMA_QUANTITY : own.type;
    return own;
}

bool limits_store(const Target *target, Joint *joint)
{
    const SchemaRow *row = target->entry->row;
    const Node *node = target->entry->node;
    const bool is_of_gears = may_be_angle(joint->kind) && is_length(row->type) && is_angle(node);
    if (row->type == SCHEMA_START && node->kind == NODE_SCALAR &&
        strcmp(node->text, row->default_words) == 0) {
        return true;
    }
    const SchemaRow own = limits_row(row, joint->kind, node);
    const Entry entry = {&own, target->entry->index, node, target->entry->source};
    Target of_own = *target;
    of_own.entry = &entry;
    TargetNumber number = {.value = 0.0};
    if (!target_number(&of_own, node, &number)) {
        return false;
    }
    joint->gear.is_start_angle =
        row->type == SCHEMA_START ? is_of_gears : joint->gear.is_start_angle;
    joint->gear.is_backlash_angle =
        row->type == SCHEMA_COORDINATE ? is_of_gears : joint->gear.is_backlash_angle;
    put(target, &number, joint);
    return true;
}

bool limits_store_teeth(const Target *target, Gear *gear)
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

// The body that two pivots share; -2 where they share none.
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

static bool join(const Entries *entries, size_t index, Linkage *linkage, Err *err)
{
    Joint *joint = &linkage->joints[index];
    const Entry *gears = entries_find(entries, "joints.*.gears", index);
    const Joint *pivots[2];
    for (int i = 0; i < 2; i++) {
        pivots[i] = &linkage->joints[joint->gear.pivots[i]];
        if (!joint_has_angle(pivots[i]->kind)) {
            // a rack is what is meant by teeth on a body that slides
            const bool is_rack = joint_has_position(pivots[i]->kind);
            return entries_refuse(gears, err,
                                  "gears turn about ideal pivots, and '%s' is none%s\nallowed: two "
                                  "pivots such as [pinion, wheel]%s",
                                  pivots[i]->name, is_rack ? "; there are no racks" : "",
                                  is_rack ? "; a gear of very many teeth, whose pivot is far away, "
                                            "moves nearly straight"
                                          : "");
        }
    }
    const int carrier = shared_body(pivots[0], pivots[1]);
    const double distance = vec2_length(vec2_sub(pivots[0]->anchor_a, pivots[1]->anchor_a));
    if (pivots[0] == pivots[1] || carrier < LINKAGE_GROUND || !(distance > 0.0)) {
        return entries_refuse(gears, err,
                              "the pivots '%s' and '%s' %s\nallowed: two pivots of one body, or of "
                              "the ground, at a distance",
                              pivots[0]->name, pivots[1]->name,
                              pivots[0] == pivots[1]     ? "are one"
                              : carrier < LINKAGE_GROUND ? "are on no common body"
                                                         : "are at the same position");
    }
    joint->gear.carrier = carrier;
    joint->body_a = pivots[0]->body_a == carrier ? pivots[0]->body_b : pivots[0]->body_a;
    joint->body_b = pivots[1]->body_a == carrier ? pivots[1]->body_b : pivots[1]->body_a;
    return joint->body_a != joint->body_b ||
           entries_refuse(gears, err,
                          "both pivots turn one body\nallowed: two pivots of two bodies");
}

bool limits_join_gears(const Entries *entries, Linkage *linkage, Err *err)
{
    for (size_t i = 0; i < linkage->joint_count; i++) {
        if (joint_has_carrier(linkage->joints[i].kind) && !join(entries, i, linkage, err)) {
            return false;
        }
    }
    return true;
}

// The pitch circles share the distance of the pivots.
static void place_gears(Linkage *linkage, const Motion *motions, int number)
{
    Joint *joint = &linkage->joints[number];
    Gear *gear = &joint->gear;
    const Joint *first = &linkage->joints[gear->pivots[0]];
    const Joint *second = &linkage->joints[gear->pivots[1]];
    joint->anchor_a = first->body_a == joint->body_a ? first->anchor_a : first->anchor_b;
    joint->anchor_b = second->body_a == joint->body_b ? second->anchor_a : second->anchor_b;
    const double distance = vec2_length(linkage_joint_gap(linkage, motions, number).position);
    const double sum = gear->teeth[0] + gear->teeth[1];
    gear->radius_a = distance * gear->teeth[0] / sum;
    gear->radius_b = distance * gear->teeth[1] / sum;
    joint->limits.backlash *= gear->is_backlash_angle ? fabs(gear->radius_b) : 1.0;
    joint->limits.start *= gear->is_start_angle ? fabs(gear->radius_b) : 1.0;
    gear->is_backlash_angle = gear->is_start_angle = false;
}

void limits_place_gears(Linkage *linkage, const Motion *motions)
{
    for (int i = 0; i < (int)linkage->joint_count; i++) {
        switch (joint_coordinate(linkage->joints[i].kind)) {
        case JOINT_COORDINATE_TEETH:
            place_gears(linkage, motions, i);
            break;
        case JOINT_COORDINATE_NONE:
        case JOINT_COORDINATE_ANGLE:
        case JOINT_COORDINATE_POSITION:
            break;
        }
    }
}

void limits_settle(Linkage *linkage)
{
    Motion *motions = zeroed(linkage->body_count, sizeof *motions);
    linkage_start(linkage, motions);
    for (size_t i = 0; i < linkage->joint_count; i++) {
        Limits *limits = &linkage->joints[i].limits;
        if (limits->kind == LIMIT_BACKLASH) {
            const double at = linkage->is_spatial ? space_coordinate_start(linkage, (int)i)
                                                  : coordinate_position(linkage, motions, (int)i);
            limits->middle = at - limits->start;
        }
    }
    free(motions);
}
