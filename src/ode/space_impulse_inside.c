// What is the state at a time inside a step of the world in space?
//
// As ode/impulse_inside.c has it; a body has turned since the start of the step by the vector
//     theta(t) = omega t + a t^2 / 2 + A Q(t)
// which is right to the order of the step, and ends where the step does.
#include "ode/space_impulse_step.h"

#include <string.h>

// How far or how fast one part of a body's motion goes.
static Vec3 moved_by(double since_s, double share, Vec3 speed, Vec3 mean, Vec3 pushed, Vec3 rest)
{
    const Vec3 coasted = vec3_scale(since_s, vec3_add(speed, vec3_scale(0.5 * since_s, mean)));
    return vec3_add(vec3_add(coasted, pushed), vec3_scale(share * share, rest));
}

// How the bodies move at a time within the step, from the contacts' sums up to then.
static void find_motions(const SpaceImpulseStep *step, double since_s, const EncounterSums *sums,
                         SpaceMotion *motions)
{
    const Linkage *linkage = &step->scenario->linkage;
    const double share = since_s / step->width_s;
    SpaceChange *speeds = step->changes[0];
    SpaceChange *places = step->changes[1];
    space_response_apply(step->response, sums->impulse, speeds);
    space_response_apply(step->response, sums->moment, places);
    for (size_t i = 0; i < linkage->body_count; i++) {
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
    if (step->driven >= 0) {
        motions[step->driven] = space_driven(linkage, step->start_s + since_s);
    }
}

// Takes the response where the bodies are, with the rows along the directions of mid-step.
static bool place_there(const SpaceImpulseStep *step, const SpaceMotion *motions)
{
    SpaceRow *rows = step->play_rows;
    for (size_t i = 0; i < step->place_count; i++) {
        PinSpaceRows moved = step->rows[i];
        pin_space_rows_move(&step->places[i], motions, &moved);
        memcpy(rows + step->encounter.joints[i].first_row, moved.rows, moved.count * sizeof *rows);
    }
    return space_response_place(step->there, motions, rows);
}

// Fills in the accelerations: those beside the contacts', linear in time, and the contacts'.
static void find_accelerations(const SpaceImpulseStep *step, const SpaceResponse *response,
                               double since_s, const EncounterSums *sums, SpaceMotion *motions)
{
    SpaceChange *rates = step->changes[0];
    const double off_middle_s = since_s - 0.5 * step->width_s;
    space_response_apply(response, sums->force, rates);
    for (size_t i = 0; i < step->scenario->linkage.body_count; i++) {
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

// The states of the joints with play, from the encounter.
static void find_pins(const SpaceImpulseStep *step, size_t node, double since_s,
                      const EncounterSums *sums, SpaceJoints *joints)
{
    for (size_t i = 0; i < step->place_count; i++) {
        const PinSpace *place = &step->places[i];
        const PinSpaceRows *rows = &step->rows[i];
        JointState *plane = &joints->plane[place->joint];
        SpaceJointState *space = &joints->space[place->joint];
        const EncounterPose pose = encounter_pose(&step->encounter, i, node, since_s, sums);
        Vec3 force = in_world(rows, pose.force);
        if (place->place == PIN_SPACE_COLLAR) {
            space_joints_press(joints, place, force, rows->across[0]);
            continue;
        }
        if (rows->count == PIN_SPACE_ROWS) {
            const double axial = sums->force[step->encounter.joints[i].first_row + 4];
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

// The forces of the ideal joints and of the drive: the means of the step, and how the joints answer
// what the contacts do beyond theirs.
static void find_forces(const SpaceImpulseStep *step, const EncounterSums *sums,
                        const SpaceMotion *motions, SpaceJoints *joints)
{
    const Linkage *linkage = &step->scenario->linkage;
    double *beyond = step->play[0];
    double *reactions = step->ideal[0];
    Vec3 *forces = step->forces;
    memcpy(forces, step->mean, linkage->joint_count * sizeof *forces);
    for (size_t i = 0; i < encounter_rows(&step->encounter); i++) {
        beyond[i] = sums->force[i] - step->total.impulse[i] / step->width_s;
    }
    space_response_react(step->response, beyond, reactions);
    space_response_add_forces(step->response, reactions, forces);
    for (size_t i = 0; i < linkage->joint_count; i++) {
        if (linkage_is_ideal(linkage, i)) {
            space_joints_hold(joints, i, forces[i]);
        }
    }
    if (step->driven >= 0) {
        SpaceChange *loads = step->changes[0];
        space_response_load(step->response, sums->force, loads);
        SpaceChange *others = &loads[step->driven];
        others->move = vec3_add(others->move, step->on_driven.move);
        others->turn = vec3_add(others->turn, step->on_driven.turn);
        space_response_add_reactions(step->response, reactions, step->driven, others);
        Vec3 force;
        space_joints_drive(step->scenario, &motions[step->driven], others, &force);
        space_joints_hold(joints, (size_t)linkage->driver.joint, force);
    }
}

void space_impulse_step_inside(const SpaceImpulseStep *step, size_t node, double since_s,
                               bool is_peak, const EncounterSums *sums, SpaceMotion *motions,
                               SpaceJoints *joints)
{
    find_motions(step, since_s, sums, motions);
    const bool is_placed = is_peak && place_there(step, motions);
    find_accelerations(step, is_placed ? step->there : step->response, since_s, sums, motions);
    space_joints_clear(&step->scenario->linkage, joints);
    space_joints_place(step->response, motions, joints->plane, joints->space);
    find_pins(step, node, since_s, sums, joints);
    find_forces(step, sums, motions, joints);
}
