// Reads the stiffnesses, dampings and points of bushings.
#include "casefile/bushings.h"

#include "model/bushing.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { BUSHINGS_ALLOWED_SIZE = 128 };

static const char BUSHINGS_CURVES[] = "bushings.*.force-x bushings.*.force-y bushings.*.torque";

void bushings_prepare(const Entries *entries, Linkage *linkage)
{
    const EntryNames *names = &entries->names[SCHEMA_BUSHING];
    linkage->bushing_count = names->count;
    for (size_t i = 0; i < names->count; i++) {
        Bushing *bushing = &linkage->bushings[i];
        text_copy(bushing->name, LINKAGE_NAME_SIZE, names->names[i]);
        bushing->is_apart = entries_find(entries, "bushings.*.at-b", i) != NULL;
    }
}

bool bushings_store_pair(const Target *target, Vec2 *pair)
{
    const Node *node = target->entry->node;
    const Node *items[2] = {node, node};
    TargetNumber x = {.value = 0.0};
    TargetNumber y = x;
    if (node->kind != NODE_SCALAR && !target_pair(node, items)) {
        return target_refuse(target, node->span, "%s takes one number, or one for each axis",
                             target->path);
    }
    if (!target_number(target, items[0], &x) || !target_number(target, items[1], &y)) {
        return false;
    }
    *pair = (Vec2){x.value, y.value};
    return true;
}

// What its points are over.
static Dimension over_of(const SchemaRow *row)
{
    return row->dimension == DIMENSION_TORQUE ? DIMENSION_ANGLE : DIMENSION_LENGTH;
}

static bool check_value(const Target *target, const Node *node, double value)
{
    const SchemaRow *row = target->entry->row;
    char allowed[BUSHINGS_ALLOWED_SIZE];
    snprintf(allowed, sizeof allowed, "%g to %g %s", row->low, row->high, units_si(row->dimension));
    return fabs(value) <= row->high ||
           source_error(target->entry->source, node->span, allowed, target->err,
                        "%s is out of range: %.60s", target->path, node->text);
}

// Reads a point into the next free place of the curve.
static bool read_point(const Target *target, const Node *point, ForceCurve *curve)
{
    const SchemaRow *row = target->entry->row;
    const Source *source = target->entry->source;
    const Node *pair[2];
    double at;
    double value;
    if (!target_pair(point, pair)) {
        return target_refuse(target, point->span, "a point of %s is %s and %s", target->path,
                             units_dimension_name(over_of(row)),
                             units_dimension_name(row->dimension));
    }
    if (curve->count == FORCE_CURVE_MAX) {
        char allowed[BUSHINGS_ALLOWED_SIZE];
        snprintf(allowed, sizeof allowed, "at most %d points", FORCE_CURVE_MAX);
        return source_error(source, pair[0]->span, allowed, target->err,
                            "this point of %s is one too many", target->path);
    }
    if (!target_quantity(target, pair[0], over_of(row), &at) ||
        !target_quantity(target, pair[1], row->dimension, &value) ||
        !check_value(target, pair[1], value)) {
        return false;
    }
    if (!isfinite(at) || (curve->count > 0 && !(at > curve->at[curve->count - 1]))) {
        return source_error(source, pair[0]->span, "each point behind the one before", target->err,
                            "this point of %s is not in order: %.60s", target->path, pair[0]->text);
    }
    curve->at[curve->count] = at;
    curve->values[curve->count++] = value;
    return true;
}

bool bushings_store_curve(const Target *target, ForceCurve *curve)
{
    const Node *node = target->entry->node;
    ForceCurve read = {.count = 0};
    for (const Node *point = node->kind == NODE_LIST ? node->first : NULL; point != NULL;
         point = point->next) {
        if (!read_point(target, point, &read)) {
            return false;
        }
    }
    if (read.count < 2) {
        return target_refuse(target, node->span, "%s takes two points at least", target->path);
    }
    *curve = read;
    return true;
}

static Vec2 place_on(const Motion *motions, int body, Vec2 point)
{
    return body == LINKAGE_GROUND
               ? point
               : vec2_rotate(-motions[body].angle, vec2_sub(point, motions[body].position));
}

void bushings_place(Linkage *linkage, const Motion *motions)
{
    for (size_t i = 0; i < linkage->bushing_count; i++) {
        Bushing *bushing = &linkage->bushings[i];
        const int body_a = bushing->body_a;
        const Vec2 first = bushing->anchor_a;
        const Vec2 second = bushing->is_apart ? bushing->anchor_b : first;
        bushing->anchor_a = place_on(motions, body_a, first);
        bushing->anchor_b = place_on(motions, bushing->body_b, second);
        bushing->direction -= body_a == LINKAGE_GROUND ? 0.0 : motions[body_a].angle;
        force_curve_settle(&bushing->force_x, bushing->interpolation);
        force_curve_settle(&bushing->force_y, bushing->interpolation);
        force_curve_settle(&bushing->torque, bushing->interpolation);
    }
}

void bushings_relax(const Entries *entries, const Motion *motions, Linkage *linkage)
{
    for (size_t i = 0; i < linkage->bushing_count; i++) {
        Bushing *bushing = &linkage->bushings[i];
        if (entries_find(entries, "bushings.*.angle", i) == NULL) {
            bushing->angle += bushing_pose(bushing, motions).deflection[2];
        }
    }
}

bool bushings_apply(const SchemaRow *row, const Bushing *bushing)
{
    const bool has_forces = bushing->force_x.count > 0 || bushing->force_y.count > 0;
    switch (row->offset) {
    case offsetof(Bushing, anchor_a):
        return bushing->is_apart == (row->side != SCHEMA_PLACE_OF_BOTH);
    case offsetof(Bushing, anchor_b):
        return bushing->is_apart;
    case offsetof(Bushing, stiffness):
        return !has_forces;
    case offsetof(Bushing, torsional_stiffness):
        return bushing->torque.count == 0;
    case offsetof(Bushing, force_x):
        return bushing->force_x.count > 0;
    case offsetof(Bushing, force_y):
        return bushing->force_y.count > 0;
    case offsetof(Bushing, torque):
        return bushing->torque.count > 0;
    case offsetof(Bushing, interpolation):
        return has_forces || bushing->torque.count > 0;
    default:
        return true;
    }
}

// Whether a bushing pushes or pulls at all.
static bool acts(const Bushing *bushing)
{
    bool is_any = bushing_damps(bushing) || bushing->torsional_stiffness != 0.0 ||
                  bushing->stiffness.x != 0.0 || bushing->stiffness.y != 0.0;
    for (size_t row = 0; row < BUSHING_ROWS; row++) {
        is_any = is_any || bushing_curve(bushing, row)->count > 0;
    }
    return is_any;
}

static bool check_one(const Entries *entries, const Bushing *bushing, size_t index, Err *err)
{
    const Entry *interpolation = entries_find(entries, "bushings.*.interpolation", index);
    const Entry *angle = entries_find(entries, "bushings.*.angle", index);
    if (interpolation != NULL && entries_blame(entries, BUSHINGS_CURVES, index) == NULL) {
        return entries_refuse(interpolation, err,
                              "only points are interpolated\nallowed: with force-x, force-y or "
                              "torque of bushing '%s'",
                              bushing->name);
    }
    if (angle != NULL &&
        entries_blame(entries, "bushings.*.torsional-stiffness bushings.*.torque", index) == NULL) {
        return entries_refuse(angle, err,
                              "bushing '%s' has no stiffness by angle that it could be relaxed "
                              "at\nallowed: with torsional-stiffness or torque",
                              bushing->name);
    }
    return acts(bushing) ||
           entries_refuse_group(entries_group(entries, "bushings.*", index), err,
                                "bushing '%s' does nothing\nallowed: a stiffness, a damping, or "
                                "points of its force or torque",
                                bushing->name);
}

bool bushings_check(const Entries *entries, const Linkage *linkage, Err *err)
{
    bool is_good = true;
    for (size_t i = 0; is_good && i < linkage->bushing_count; i++) {
        is_good = check_one(entries, &linkage->bushings[i], i, err);
    }
    return is_good;
}
