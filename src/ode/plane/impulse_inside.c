// Finds the state of a planar linkage at a time inside a step of the world.
//
//     v(t) = v + a_f t + A P(t),  q(t) = q + v t + a_f t^2 / 2 + A Q(t)
// as ode/plane/impulse_step.c has it. Accelerations: those beside the contacts', linear in time
// from the means of the last two steps, and A f(t). Ideal joints: the mean forces of the step, and
// how the joints answer what the contacts do beyond theirs.
#include "ode/plane/impulse_step.h"

#include "kernel/internal.h"

#include <string.h>

// What impulses in the rows of play do to the speeds of an island's bodies.
static void push_scope(const ImpulseStep *step, const ImpulseScope *scope, const double *impulses,
                       double *changes)
{
    for (size_t n = 0; n < scope->body_count; n++) {
        memset(changes + 3 * scope->bodies[n], 0, 3 * sizeof *changes);
    }
    response_groups_apply(&step->response, &step->groups, &scope->part, impulses, changes);
}

// What the contacts have done to the speeds and the positions of a scope's bodies up to a time.
static void push_bodies(const ImpulseStep *step, const ImpulseScope *scope, double since_s,
                        const KernelSums *sums, double *speeds, double *positions)
{
    if (scope->is_whole) {
        kernel_step_push(&step->scheme, since_s, sums, speeds, positions);
        return;
    }
    push_scope(step, scope, sums->impulse, speeds);
    push_scope(step, scope, sums->moment, positions);
}

// How the bodies move at a time within the step, from the contacts' sums up to then.
static void find_motions(const ImpulseStep *step, const ImpulseScope *scope, double since_s,
                         const KernelSums *sums, Motion *motions)
{
    if (since_s == step->scheme.width_s && scope->is_whole) {
        memcpy(motions, step->after, step->scenario->linkage.body_count * sizeof *motions);
        return;
    }
    double *speeds = step->work->changes[0];
    double *positions = step->work->changes[1];
    push_bodies(step, scope, since_s, sums, speeds, positions);
    const KernelStepTime at = kernel_step_time(&step->scheme, since_s);
    for (size_t n = 0; n < scope->body_count; n++) {
        const size_t i = scope->bodies[n];
        const Motion *first = &step->before[i];
        const double v[3] = {first->velocity.x, first->velocity.y, first->omega};
        double q[3] = {first->position.x, first->position.y, first->angle};
        double w[3];
        for (size_t k = 0; k < 3; k++) {
            const size_t c = 3 * i + k;
            w[k] = kernel_step_speed(&step->scheme, c, at, v[k], speeds[c]);
            q[k] += kernel_step_way(&step->scheme, c, at, v[k], positions[c]);
        }
        motions[i] = (Motion){
            .position = {q[0], q[1]}, .angle = q[2], .velocity = {w[0], w[1]}, .omega = w[2]};
    }
    if (scope->has_drive) {
        impulse_step_place_driven(step, step->scheme.start_s + since_s, motions);
    }
}

// The same and the accelerations, from the curves of a step of few rows.
static void follow_curves(const ImpulseStep *step, double since_s, const KernelSums *sums,
                          Motion *motions)
{
    impulse_curves_at(&step->curves, since_s, sums, motions);
    impulse_step_place_driven(step, step->scheme.start_s + since_s, motions);
    for (size_t i = 0; since_s == step->scheme.width_s && i < step->scenario->linkage.body_count;
         i++) {
        const Motion *after = &step->after[i];
        motions[i].position = after->position;
        motions[i].angle = after->angle;
        motions[i].velocity = after->velocity;
        motions[i].omega = after->omega;
    }
}

// What the contacts' forces do to all speeds, by the response where the bodies are, at a peak, or
// at mid-step.
static void find_contact_rates(const ImpulseStep *step, const ImpulseScope *scope, bool is_peak,
                               const KernelSums *sums, const Motion *motions, double *rates)
{
    if (!scope->is_whole) {
        push_scope(step, scope, sums->force, rates);
        return;
    }
    const bool is_placed = is_peak && response_place(&step->work->there, motions);
    response_apply(is_placed ? &step->work->there : &step->response, sums->force, rates);
}

// Adds to the contacts' accelerations those beside them, linear in time.
static void add_free(const ImpulseStep *step, size_t body, double off_middle_s, const double *rates,
                     Motion *motion)
{
    const size_t first = 3 * body;
    const double *pressed = rates + first;
    motion->acceleration =
        (Vec2){pressed[0] + kernel_step_beside(&step->scheme, first, off_middle_s),
               pressed[1] + kernel_step_beside(&step->scheme, first + 1, off_middle_s)};
    motion->alpha = pressed[2] + kernel_step_beside(&step->scheme, first + 2, off_middle_s);
}

// Fills in the accelerations.
static void find_accelerations(const ImpulseStep *step, const ImpulseScope *scope, double since_s,
                               bool is_peak, const KernelSums *sums, Motion *motions)
{
    double *rates = step->work->changes[0];
    const double off_middle_s = since_s - 0.5 * step->scheme.width_s;
    find_contact_rates(step, scope, is_peak, sums, motions, rates);
    for (size_t n = 0; n < scope->body_count; n++) {
        const size_t i = scope->bodies[n];
        if (impulse_step_is_free(step, i)) {
            add_free(step, i, off_middle_s, rates, &motions[i]);
        }
    }
}

// Those of the placed groups, by the response where the bodies are.
static void find_some_accelerations(const ImpulseStep *step, const ImpulseScope *scope,
                                    double since_s, const KernelSums *sums, Motion *motions)
{
    const ResponseGroups *groups = &step->groups;
    double *rates = step->work->changes[0];
    const double off_middle_s = since_s - 0.5 * step->scheme.width_s;
    const bool is_placed =
        response_groups_place(&step->work->there, groups, &scope->placed, motions);
    response_groups_apply(is_placed ? &step->work->there : &step->response, groups, &scope->placed,
                          sums->force, rates);
    for (size_t n = 0; n < scope->placed.group_count; n++) {
        const size_t group = scope->placed.groups[n];
        for (size_t b = groups->first_body[group]; b < groups->first_body[group + 1]; b++) {
            const size_t i = groups->bodies[b];
            add_free(step, i, off_middle_s, rates, &motions[i]);
        }
    }
}

// Where the block of a joint is between its guides, or body b of a stop at a line.
static JointState place_on_line(const Linkage *linkage, const Motion *motions, int joint)
{
    JointState state = {.gap = INFINITY};
    if (joint_has_guides(linkage->joints[joint].kind)) {
        stepping_observe_line(linkage, joint, motions, &state);
    } else {
        state.eccentricity = linkage_joint_gap(linkage, motions, joint).position;
    }
    return state;
}

void impulse_step_add_end(const Linkage *linkage, const Touch *place, double pressing,
                          const Motion *motions, JointState *state)
{
    state->force += pressing;
    if (touch_is_torque(place)) {
        const double sense = coordinate_sense(&linkage->joints[place->joint]);
        state->moment_on_b += sense * place->sign * pressing;
        return;
    }
    const TouchPose pose = touch_pose(linkage, place, motions);
    const Vec2 force = vec2_scale(pressing, pose.normal);
    Vec2 arms[2];
    touch_points(place, &pose, &arms[0], &arms[1]);
    state->force_on_b = vec2_add(state->force_on_b, force);
    state->moment_on_b += vec2_cross(arms[1], force);
}

Vec2 impulse_step_from_slot(const Linkage *linkage, const Touch *place, const Motion *motions,
                            Vec2 in_rows)
{
    const Vec2 across = touch_across(linkage, place, motions);
    return vec2_add(vec2_scale(in_rows.x, across), vec2_scale(in_rows.y, vec2_perp(across)));
}

// Adds one place at an end of a coordinate to the state of its joint, which has what holds the
// joint beside it.
static void add_end(const Linkage *linkage, const Touch *place, const KernelPose *pose,
                    bool is_first, const Motion *motions, JointState *state)
{
    if (is_first) {
        state->gap = INFINITY;
        state->force = 0.0;
        state->is_touching = false;
    }
    state->gap = fmin(state->gap, pose->pose.gap);
    state->is_touching = state->is_touching || pose->is_touching;
    impulse_step_add_end(linkage, place, pose->force.x, motions, state);
}

// Adds one place at a line to the state of its joint.
static void add_line(const Linkage *linkage, const Touch *place, const KernelPose *pose,
                     const Motion *motions, JointState *state)
{
    const Joint *joint = &linkage->joints[place->joint];
    const Vec2 normal = touch_pose(linkage, place, motions).normal;
    const Vec2 force =
        vec2_add(vec2_scale(pose->force.x, normal), vec2_scale(pose->force.y, vec2_perp(normal)));
    state->gap = fmin(state->gap, pose->pose.gap);
    state->force_on_b = vec2_add(state->force_on_b, force);
    state->force += vec2_length(force);
    state->is_touching = state->is_touching || pose->is_touching;
    if (joint_has_guides(joint->kind)) {
        const Vec2 arm = vec2_sub(linkage_point(motions, joint->body_b, place->anchor_b),
                                  linkage_point(motions, joint->body_b, joint->anchor_b));
        state->moment_on_b += vec2_cross(arm, force);
    }
}

// How a place is, and what presses there.
static KernelPose look_at_place(const ImpulseStep *step, size_t place, ImpulseTime at,
                                const KernelSums *sums)
{
    const Kernel *kernel = &step->scheme.kernel;
    if (!impulse_step_has_curves(step)) {
        return impulse_scope_pose(kernel, step->scheme.islands, place, at, sums);
    }
    const size_t row = kernel->contacts[place].first_row;
    double position[2];
    double speed[2];
    impulse_curves_place_at(&step->curves, place, at.since_s, sums, position, speed);
    return (KernelPose){
        .pose = kernel_motion_pose_of(kernel, place, position, speed),
        .force = {sums->force[row], sums->force[row + 1]},
        .is_touching = kernel_touches(kernel, at.node, place),
    };
}

// The states of the joints with play, and how deep each place is.
static void find_places(const ImpulseStep *step, const ImpulseScope *scope, ImpulseTime at,
                        const KernelSums *sums, const Motion *motions, JointState *joints,
                        double *depths)
{
    const Linkage *linkage = &step->scenario->linkage;
    for (size_t n = 0; n < scope->place_count; n++) {
        const size_t i = scope->part.places[n];
        const Touch *place = &step->places[i];
        if (i >= step->touch_count) {
            const size_t row = step->scheme.kernel.contacts[i].first_row;
            depths[i] = 0.0;
            impulse_rubs_add(linkage, place, sums->force[row], motions, &joints[place->joint]);
            continue;
        }
        const KernelPose pose = look_at_place(step, i, at, sums);
        depths[i] = pose.pose.penetration;
        if (linkage->joints[place->joint].limits.kind != LIMIT_NONE) {
            const bool is_first = i == 0 || step->places[i - 1].joint != place->joint;
            add_end(linkage, place, &pose, is_first, motions, &joints[place->joint]);
            continue;
        }
        if (!touch_is_scalar(place)) {
            const bool is_slot = touch_has_walls(place);
            joints[place->joint] = (JointState){
                .eccentricity = is_slot ? linkage_joint_gap(linkage, motions, place->joint).position
                                        : pose.pose.eccentricity,
                .gap = pose.pose.gap,
                .force_on_b = is_slot ? impulse_step_from_slot(linkage, place, motions, pose.force)
                                      : pose.force,
                .force = vec2_length(pose.force),
                .is_touching = pose.is_touching,
            };
            continue;
        }
        if (place->place == 0) {
            joints[place->joint] = place_on_line(linkage, motions, place->joint);
        }
        add_line(linkage, place, &pose, motions, &joints[place->joint]);
    }
}

// What the ideal joints do beside their mean forces: they answer what the contacts do beyond
// theirs.
static void add_answers(const ImpulseStep *step, const KernelSums *sums, const Motion *motions,
                        JointState *joints)
{
    double *beyond = step->work->rows[0];
    double *reactions = step->work->rows[1];
    for (size_t i = 0; i < kernel_rows(&step->scheme.kernel); i++) {
        beyond[i] = sums->force[i] - step->scheme.pressing[i];
    }
    response_react(&step->response, beyond, reactions);
    for (size_t row = 0; row < step->response.ideal_rows; row += 2) {
        impulse_step_add_ideal(step, row, reactions + row, motions,
                               &joints[step->response.joint_of[row]]);
    }
}

// The same of few rows, of which it is known what each is answered with.
static void add_few_answers(const ImpulseStep *step, const KernelSums *sums, const Motion *motions,
                            JointState *joints)
{
    const size_t rows = kernel_rows(&step->scheme.kernel);
    double beyond[IMPULSE_FEW_ROWS];
    for (size_t i = 0; i < rows; i++) {
        beyond[i] = sums->force[i] - step->scheme.pressing[i];
    }
    for (size_t row = 0; row < step->response.ideal_rows; row += 2) {
        const double *answer = step->drift.answers + row;
        double reaction[2] = {0.0, 0.0};
        for (size_t i = 0; i < rows; i++) {
            reaction[0] += answer[0] * beyond[i];
            reaction[1] += answer[1] * beyond[i];
            answer += step->response.row_count;
        }
        impulse_step_add_ideal(step, row, reaction, motions, &joints[step->response.joint_of[row]]);
    }
}

// The same of the joints that hold the groups of an island.
static void add_island_answers(const ImpulseStep *step, const ImpulseScope *scope,
                               const KernelSums *sums, const Motion *motions, JointState *joints)
{
    const Kernel *kernel = &step->scheme.kernel;
    double *beyond = step->work->rows[0];
    for (size_t n = 0; n < scope->part.place_count; n++) {
        const KernelContact *joint = &kernel->contacts[scope->part.places[n]];
        for (size_t i = joint->first_row; i < joint->first_row + joint->row_count; i++) {
            beyond[i] = sums->force[i] - step->scheme.pressing[i];
        }
    }
    const ResponseGroups *groups = &step->groups;
    const double *all = response_groups_apply(&step->response, groups, &scope->part, beyond,
                                              step->work->changes[0]);
    for (size_t n = 0; n < scope->part.group_count; n++) {
        const size_t group = scope->part.groups[n];
        for (size_t k = groups->first_node[group]; k < groups->first_node[group + 1]; k++) {
            const size_t row = 2 * groups->nodes[k];
            impulse_step_add_ideal(step, row, all + row, motions,
                                   &joints[step->response.joint_of[row]]);
        }
    }
}

static void find_ideal(const ImpulseStep *step, const ImpulseScope *scope, const KernelSums *sums,
                       const Motion *motions, JointState *joints)
{
    if (step->scheme.has_drift) {
        add_few_answers(step, sums, motions, joints);
    } else if (scope->is_whole) {
        add_answers(step, sums, motions, joints);
    } else {
        add_island_answers(step, scope, sums, motions, joints);
    }
}

// What the ideal joints do otherwise so many s after mid-step.
static void add_hold_rates(const ImpulseStep *step, double off_middle_s, JointState *joints)
{
    const Response *response = &step->response;
    for (size_t row = 0; row < response->ideal_rows; row += 2) {
        const ImpulseHold *rate = &step->hold_rate[response->joint_of[row]];
        JointState *state = &joints[response->joint_of[row]];
        state->force_on_b = vec2_add(state->force_on_b, vec2_scale(off_middle_s, rate->force));
        state->moment_on_b += off_middle_s * rate->moment;
    }
}

// The states of the joints at a time within the step, but for that of the drive.
static void find_joints(const ImpulseStep *step, const ImpulseScope *scope, ImpulseTime at,
                        const KernelSums *sums, const Motion *motions, JointState *joints,
                        double *depths)
{
    const Linkage *linkage = &step->scenario->linkage;
    if (scope->is_whole) {
        memcpy(joints, step->mean, linkage->joint_count * sizeof *joints);
    }
    for (size_t n = 0; !scope->is_whole && n < scope->joint_count; n++) {
        joints[scope->joints[n]] = step->mean[scope->joints[n]];
    }
    if (step->scheme.has_drift) {
        add_hold_rates(step, at.since_s - 0.5 * step->scheme.width_s, joints);
    }
    find_places(step, scope, at, sums, motions, joints, depths);
    find_ideal(step, scope, sums, motions, joints);
    for (size_t n = 0; step->has_coordinates && n < scope->joint_count; n++) {
        const size_t i = scope->joints[n];
        if (joint_has_position(linkage->joints[i].kind)) {
            stepping_observe_line(linkage, (int)i, motions, &joints[i]);
        }
        stepping_observe_coordinate(linkage, (int)i, motions, &joints[i]);
    }
}

// Those of the drives, which answer all the others on their bodies.
static void find_drives(const ImpulseStep *step, const Motion *motions, JointState *joints)
{
    const Linkage *linkage = &step->scenario->linkage;
    for (size_t i = 0; i < linkage_drive_count(linkage); i++) {
        const int body = linkage_drive_body(linkage, i);
        const BodyLoad load = applied_on(&step->world.applied, body);
        stepping_drive_force(step->scenario, i, &motions[body], &load, joints);
        impulse_rubs_add_driven(step->scenario, i, &motions[body], joints);
    }
}

void impulse_step_inside(const ImpulseStep *step, const ImpulseScope *scope, ImpulseTime at,
                         const KernelSums *sums, Motion *motions, JointState *joints,
                         double *depths)
{
    if (impulse_step_has_curves(step)) {
        follow_curves(step, at.since_s, sums, motions);
    } else {
        find_motions(step, scope, at.since_s, sums, motions);
        find_accelerations(step, scope, at.since_s, at.is_peak, sums, motions);
    }
    find_joints(step, scope, at, sums, motions, joints, depths);
    if (scope->has_drive) {
        find_drives(step, motions, joints);
    }
}

void impulse_step_inside_some(const ImpulseStep *step, const ImpulseScope *scope, ImpulseTime at,
                              const KernelSums *sums, Motion *motions, JointState *joints,
                              double *depths)
{
    find_motions(step, scope, at.since_s, sums, motions);
    if (scope->placed.group_count > 0) {
        find_some_accelerations(step, scope, at.since_s, sums, motions);
    }
    if (joints != NULL) {
        find_joints(step, scope, at, sums, motions, joints, depths);
    }
}
