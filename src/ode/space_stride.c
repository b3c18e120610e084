// What came of one step of a linkage in space?
#include "ode/space_stride.h"

#include "base/zeroed.h"
#include "ode/space_world.h"

void space_stride_create(const Linkage *linkage, SpaceStride *stride)
{
    stride->first = zeroed(linkage->body_count, sizeof *stride->first);
    stride->last = zeroed(linkage->body_count, sizeof *stride->last);
    stride->omega = zeroed(linkage->body_count, sizeof *stride->omega);
    stride->alpha = zeroed(linkage->body_count, sizeof *stride->alpha);
    stride->joints = space_joints_create(linkage);
    stride->impulse = zeroed(linkage->joint_count, sizeof *stride->impulse);
    stride->tops = zeroed(linkage->joint_count, sizeof *stride->tops);
    stride->approach = zeroed(linkage->joint_count, sizeof *stride->approach);
}

void space_stride_free(SpaceStride *stride)
{
    free(stride->first);
    free(stride->last);
    free(stride->omega);
    free(stride->alpha);
    space_joints_free(&stride->joints);
    free(stride->impulse);
    free(stride->approach);
    free(stride->tops);
}

void space_stride_book(SpaceStride *stride, const SpaceMotion *driven, double step_s,
                       const World *world, SpaceContacts *contacts, SpaceStops *stops)
{
    const Linkage *linkage = world->linkage;
    const int body = linkage_driven_body(linkage);
    SpaceChange others = {{0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}};
    space_contacts_clear(contacts, step_s, &stride->joints);
    space_contacts_load(contacts, body, driven->position, &others);
    for (size_t i = 0; i < linkage->joint_count; i++) {
        const Joint *joint = &linkage->joints[i];
        if (!linkage_is_ideal(linkage, i)) {
            continue;
        }
        space_joints_hold(&stride->joints, i, space_world_force(world, i));
        if (body >= 0 && (joint->body_a == body || joint->body_b == body)) {
            const SpaceChange load = space_world_load(world, i, body);
            others.move = vec3_add(others.move, load.move);
            others.turn = vec3_add(others.turn, load.turn);
        }
    }
    space_stops_clear(stops, step_s, &stride->joints);
    space_stops_tops(stops, stride->tops);
    stride->drive_work = 0.0;
    if (body >= 0) {
        Vec3 force;
        stride->drive_work =
            step_s * space_joints_drive(contacts->scenario, driven, &others, &force);
        space_joints_hold(&stride->joints, (size_t)linkage->driver.joint, force);
    }
    for (size_t i = 0; i < linkage->joint_count; i++) {
        stride->impulse[i] = stride->joints.plane[i].force * step_s;
    }
    space_contacts_impulses(contacts, step_s, stride->impulse);
    stride->energy = space_contacts_energy(contacts);
    const ContactEnergy ends = space_stops_energy(stops);
    stride->energy.dissipated += ends.dissipated;
    stride->energy.elastic += ends.elastic;
}
