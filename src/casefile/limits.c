// Reads what limits the coordinate of a joint.
//
// A pivot's coordinate is an angle, that of a slider and of teeth a length; a backlash of teeth may
// be given as the angle of the second body with the first one held, and becomes a length once the
// pitch radii are known (casefile/teeth.c).
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

Dimension limits_turning_damper(Dimension dimension)
{
    switch (dimension) {
    case DIMENSION_DISSIPATION:
        return DIMENSION_TORSION_DISSIPATION;
    case DIMENSION_LENGTH:
        return DIMENSION_ANGLE;
    default:
        return DIMENSION_TORSION_DAMPING;
    }
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
        angular.dimension = limits_turning_damper(row->dimension);
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

// Whether a number of teeth stands as an angle.
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
    case JOINT_COORDINATE_RACK:
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
    const bool is_turn = may_be_angle(kind) && is_length(row->type) && is_angle(value);
    const bool is_turned = is_turn || (joint_has_angle(kind) && (is_force || is_length(row->type)));
    SchemaRow own = is_turned ? as_angle(row) : *row;
    own.type = is_length(row->type) ? SCHEMA_QUANTITY : own.type;
    return own;
}

bool limits_store(const Target *target, Joint *joint)
{
    const SchemaRow *row = target->entry->row;
    const Node *node = target->entry->node;
    const bool is_turn = may_be_angle(joint->kind) && is_length(row->type) && is_angle(node);
    if (row->type == SCHEMA_START && node->kind == NODE_SCALAR &&
        strcmp(node->text, row->default_words) == 0) {
        return true;
    }
    const SchemaRow own = limits_row(row, joint->kind, node);
    const Entry entry = {&own, target->entry->index, node, target->entry->source, NULL};
    Target of_own = *target;
    of_own.entry = &entry;
    TargetNumber number = {.value = 0.0};
    if (!target_number(&of_own, node, &number)) {
        return false;
    }
    joint->gear.is_start_angle = row->type == SCHEMA_START ? is_turn : joint->gear.is_start_angle;
    joint->gear.is_backlash_angle =
        row->type == SCHEMA_COORDINATE ? is_turn : joint->gear.is_backlash_angle;
    put(target, &number, joint);
    return true;
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
