// Finds how pins stand in their holes in space, and what the drive does.
//
// Of the driven body, whose motion is given and whose angular velocity is constant along an axis:
//     F_drive = m (a - g) - sum F_i,   P = m (a - g) . v - sum (F_i . v + M_i . omega)
// with F_i and M_i the other forces and their moments about the centre of mass; the momentum of a
// body that turns steadily about a fixed axis takes no power.
#include "ode/space/space_joints.h"

#include "base/zeroed.h"
#include "model/space_coordinate.h"

#include <math.h>
#include <string.h>

SpaceJoints space_joints_create(const Linkage *linkage)
{
    return (SpaceJoints){
        .plane = zeroed(linkage->joint_count, sizeof(JointState)),
        .space = zeroed(linkage->joint_count, sizeof(SpaceJointState)),
    };
}

void space_joints_free(SpaceJoints *joints)
{
    free(joints->plane);
    free(joints->space);
}

// Of one joint: everything but the forces.
static void place_joint(const SpaceResponse *response, const SpaceMotion *motions, size_t number,
                        JointState *plane, SpaceJointState *space)
{
    const SpaceEnd hole = response->ends[number][0];
    const SpaceEnd pin = response->ends[number][1];
    const Vec3 middle = space_point(motions, hole.body, hole.anchor);
    const Vec3 hole_axis = space_direction(motions, hole.body, hole.axis);
    const Vec3 pin_axis = space_direction(motions, pin.body, pin.axis);
    const Vec3 offset = vec3_sub(space_point(motions, pin.body, pin.anchor), middle);
    plane->eccentricity = (Vec2){offset.x, offset.y};
    space->offset = offset;
    const Joint *joint = &response->linkage->joints[number];
    if (joint->limits.kind != LIMIT_NONE) {
        // what it was at the last look says which turn it is in
        const Linkage *linkage = response->linkage;
        plane->tilt = space_coordinate_near(linkage, motions, (int)number, plane->tilt);
        plane->gap =
            fmin(plane->tilt - coordinate_low(joint), coordinate_high(joint) - plane->tilt);
        return;
    }
    plane->gap = 0.0;
    plane->is_touching = true;
    if (!joint_has_hole(joint->kind)) {
        return;
    }
    const double clearance = linkage_radial_clearance(joint);
    for (int end = 0; end < PIN_SPACE_ENDS; end++) {
        const double along = (end == 0 ? -0.5 : 0.5) * joint->clearance.width;
        const Vec3 between = vec3_sub(offset, vec3_scale(along, hole_axis));
        space->ends[end] = vec3_across(between, pin_axis);
        space->end_gaps[end] = clearance - vec3_length(space->ends[end]);
    }
    space->tilt =
        atan2(vec3_length(vec3_cross(hole_axis, pin_axis)), vec3_dot(hole_axis, pin_axis));
    space->axial = vec3_dot(hole_axis, offset);
    plane->gap = fmin(space->end_gaps[0], space->end_gaps[1]);
    plane->is_touching = plane->gap < 0.0;
}

void space_joints_place(const SpaceResponse *response, const SpaceMotion *motions,
                        JointState *plane, SpaceJointState *space)
{
    for (size_t i = 0; i < response->linkage->joint_count; i++) {
        place_joint(response, motions, i, &plane[i], &space[i]);
    }
}

void space_joints_place_one(const SpaceResponse *response, const SpaceMotion *motions, size_t joint,
                            SpaceJoints *joints)
{
    place_joint(response, motions, joint, &joints->plane[joint], &joints->space[joint]);
}

void space_joints_clear(const Linkage *linkage, SpaceJoints *joints)
{
    for (size_t i = 0; i < linkage->joint_count; i++) {
        space_joints_clear_one(joints, i);
    }
}

void space_joints_clear_one(SpaceJoints *joints, size_t joint)
{
    memset(&joints->plane[joint], 0, sizeof joints->plane[joint]);
    memset(&joints->space[joint], 0, sizeof joints->space[joint]);
}

void space_joints_press(SpaceJoints *joints, const PinSpace *place, Vec3 force, Vec3 hole_axis)
{
    JointState *plane = &joints->plane[place->joint];
    SpaceJointState *space = &joints->space[place->joint];
    space->force_on_b = vec3_add(space->force_on_b, force);
    plane->force_on_b = (Vec2){space->force_on_b.x, space->force_on_b.y};
    if (place->place == PIN_SPACE_COLLAR) {
        space->axial_force = vec3_dot(hole_axis, force);
    } else {
        space->end_forces[place->place] = vec3_length(force);
        plane->force = space->end_forces[0] + space->end_forces[1];
    }
}

void space_joints_hold(SpaceJoints *joints, size_t joint, Vec3 force)
{
    joints->space[joint].force_on_b = force;
    joints->plane[joint].force_on_b = (Vec2){force.x, force.y};
    joints->plane[joint].force = vec3_length(force);
}

double space_joints_drive(const Scenario *scenario, const SpaceMotion *driven,
                          const SpaceChange *others, Vec3 *force)
{
    const Linkage *linkage = &scenario->linkage;
    const Vec3 needed = vec3_scale(linkage->bodies[linkage_driven_body(linkage)].mass,
                                   vec3_sub(driven->acceleration, scenario->gravity));
    *force = vec3_sub(needed, others->move);
    return vec3_dot(*force, driven->velocity) - vec3_dot(others->turn, driven->omega);
}
