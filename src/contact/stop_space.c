// Finds how the gap at a stop of a hinge in space opens.
//
// With u the axis, fixed in body a, with the sign of the angle and of the stop:
//     gap' = u . (omega_b - omega_a)
//     gap'' = u . (alpha_b - alpha_a) + (omega_a x u) . (omega_b - omega_a)
#include "contact/stop_space.h"

#include "base/zeroed.h"
#include "contact/law.h"

#include <math.h>

StopSpace *stop_space_list(const Scenario *scenario, size_t *count, Err *err)
{
    const Linkage *linkage = &scenario->linkage;
    StopSpace *stops = zeroed(2 * linkage->joint_count, sizeof *stops);
    *count = 0;
    for (size_t i = 0; i < linkage->joint_count; i++) {
        const Joint *joint = &linkage->joints[i];
        const double ends[2] = {coordinate_low(joint), coordinate_high(joint)};
        ForceLaw law;
        if (joint->limits.kind == LIMIT_NONE) {
            continue;
        }
        if (!law_of_joint(scenario, joint, &law, err)) {
            free(stops);
            return NULL;
        }
        for (int k = 0; k < 2; k++) {
            if (isfinite(ends[k])) {
                const double sign = k == 0 ? 1.0 : -1.0;
                stops[(*count)++] =
                    (StopSpace){.joint = (int)i, .sign = sign, .limit = ends[k], .law = law};
            }
        }
    }
    return stops;
}

SpaceRow stop_space_row(const StopSpace *stop, const Linkage *linkage, const SpaceMotion *motions)
{
    SpaceRow row = space_coordinate_row(linkage, motions, stop->joint);
    for (int side = 0; side < 2; side++) {
        row.angular[side] = vec3_scale(stop->sign, row.angular[side]);
    }
    return row;
}

double stop_space_drift(const StopSpace *stop, const Linkage *linkage, const SpaceMotion *motions)
{
    static const SpaceMotion STILL = {.turn = {1.0, 0.0, 0.0, 0.0}};
    const Joint *joint = &linkage->joints[stop->joint];
    const SpaceMotion *a = joint->body_a == LINKAGE_GROUND ? &STILL : &motions[joint->body_a];
    const SpaceMotion *b = joint->body_b == LINKAGE_GROUND ? &STILL : &motions[joint->body_b];
    const Vec3 axis = vec3_scale(stop->sign, space_coordinate_axis(linkage, motions, stop->joint));
    return vec3_dot(axis, vec3_sub(b->alpha, a->alpha)) +
           vec3_dot(vec3_cross(a->omega, axis), vec3_sub(b->omega, a->omega));
}
