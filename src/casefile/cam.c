// Checks that the followers of cams go with their profiles.
#include "casefile/cam.h"

#include <math.h>

static const double DEGREES = 180.0 / M_PI;

void cam_complete(const Entries *entries, Linkage *linkage)
{
    for (size_t i = 0; i < linkage->joint_count; i++) {
        Joint *joint = &linkage->joints[i];
        const Profile *profile = linkage_profile(linkage, joint);
        if (profile != NULL) {
            joint->stop.radius_a = profile->reach;
            joint->stop.hump = profile->least_hump;
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
