// Finds the places that a pin in space presses on, their laws, and where it is there.
#include "contact/pin_space.h"

#include "base/zeroed.h"
#include "contact/law.h"
#include "contact/pin_axis.h"

// One place of a joint, whose law has a share of the joint's stiffness and damping.
static bool make_place(const Scenario *scenario, int joint, int place, PinSpace *made, Err *err)
{
    const Linkage *linkage = &scenario->linkage;
    const Joint *data = &linkage->joints[joint];
    const bool is_collar = place == PIN_SPACE_COLLAR;
    *made = (PinSpace){
        .joint = joint,
        .place = place,
        .clearance = is_collar ? data->space.axial_clearance : linkage_radial_clearance(data),
        .hole = space_end(linkage, (size_t)joint, 0),
        .pin = space_end(linkage, (size_t)joint, 1),
    };
    if (!law_of_joint(scenario, data, &made->law, err)) {
        return false;
    }
    if (!is_collar) {
        const double along = (place == 0 ? -0.5 : 0.5) * data->clearance.width;
        made->law = force_law_share(&made->law, 1.0 / PIN_SPACE_ENDS);
        made->hole.anchor = vec3_add(made->hole.anchor, vec3_scale(along, made->hole.axis));
    }
    return true;
}

PinSpace *pin_space_list(const Scenario *scenario, size_t *count, Err *err)
{
    const Linkage *linkage = &scenario->linkage;
    PinSpace *places = zeroed(PIN_SPACE_PLACES * linkage->joint_count, sizeof *places);
    *count = 0;
    for (size_t i = 0; i < linkage->joint_count; i++) {
        const Joint *joint = &linkage->joints[i];
        if (!joint_has_hole(joint->kind)) {
            continue;
        }
        const int last = joint->space.axial_clearance > 0.0 ? PIN_SPACE_PLACES : PIN_SPACE_ENDS;
        for (int place = 0; place < last; place++) {
            if (!make_place(scenario, (int)i, place, &places[(*count)++], err)) {
                free(places);
                return NULL;
            }
        }
    }
    return places;
}

double pin_space_stored(const Scenario *scenario, size_t joint, const SpaceJointState *state)
{
    const Joint *data = &scenario->linkage.joints[joint];
    ForceLaw law;
    Err unused;
    if (!joint_has_hole(data->kind) || scenario->contact.model != CONTACT_IMPACT ||
        !law_of_joint(scenario, data, &law, &unused)) {
        return 0.0;
    }
    const ForceLaw end = force_law_share(&law, 1.0 / PIN_SPACE_ENDS);
    double sum = 0.0;
    for (int i = 0; i < PIN_SPACE_ENDS; i++) {
        sum += force_law_energy(&end, fmax(0.0, -state->end_gaps[i]));
    }
    const double clearance = data->space.axial_clearance;
    return clearance > 0.0 ? sum + force_law_energy(&law, fmax(0.0, fabs(state->axial) - clearance))
                           : sum;
}

// From the force's points and the pin's offset, and how far the pin may be off.
static PinSpacePose pose_at(const PinSpace *place, const SpaceMotion *motions, Vec3 at_a, Vec3 at_b,
                            Vec3 offset)
{
    const double size = vec3_length(offset);
    const Vec3 relative = vec3_sub(space_velocity_at(motions, place->pin.body, at_b),
                                   space_velocity_at(motions, place->hole.body, at_a));
    PinSpacePose pose = {
        .at_a = at_a,
        .at_b = at_b,
        .offset = offset,
        .gap = place->clearance - size,
        .has_normal = size > 0.0,
    };
    if (pose.has_normal) {
        pose.normal = vec3_scale(-1.0 / size, offset);
        pose.approach_speed = -vec3_dot(pose.normal, relative);
    } else {
        pose.approach_speed = vec3_length(relative);
    }
    return pose;
}

PinSpacePose pin_space_pose(const PinSpace *place, const SpaceMotion *motions)
{
    const Vec3 hole = space_point(motions, place->hole.body, place->hole.anchor);
    const Vec3 pin = space_point(motions, place->pin.body, place->pin.anchor);
    if (place->place == PIN_SPACE_COLLAR) {
        const Vec3 axis = space_direction(motions, place->hole.body, place->hole.axis);
        PinSpacePose pose = pose_at(place, motions, pin, pin,
                                    vec3_scale(vec3_dot(axis, vec3_sub(pin, hole)), axis));
        if (!pose.has_normal) {
            const Vec3 relative = vec3_sub(space_velocity_at(motions, place->pin.body, pin),
                                           space_velocity_at(motions, place->hole.body, pin));
            pose.approach_speed = fabs(vec3_dot(axis, relative));
        }
        return pose;
    }
    const Vec3 axis = space_direction(motions, place->pin.body, place->pin.axis);
    const Vec3 offset = pin_axis_offset(hole, pin, axis);
    return pose_at(place, motions, hole, vec3_add(hole, offset), offset);
}
