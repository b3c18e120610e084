// Reads the profiles of cams, and checks that their followers go with them.
#include "casefile/cam.h"

#include <math.h>

static const char POINTS[] =
    "at least 6 points in order within a turn, such as [[0 deg, 20 mm], [60 deg, 21 mm], ...]";

static const double DEGREES = 180.0 / M_PI;

size_t cam_count(const Entries *entries)
{
    size_t count = 0;
    for (size_t i = 0; i < entries->count; i++) {
        count += entries->entries[i].row->type == SCHEMA_PROFILE ? 1 : 0;
    }
    return count;
}

void cam_prepare(const Entries *entries, Linkage *linkage)
{
    for (size_t i = 0; i < linkage->joint_count; i++) {
        if (entries_find(entries, "joints.*.profile", i) != NULL) {
            linkage->joints[i].stop.cam = ++linkage->profile_count;
        }
    }
}

// Whether a point is the first one again, a turn behind it.
static bool closes(const Profile *profile, double angle, double radius)
{
    return profile->count > 0 && radius == profile->radii[0] &&
           fabs(angle - profile->angles[0] - 2.0 * M_PI) < 1e-9;
}

static bool add_point(const Target *target, const Node *pair[2], Profile *profile)
{
    const SchemaRow *row = target->entry->row;
    const Source *source = target->entry->source;
    double angle;
    double radius;
    if (!target_quantity(target, pair[0], DIMENSION_ANGLE, &angle) ||
        !target_quantity(target, pair[1], DIMENSION_LENGTH, &radius)) {
        return false;
    }
    if (!(radius > row->low && radius <= row->high)) {
        return source_error(source, pair[1]->span, "above 0 m, up to 100 m", target->err,
                            "a point of %s is out of range: %.60s", target->path, pair[1]->text);
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
        return source_error(source, pair[0]->span, POINTS, target->err,
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

bool cam_store(const Target *target, Linkage *linkage, Stop *stop)
{
    Profile *profile = &linkage->profiles[stop->cam - 1];
    const Node *node = target->entry->node;
    for (const Node *point = node->kind == NODE_LIST ? node->first : NULL; point != NULL;
         point = point->next) {
        const Node *pair[2];
        if (!target_pair(point, pair)) {
            return source_error(target->entry->source, point->span, POINTS, target->err,
                                "a point of %s is an angle and a distance from the centre",
                                target->path);
        }
        if (!add_point(target, pair, profile)) {
            return false;
        }
    }
    if (profile->count < PROFILE_MIN) {
        return source_error(target->entry->source, node->span, POINTS, target->err,
                            "%s has %zu points", target->path, profile->count);
    }
    if (!profile_settle(profile, target->err)) {
        return false;
    }
    stop->radius_a = profile->reach;
    stop->hump = profile->least_hump;
    return true;
}

void cam_complete(const Entries *entries, Linkage *linkage)
{
    for (size_t i = 0; i < linkage->joint_count; i++) {
        Joint *joint = &linkage->joints[i];
        if (joint->stop.cam > 0) {
            joint->stop.is_flat = entries_find(entries, "joints.*.normal", i) != NULL;
            joint->stop.facing = joint->stop.is_flat ? joint->direction : 0.0;
            joint->direction = 0.0;
        }
    }
}

bool cam_check(const Entries *entries, size_t index, const Linkage *linkage, Err *err)
{
    const Joint *joint = &linkage->joints[index];
    const Stop *stop = &joint->stop;
    const Profile *profile = linkage_profile(linkage, joint);
    const Entry *radius = entries_find(entries, "joints.*.radius", index);
    if (profile == NULL) {
        return true;
    }
    if (stop->is_flat && radius != NULL && stop->radius_b > 0.0) {
        return entries_refuse(
            radius, err,
            "a flat has no radius\nallowed: a normal for a flat, or a radius for a "
            "roller");
    }
    const double hollow = profile->least_hollow;
    const double at = profile->hollow_at * DEGREES;
    if (stop->is_flat && isfinite(hollow)) {
        return entries_refuse(entries_find(entries, "joints.*.normal", index), err,
                              "a flat does not reach into the hollow of the profile at %.4g deg\n"
                              "allowed: a profile that is convex all round, or a roller",
                              at);
    }
    return stop->radius_b < hollow ||
           entries_refuse(radius, err,
                          "the roller does not reach into the hollow of the profile at %.4g deg, "
                          "whose radius is %.4g mm\nallowed: a smaller radius",
                          at, 1e3 * hollow);
}
