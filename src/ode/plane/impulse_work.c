// Finds the mean forces of the joints with play in a step, and the work of the drives.
//
// The mean forces of the step do theirs at the speeds of mid-step. With P a place's impulse and Q
// its integral, its force does beyond that (h/2 P - Q) times the rate at which the speed of a
// driven body changes along the row. Of a pin that is the acceleration of its point; of a line or a
// rack with directions e, which turn with body a, and touching point X,
//     (e . v(X))' = e' . v(X) + e . (acc(X) + w perp (X' - v(X)))
#include "ode/plane/impulse_step.h"

#include "model/joint_rows.h"
#include "model/loads.h"

#include <string.h>

// The acceleration of a point of a driven body, by its arm from the centre.
static Vec2 arm_acceleration(const Motion *driven, Vec2 arm)
{
    const Vec2 steady =
        vec2_sub(driven->acceleration, vec2_scale(driven->omega * driven->omega, arm));
    return driven->alpha == 0.0 ? steady
                                : vec2_add(steady, vec2_scale(driven->alpha, vec2_perp(arm)));
}

// Adds the mean force of a place to that of its joint, with its moment about the anchor of body b
// where it does not act there.
static void add_mean(const ImpulseStep *step, size_t number, const Motion *middle, JointState *mean)
{
    const Touch *place = &step->places[number];
    const double *sum = step->scheme.total.impulse + step->scheme.kernel.contacts[number].first_row;
    const Vec2 force = {sum[0] / step->scheme.width_s, sum[1] / step->scheme.width_s};
    if (number >= step->touch_count) {
        impulse_rubs_add(&step->scenario->linkage, place, force.x, middle, mean);
        return;
    }
    if (step->scenario->linkage.joints[place->joint].limits.kind != LIMIT_NONE) {
        impulse_step_add_end(&step->scenario->linkage, place, force.x, middle, mean);
        return;
    }
    const Linkage *linkage = &step->scenario->linkage;
    if (!touch_is_scalar(place)) {
        mean->force_on_b =
            touch_has_walls(place) ? impulse_step_from_slot(linkage, place, middle, force) : force;
        return;
    }
    const Joint *joint = &linkage->joints[place->joint];
    const TouchPose pose = touch_pose(linkage, place, middle);
    const Vec2 push =
        vec2_add(vec2_scale(force.x, pose.normal), vec2_scale(force.y, vec2_perp(pose.normal)));
    Vec2 from_a;
    Vec2 from_b;
    touch_points(place, &pose, &from_a, &from_b);
    const Vec2 arm = vec2_add(vec2_sub(linkage_point(middle, joint->body_b, place->anchor_b),
                                       linkage_point(middle, joint->body_b, joint->anchor_b)),
                              from_b);
    mean->force_on_b = vec2_add(mean->force_on_b, push);
    mean->moment_on_b += vec2_cross(arm, push);
}

// The mean forces of the joints with play.
static void find_play_means(ImpulseStep *step, const Motion *middle)
{
    const Linkage *linkage = &step->scenario->linkage;
    JointState *means = step->work->joints;
    memcpy(means, step->mean, linkage->joint_count * sizeof *means);
    for (size_t i = 0; i < step->touch_count; i++) {
        const int joint = step->places[i].joint;
        // what holds a joint beside its limited coordinate is known
        if (linkage->joints[joint].limits.kind == LIMIT_NONE) {
            means[joint] = (JointState){.force = 0.0};
        }
    }
    for (size_t i = 0; i < step->place_count; i++) {
        add_mean(step, i, middle, &means[step->places[i].joint]);
    }
}

// Where they act on a driven body, seen from its anchors: at the anchor of body b, of all joints
// with lines and slots.
static void find_driven_offsets(ImpulseStep *step, const Motion *middle, int body, Vec2 *offsets)
{
    const Linkage *linkage = &step->scenario->linkage;
    stepping_offsets(linkage, middle, body, offsets);
    for (size_t i = 0; i < step->touch_count; i++) {
        const int joint = step->places[i].joint;
        const bool is_beside =
            touch_is_scalar(&step->places[i]) || touch_has_walls(&step->places[i]);
        if (is_beside && linkage->joints[joint].body_a == body) {
            offsets[joint] = linkage_joint_gap(linkage, middle, joint).position;
        }
    }
}

// What the force of a pin or disc does on a driven body beyond its mean, J.
static double work_at_point(const ImpulseStep *step, size_t number, const Motion *driven,
                            bool is_on_a)
{
    const KernelContact *at = &step->scheme.kernel.contacts[number];
    const Touch *place = &step->places[number];
    const double *sum = step->scheme.total.impulse + at->first_row;
    const double *moment = step->scheme.total.moment + at->first_row;
    const double half_s = 0.5 * step->scheme.width_s;
    const Vec2 early = {half_s * sum[0] - moment[0], half_s * sum[1] - moment[1]};
    const Vec2 arm = vec2_rotate(driven->angle, is_on_a ? place->anchor_a : place->anchor_b);
    const Vec2 turning = arm_acceleration(driven, arm);
    return (is_on_a ? -1.0 : 1.0) * vec2_dot(early, turning);
}

// What friction's moment about the anchor does on it, J.
static double work_of_turn(const ImpulseStep *step, size_t number, const Motion *driven,
                           bool is_on_a)
{
    const KernelContact *at = &step->scheme.kernel.contacts[number];
    const double *sum = step->scheme.total.impulse + at->first_row;
    return at->row_count == RESPONSE_ROWS_A_JOINT ? sum[is_on_a ? 2 : 3] * driven->omega : 0.0;
}

// How fast the point moves at which a cam is met.
static Vec2 moving_on_cam(const Linkage *linkage, const Touch *place, const TouchPose *pose,
                          const Motion *motions, double along_b)
{
    const int body = linkage->joints[place->joint].body_b;
    const double omega = body == LINKAGE_GROUND ? 0.0 : motions[body].omega;
    const Vec2 material = vec2_add(linkage_point_velocity(motions, body, place->anchor_b),
                                   vec2_scale(omega, vec2_perp(pose->from_b)));
    return vec2_add(material, vec2_scale(along_b, vec2_perp(pose->normal)));
}

// Likewise of a line, a rack or a slot, which turn with body a, or of a cam. Those of a slot act at
// the pin's centre.
static double work_at_line(const ImpulseStep *step, size_t number, const Motion *motions,
                           const Motion *driven, bool is_on_a)
{
    const Linkage *linkage = &step->scenario->linkage;
    const Touch *place = &step->places[number];
    const Joint *joint = &linkage->joints[place->joint];
    const size_t row = step->scheme.kernel.contacts[number].first_row;
    const double omega_a = joint->body_a == LINKAGE_GROUND ? 0.0 : motions[joint->body_a].omega;
    const TouchPose pose = touch_pose(linkage, place, motions);
    const bool is_slot = touch_has_walls(place);
    const Vec2 normal = is_slot ? touch_across(linkage, place, motions) : pose.normal;
    const Vec2 directions[2] = {normal, vec2_perp(normal)};
    Vec2 from_a;
    Vec2 from_b = {0.0, 0.0};
    if (!is_slot) {
        touch_points(place, &pose, &from_a, &from_b);
    }
    const Vec2 point = vec2_add(linkage_point(motions, joint->body_b, place->anchor_b), from_b);
    double turning = omega_a;
    Vec2 moving = vec2_add(linkage_point_velocity(motions, joint->body_b, place->anchor_b),
                           vec2_scale(omega_a, vec2_perp(from_b)));
    if (place->shape == TOUCH_CAM) {
        const TouchTravel travel = touch_travel(linkage, place, &pose, motions);
        turning = travel.turning;
        moving = moving_on_cam(linkage, place, &pose, motions, travel.along_b);
    }
    const Vec2 arm = vec2_sub(point, driven->position);
    const Vec2 speed = vec2_add(driven->velocity, vec2_scale(driven->omega, vec2_perp(arm)));
    const Vec2 pushed = vec2_add(arm_acceleration(driven, arm),
                                 vec2_scale(driven->omega, vec2_perp(vec2_sub(moving, speed))));
    double work = 0.0;
    for (size_t i = 0; i < 2; i++) {
        const double early = 0.5 * step->scheme.width_s * step->scheme.total.impulse[row + i] -
                             step->scheme.total.moment[row + i];
        work += early * (turning * vec2_dot(vec2_perp(directions[i]), speed) +
                         vec2_dot(directions[i], pushed));
    }
    return is_on_a ? -work : work;
}

// How fast the gap at an end grows as one of the bodies turns, m or rad per rad, but for its sign.
static double turning_share(const Linkage *linkage, const Touch *place, const Motion *motions,
                            bool is_on_a)
{
    switch (place->shape) {
    case TOUCH_TEETH:
        return -coordinate_flank(linkage, motions, place->joint, place->sign).arms[is_on_a ? 0 : 1];
    case TOUCH_TURN:
    case TOUCH_HOLE: // which are no ends
    case TOUCH_DISC:
    case TOUCH_LINE:
    case TOUCH_CAM:
    case TOUCH_SLOT:
    case TOUCH_RACK: // work_at_line has it
        break;
    }
    return coordinate_sense(&linkage->joints[place->joint]) * (is_on_a ? -1.0 : 1.0);
}

// Likewise of an end of an angle, or of teeth: a driven body turns about the ground.
static double work_at_end(const ImpulseStep *step, size_t number, const Motion *middle,
                          const Motion *driven, bool is_on_a)
{
    const Linkage *linkage = &step->scenario->linkage;
    const Touch *place = &step->places[number];
    const size_t row = step->scheme.kernel.contacts[number].first_row;
    const double early = 0.5 * step->scheme.width_s * step->scheme.total.impulse[row] -
                         step->scheme.total.moment[row];
    return early * place->sign * turning_share(linkage, place, middle, is_on_a) * driven->alpha;
}

// The bodies at mid-step with the means of their speeds.
static void find_mean_motions(const ImpulseStep *step, const Motion *middle, Motion *motions)
{
    for (size_t i = 0; i < step->scenario->linkage.body_count; i++) {
        motions[i] = middle[i];
        if (impulse_step_is_free(step, i)) {
            motions[i].velocity =
                vec2_scale(0.5, vec2_add(step->before[i].velocity, step->after[i].velocity));
            motions[i].omega = 0.5 * (step->before[i].omega + step->after[i].omega);
        }
    }
}

// What a torque over time does, J: contacts change the speeds inside the step, so it is taken by
// the way that it goes.
static double work_of_torque(const ImpulseStep *step)
{
    const Linkage *linkage = &step->scenario->linkage;
    if (linkage->torque.table.count == 0) {
        return 0.0;
    }
    return step->world.applied.torque * (forces_drive_turn(linkage, step->after).angle -
                                         forces_drive_turn(linkage, step->before).angle);
}

// The work of a drive in the step, J, from the bodies at mid-step and with the means of their
// speeds.
static double work_of_drive(ImpulseStep *step, size_t drive, const Motion *middle,
                            const Motion *motions)
{
    const Linkage *linkage = &step->scenario->linkage;
    const int body = linkage_drive_body(linkage, drive);
    const Motion *driven = &middle[body];
    double work = 0.0;
    for (size_t i = 0; i < step->place_count; i++) {
        const Joint *joint = &linkage->joints[step->places[i].joint];
        const bool is_on_a = joint->body_a == body;
        if (!is_on_a && joint->body_b != body) {
            continue;
        }
        switch (step->places[i].shape) {
        case TOUCH_LINE:
        case TOUCH_CAM:
        case TOUCH_RACK:
            work -= work_at_line(step, i, motions, &motions[body], is_on_a);
            break;
        case TOUCH_SLOT:
            work -= work_at_line(step, i, motions, &motions[body], is_on_a);
            work -= work_of_turn(step, i, driven, is_on_a);
            break;
        case TOUCH_TURN:
        case TOUCH_TEETH:
            work -= work_at_end(step, i, middle, driven, is_on_a);
            break;
        case TOUCH_HOLE:
        case TOUCH_DISC:
            work -= work_at_point(step, i, driven, is_on_a);
            work -= work_of_turn(step, i, driven, is_on_a);
            break;
        }
    }
    const BodyLoad load = applied_on(&step->world.applied, body);
    find_driven_offsets(step, middle, body, step->work->offsets);
    work += step->scheme.width_s * stepping_drive(step->scenario, drive, driven, &load,
                                                  step->work->offsets, step->work->joints);
    const double rubbed =
        step->scheme.width_s *
        impulse_rubs_add_driven(step->scenario, drive, driven, step->work->joints);
    step->rubbed += rubbed;
    return work + rubbed;
}

void impulse_step_find_work(ImpulseStep *step, const Motion *middle)
{
    const Linkage *linkage = &step->scenario->linkage;
    Motion *motions = step->work->motions;
    find_play_means(step, middle);
    find_mean_motions(step, middle, motions);
    const AppliedWork applied = applied_book(&step->world.applied, step->scheme.width_s);
    double work = 0.0;
    step->rubbed = 0.0;
    for (size_t i = 0; i < linkage_drive_count(linkage); i++) {
        work += work_of_drive(step, i, middle, motions);
    }
    step->damped = applied.damping;
    step->load_work =
        loads_work(linkage, step->world.applied.pushed, step->before, middle, step->after);
    step->drive_work = work + work_of_torque(step) + applied.slope;
}
