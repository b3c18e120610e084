// Reads the points of curves over an angle.
#include "casefile/profiles.h"

#include <math.h>

static const double DEGREES = 180.0 / M_PI;

size_t profiles_count(const Entries *entries)
{
    size_t count = 0;
    for (size_t i = 0; i < entries->count; i++) {
        count += entries->entries[i].row->type == SCHEMA_PROFILE ? 1 : 0;
    }
    return count;
}

void profiles_prepare(const Entries *entries, Scenario *scenario)
{
    for (size_t i = 0; i < entries->count; i++) {
        const Entry *entry = &entries->entries[i];
        if (entry->row->type == SCHEMA_PROFILE) {
            size_t *number = schema_field(entry->row, scenario, entry->index);
            *number = ++scenario->linkage.profile_count;
        }
    }
}

// What would be allowed: of a cam distances from a centre, of gears small lengths of any sign.
static const char *points_of(const SchemaRow *row)
{
    return row->low < 0.0 ? "at least 6 points in order within a turn, such as [[0 deg, 0 um], "
                            "[3 deg, 4 um], ...]"
                          : "at least 6 points in order within a turn, such as [[0 deg, 20 mm], "
                            "[60 deg, 21 mm], ...]";
}

// Whether a point is the first one again, a turn behind it.
static bool closes(const Profile *profile, double angle, double radius)
{
    return profile->count > 0 && radius == profile->radii[0] &&
           fabs(angle - profile->angles[0] - 2.0 * M_PI) < 1e-9;
}

static bool check_range(const Target *target, const Node *node, double length)
{
    const SchemaRow *row = target->entry->row;
    const bool is_above = row->low_is_open ? length > row->low : length >= row->low;
    return (is_above && length <= row->high) ||
           source_error(target->entry->source, node->span,
                        row->low < 0.0 ? "-1 m to 1 m" : "above 0 m, up to 100 m", target->err,
                        "a point of %s is out of range: %.60s", target->path, node->text);
}

static bool add_point(const Target *target, const Node *pair[2], Profile *profile)
{
    const SchemaRow *row = target->entry->row;
    const Source *source = target->entry->source;
    double angle;
    double radius;
    if (!target_quantity(target, pair[0], DIMENSION_ANGLE, &angle) ||
        !target_quantity(target, pair[1], DIMENSION_LENGTH, &radius) ||
        !check_range(target, pair[1], radius)) {
        return false;
    }
    if (closes(profile, angle, radius)) {
        return true;
    }
    if (profile->count == PROFILE_MAX) {
        return source_error(source, pair[0]->span, "at most 400 points", target->err,
                            "this point of %s is one too many", target->path);
    }
    const double last = profile->count > 0 ? profile->angles[profile->count - 1] : -INFINITY;
    if (!(angle > last) ||
        (profile->count > 0 && angle >= profile->angles[0] + 2.0 * M_PI * (1.0 - 1e-9))) {
        return source_error(source, pair[0]->span, points_of(row), target->err,
                            angle > last ? "this point of %s is a turn or more behind the first: "
                                           "%.10g deg after %.10g deg"
                                         : "this point of %s is not in order: %.10g deg after "
                                           "%.10g deg",
                            target->path, angle * DEGREES,
                            DEGREES * (angle > last ? profile->angles[0] : last));
    }
    profile->angles[profile->count] = angle;
    profile->radii[profile->count++] = radius;
    return true;
}

bool profiles_store(const Target *target, Linkage *linkage)
{
    const SchemaRow *row = target->entry->row;
    const size_t number = *(const size_t *)target->field;
    Profile *profile = &linkage->profiles[number - 1];
    const Node *node = target->entry->node;
    profile->is_signed = row->low < 0.0;
    for (const Node *point = node->kind == NODE_LIST ? node->first : NULL; point != NULL;
         point = point->next) {
        const Node *pair[2];
        if (!target_pair(point, pair)) {
            return source_error(target->entry->source, point->span, points_of(row), target->err,
                                "a point of %s is an angle and %s", target->path,
                                profile->is_signed ? "a length" : "a distance from the centre");
        }
        if (!add_point(target, pair, profile)) {
            return false;
        }
    }
    if (profile->count < PROFILE_MIN) {
        return source_error(target->entry->source, node->span, points_of(row), target->err,
                            "%s has %zu points", target->path, profile->count);
    }
    return profile_settle(profile, target->err);
}
