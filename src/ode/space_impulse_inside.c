// What is the state at a time inside a step of the world in space?
//
// As ode/plane/impulse_inside.c has it; a body has turned since the start of the step by the vector
//     theta(t) = omega t + a t^2 / 2 + A Q(t)
// which is right to the order of the step, and ends where the step does.
#include "ode/space_impulse_step.h"

#include <math.h>
#include <string.h>

// How far or how fast one part of a body's motion goes.
static Vec3 moved_by(double since_s, double share, Vec3 speed, Vec3 mean, Vec3 pushed, Vec3 rest)
{
    const Vec3 coasted = vec3_scale(since_s, vec3_add(speed, vec3_scale(0.5 * since_s, mean)));
    return vec3_add(vec3_add(coasted, pushed), vec3_scale(share * share, rest));
}

// What impulses in the rows of play do to the speeds of a scope's bodies.
static void apply(const SpaceImpulseStep *step, const ImpulseScope *scope, const double *impulses,
                  SpaceChange *changes)
{
    if (scope->is_whole) {
        space_response_apply(step->response, impulses, changes);
        return;
    }
    for (size_t n = 0; n < scope->body_count; n++) {
        changes[scope->bodies[n]] = (SpaceChange){{0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}};
    }
    space_response_groups_apply(step->response, &step->groups, &scope->part, impulses, changes);
}

// How the bodies move at a time within the step, from the contacts' sums up to then.
static void find_motions(const SpaceImpulseStep *step, const ImpulseScope *scope, double since_s,
                         const KernelSums *sums, SpaceMotion *motions)
{
    const Linkage *linkage = &step->scenario->linkage;
    const double share = since_s / step->width_s;
    SpaceChange *speeds = step->changes[0];
    SpaceChange *places = step->changes[1];
    apply(step, scope, sums->impulse, speeds);
    apply(step, scope, sums->moment, places);
    for (size_t n = 0; n < scope->body_count; n++) {
        const size_t i = scope->bodies[n];
        const SpaceMotion *first = &step->before[i];
        const SpaceChange *free = &step->free[i];
        const SpaceChange *rest = &step->rest[i];
        const SpaceChange place = {
            moved_by(since_s, share, first->velocity, free->move, places[i].move, rest->move),
            moved_by(since_s, share, first->omega, free->turn, places[i].turn, rest->turn)};
        const SpaceChange speed = {vec3_add(speeds[i].move, vec3_scale(since_s, free->move)),
                                   vec3_add(speeds[i].turn, vec3_scale(since_s, free->turn))};
        motions[i] = *first;
        space_change(&motions[i], &place, &speed);
        motions[i].acceleration = motions[i].alpha = (Vec3){0.0, 0.0, 0.0};
    }
    if (scope->has_drive) {
        motions[step->driven] = space_driven(linkage, step->start_s + since_s);
    }
}

// Takes the response where the bodies are, with the rows along the directions of mid-step.
static bool place_there(const SpaceImpulseStep *step, const SpaceMotion *motions)
{
    SpaceRow *rows = step->play_rows;
    for (size_t i = 0; i < step->place_count; i++) {
        const StopSpace *stop = space_impulse_step_stop(step, i);
        PinSpaceRows moved = step->rows[i];
        if (stop != NULL) {
            moved.rows[0] = stop_space_row(stop, &step->scenario->linkage, motions);
        } else {
            pin_space_rows_move(&step->places[i], motions, &moved);
        }
        memcpy(rows + step->kernel.contacts[i].first_row, moved.rows, moved.count * sizeof *rows);
    }
    return space_response_place(step->there, motions, rows);
}

// Fills in the accelerations: those beside the contacts', linear in time, and the contacts'. At a
// peak the response is taken where the bodies are; else, and of an island, at mid-step.
static void find_accelerations(const SpaceImpulseStep *step, const ImpulseScope *scope,
                               double since_s, bool is_peak, const KernelSums *sums,
                               SpaceMotion *motions)
{
    SpaceChange *rates = step->changes[0];
    const double off_middle_s = since_s - 0.5 * step->width_s;
    if (scope->is_whole && is_peak && place_there(step, motions)) {
        space_response_apply(step->there, sums->force, rates);
    } else {
        apply(step, scope, sums->force, rates);
    }
    for (size_t n = 0; n < scope->body_count; n++) {
        const size_t i = scope->bodies[n];
        if (space_impulse_step_is_free(step, i)) {
            const SpaceChange *free = &step->free[i];
            const SpaceChange *rate = &step->free_rate[i];
            motions[i].acceleration =
                vec3_add(rates[i].move, vec3_add(free->move, vec3_scale(off_middle_s, rate->move)));
            motions[i].alpha =
                vec3_add(rates[i].turn, vec3_add(free->turn, vec3_scale(off_middle_s, rate->turn)));
        }
    }
}

static Vec3 in_world(const PinSpaceRows *rows, Vec2 a)
{
    return vec3_add(vec3_scale(a.x, rows->across[0]), vec3_scale(a.y, rows->across[1]));
}

// The states of the joints with play, from the kernel.
static void find_pins(const SpaceImpulseStep *step, const ImpulseScope *scope, ImpulseTime at,
                      const KernelSums *sums, SpaceJoints *joints)
{
    for (size_t n = 0; n < scope->place_count; n++) {
        const size_t i = scope->part.places[n];
        if (i >= step->pin_count) {
            continue;
        }
        const PinSpace *place = &step->places[i];
        const PinSpaceRows *rows = &step->rows[i];
        JointState *plane = &joints->plane[place->joint];
        SpaceJointState *space = &joints->space[place->joint];
        const KernelPose pose = impulse_scope_pose(&step->kernel, step->islands, i, at, sums);
        Vec3 force = in_world(rows, pose.force);
        if (place->place == PIN_SPACE_COLLAR) {
            space_joints_press(joints, place, force, rows->across[0]);
            continue;
        }
        if (rows->count == PIN_SPACE_ROWS) {
            const double axial = sums->force[step->kernel.contacts[i].first_row + 4];
            force = vec3_add(force, vec3_scale(axial, rows->axis));
        }
        plane->is_touching = (place->place > 0 && plane->is_touching) || pose.is_touching;
        space->end_gaps[place->place] = pose.pose.gap;
        space->ends[place->place] = in_world(rows, pose.pose.eccentricity);
        space_joints_press(joints, place, force, rows->axis);
        if (place->place == 1) {
            // the middle of the pin's axis lies between its ends
            const Vec3 between = vec3_scale(0.5, vec3_add(space->ends[0], space->ends[1]));
            const Vec3 axial = vec3_scale(vec3_dot(space->offset, rows->axis), rows->axis);
            space->offset = vec3_add(between, axial);
            plane->eccentricity = (Vec2){space->offset.x, space->offset.y};
            plane->gap = fmin(space->end_gaps[0], space->end_gaps[1]);
        }
    }
}

// The states of limited joints: what presses at their ends, for what holds them beside is not told
// of them.
static void find_stops(const SpaceImpulseStep *step, const ImpulseScope *scope, ImpulseTime at,
                       const KernelSums *sums, SpaceJoints *joints)
{
    const Linkage *linkage = &step->scenario->linkage;
    for (size_t n = 0; n < scope->place_count; n++) {
        const size_t i = scope->part.places[n];
        const StopSpace *stop = space_impulse_step_stop(step, i);
        if (stop == NULL) {
            continue;
        }
        const KernelPose pose = impulse_scope_pose(&step->kernel, step->islands, i, at, sums);
        JointState *state = &joints->plane[stop->joint];
        if (i == step->pin_count || stop[-1].joint != stop->joint) {
            state->gap = INFINITY;
            state->force = 0.0;
            state->is_touching = false;
        }
        state->gap = fmin(state->gap, pose.pose.gap);
        state->is_touching = state->is_touching || pose.is_touching;
        state->force += pose.force.x;
        state->moment_on_b +=
            coordinate_sense(&linkage->joints[stop->joint]) * stop->sign * pose.force.x;
    }
}

// How the ideal joints of an island answer what its contacts do beyond their means.
static void add_answers(const SpaceImpulseStep *step, const ImpulseScope *scope,
                        const KernelSums *sums, Vec3 *forces)
{
    const SpaceResponse *response = step->response;
    const ResponseGroups *groups = &step->groups;
    double *beyond = step->play[0];
    for (size_t n = 0; n < scope->part.place_count; n++) {
        const KernelContact *joint = &step->kernel.contacts[scope->part.places[n]];
        for (size_t i = joint->first_row; i < joint->first_row + joint->row_count; i++) {
            beyond[i] = sums->force[i] - step->total.impulse[i] / step->width_s;
        }
    }
    const double *all =
        space_response_groups_apply(response, groups, &scope->part, beyond, step->changes[0]);
    for (size_t n = 0; n < scope->part.group_count; n++) {
        const size_t group = scope->part.groups[n];
        for (size_t k = groups->first_node[group]; k < groups->first_node[group + 1]; k++) {
            const size_t *row = response->matrix.first_row + groups->nodes[k];
            for (size_t i = row[0]; i < row[1]; i++) {
                space_response_add_force(response, i, all[i], forces);
            }
        }
    }
}

// The force of the drive: what the ideal joints' answer and the contacts leave to it.
static void find_drive(const SpaceImpulseStep *step, const KernelSums *sums,
                       const double *reactions, const SpaceMotion *motions, SpaceJoints *joints)
{
    SpaceChange *loads = step->changes[0];
    space_response_load(step->response, sums->force, loads);
    SpaceChange *others = &loads[step->driven];
    others->move = vec3_add(others->move, step->on_driven.move);
    others->turn = vec3_add(others->turn, step->on_driven.turn);
    space_response_add_reactions(step->response, reactions, step->driven, others);
    Vec3 force;
    space_joints_drive(step->scenario, &motions[step->driven], others, &force);
    space_joints_hold(joints, (size_t)step->scenario->linkage.driver.joint, force);
}

// The forces of the ideal joints and of the drive: the means of the step, and how the joints answer
// what the contacts do beyond theirs. That of the drive hangs on all of them.
static void find_forces(const SpaceImpulseStep *step, const ImpulseScope *scope,
                        const KernelSums *sums, const SpaceMotion *motions, SpaceJoints *joints)
{
    const Linkage *linkage = &step->scenario->linkage;
    double *beyond = step->play[0];
    double *reactions = step->ideal[0];
    Vec3 *forces = step->forces;
    const bool is_of_all = scope->is_whole || scope->has_drive;
    if (is_of_all) {
        memcpy(forces, step->mean, linkage->joint_count * sizeof *forces);
        for (size_t i = 0; i < kernel_rows(&step->kernel); i++) {
            beyond[i] = sums->force[i] - step->total.impulse[i] / step->width_s;
        }
        space_response_react(step->response, beyond, reactions);
        space_response_add_forces(step->response, reactions, forces);
    } else {
        for (size_t n = 0; n < scope->joint_count; n++) {
            forces[scope->joints[n]] = step->mean[scope->joints[n]];
        }
        add_answers(step, scope, sums, forces);
    }
    for (size_t n = 0; n < scope->joint_count; n++) {
        if (linkage_is_ideal(linkage, scope->joints[n])) {
            space_joints_hold(joints, scope->joints[n], forces[scope->joints[n]]);
        }
    }
    if (scope->has_drive) {
        find_drive(step, sums, reactions, motions, joints);
    }
}

void space_impulse_step_inside(const SpaceImpulseStep *step, const ImpulseScope *scope,
                               ImpulseTime at, const KernelSums *sums, SpaceMotion *motions,
                               SpaceJoints *joints)
{
    find_motions(step, scope, at.since_s, sums, motions);
    find_accelerations(step, scope, at.since_s, at.is_peak, sums, motions);
    for (size_t n = 0; n < scope->joint_count; n++) {
        space_joints_clear_one(joints, scope->joints[n]);
        // which of the angles that differ by turns
        joints->plane[scope->joints[n]].tilt = step->angles[scope->joints[n]];
        space_joints_place_one(step->response, motions, scope->joints[n], joints);
    }
    find_pins(step, scope, at, sums, joints);
    find_forces(step, scope, sums, motions, joints);
    find_stops(step, scope, at, sums, joints);
}
