// Holds what all ways of stepping ODE have in common.
//
// On a driven body, whose motion is given: m a = m g + F_drive + sum of F_i, so that the drive's
// force follows from the others, and its power is what they and gravity do not deliver:
//     P = m (a - g) . v + I alpha omega - sum (F_i . v_i + M_i omega),
// v_i velocity of the point where F_i acts.
#include "ode/stepping.h"

#include "contact/touch.h"
#include "model/joint_rows.h"
#include "model/kinematics.h"

#include <math.h>
#include <stdio.h>

static const Joint *joint_of(const Linkage *linkage, size_t drive)
{
    return &linkage->joints[linkage_drive(linkage, drive)->joint];
}

static Vec2 driven_arm(const Joint *joint, double angle_rad)
{
    return vec2_scale(-1.0, vec2_rotate(angle_rad, joint->anchor_b));
}

// How a driven body moves whose centre is so far from its joint.
static Motion driven_motion(const Joint *joint, const DriveState *drive, Vec2 arm)
{
    const double omega = drive->omega;
    Motion motion = {.angle = drive->angle, .omega = omega, .alpha = drive->alpha};
    motion.position = vec2_add(joint->anchor_a, arm);
    motion.velocity = vec2_scale(omega, vec2_perp(arm));
    motion.acceleration = vec2_scale(-omega * omega, arm);
    if (drive->alpha != 0.0) {
        motion.acceleration =
            vec2_add(motion.acceleration, vec2_scale(drive->alpha, vec2_perp(arm)));
    }
    return motion;
}

Motion stepping_driven(const Linkage *linkage, size_t drive, double time_s)
{
    const Joint *joint = joint_of(linkage, drive);
    const DriveState state = drive_at(linkage_drive(linkage, drive), time_s);
    return driven_motion(joint, &state, driven_arm(joint, state.angle));
}

void stepping_set_driven(const Linkage *linkage, double time_s, Motion *motions)
{
    for (size_t i = 0; i < linkage_drive_count(linkage); i++) {
        motions[linkage_drive_body(linkage, i)] = stepping_driven(linkage, i, time_s);
    }
}

SteppingArm stepping_arm(const Linkage *linkage, size_t drive, double time_s)
{
    const double angle = drive_angle(linkage_drive(linkage, drive), time_s);
    return (SteppingArm){angle, driven_arm(joint_of(linkage, drive), angle)};
}

Motion stepping_driven_since(const Linkage *linkage, size_t drive, const SteppingArm *near,
                             double from_s, double time_s)
{
    const Driver *driver = linkage_drive(linkage, drive);
    const DriveState state =
        driver->table.count == 0 ? drive_at(driver, time_s) : drive_since(driver, from_s, time_s);
    const double turned = state.angle - near->angle;
    return driven_motion(joint_of(linkage, drive), &state, vec2_rotate_slightly(turned, near->arm));
}

long stepping_start(const Scenario *scenario, double step_s, long steps_back, Motion *motions)
{
    const Linkage *linkage = &scenario->linkage;
    linkage_start(linkage, motions);
    if (!linkage->driver.is_present || scenario_has_clearance(scenario)) {
        return 0;
    }
    // step by step backwards, so that the loop stays closed the same way round; on the way there a
    // small mechanism is but placed
    const bool is_small = kinematics_is_small(linkage);
    DriveState drives[2][LINKAGE_DRIVE_MAX]; // of the steps back that are odd, or even
    Err unused = {ERR_NONE, ""};
    for (long back = 1; back <= steps_back; back++) {
        const double time_s = -(double)back * step_s;
        linkage_drives_since(linkage, time_s, time_s, drives[back % 2]);
        const bool is_last = back == steps_back || !is_small;
        if (!(is_last ? kinematics_solve_driven
                      : kinematics_place_driven)(linkage, drives[back % 2], motions, &unused)) {
            // it stays where it was closed last, with the speeds that it has there
            if (back > 1) {
                kinematics_solve_driven(linkage, drives[(back - 1) % 2], motions, &unused);
            }
            return back - 1;
        }
    }
    return steps_back;
}

void stepping_offsets(const Linkage *linkage, const Motion *motions, int body, Vec2 *offsets)
{
    for (int i = 0; i < (int)linkage->joint_count; i++) {
        const Joint *joint = &linkage->joints[i];
        const bool is_elsewhere = joint_has_position(joint->kind) && joint->body_a == body;
        offsets[i] =
            is_elsewhere ? linkage_joint_gap(linkage, motions, i).position : (Vec2){0.0, 0.0};
    }
}

// What a driven body needs so as to move as it does, N.
static Vec2 driven_force(const Scenario *scenario, const Body *own, const Motion *driven)
{
    return vec2_scale(own->mass, vec2_add(driven->acceleration, scenario_upward(scenario)));
}

void stepping_drive_force(const Scenario *scenario, size_t drive, const Motion *driven,
                          const BodyLoad *load, JointState *joints)
{
    const Linkage *linkage = &scenario->linkage;
    const int driver = linkage_drive(linkage, drive)->joint;
    const int body = linkage->joints[driver].body_b;
    Vec2 others = load->force;
    for (int i = 0; i < (int)linkage->joint_count; i++) {
        const Joint *joint = &linkage->joints[i];
        if (i != driver && joint->body_a == body) {
            others = vec2_sub(others, joints[i].force_on_b);
        } else if (i != driver && joint->body_b == body) {
            others = vec2_add(others, joints[i].force_on_b);
        }
    }
    const Vec2 needed = driven_force(scenario, &linkage->bodies[body], driven);
    joints[driver].force_on_b = vec2_sub(needed, others);
    joints[driver].force = vec2_length(joints[driver].force_on_b);
}

double stepping_drive(const Scenario *scenario, size_t drive, const Motion *driven,
                      const BodyLoad *load, const Vec2 *offsets, JointState *joints)
{
    const Linkage *linkage = &scenario->linkage;
    const int body = linkage_drive_body(linkage, drive);
    const Body *own = &linkage->bodies[body];
    double power = vec2_dot(driven_force(scenario, own, driven), driven->velocity) +
                   own->inertia * driven->alpha * driven->omega - forces_load_power(load, driven);
    for (int i = 0; i < (int)linkage->joint_count; i++) {
        const Joint *joint = &linkage->joints[i];
        const bool is_on_a = joint->body_a == body;
        if (i == linkage_drive(linkage, drive)->joint || (!is_on_a && joint->body_b != body)) {
            continue;
        }
        const double sign = is_on_a ? -1.0 : 1.0;
        const Vec2 force = vec2_scale(sign, joints[i].force_on_b);
        const Vec2 anchor = vec2_rotate(driven->angle, is_on_a ? joint->anchor_a : joint->anchor_b);
        const Vec2 arm = vec2_add(anchor, offsets[i]);
        const Vec2 velocity = vec2_add(driven->velocity, vec2_scale(driven->omega, vec2_perp(arm)));
        power -= vec2_dot(force, velocity) + sign * joints[i].moment_on_b * driven->omega;
    }
    stepping_drive_force(scenario, drive, driven, load, joints);
    return power;
}

double stepping_end(const Scenario *scenario, double start_s, double end_s, double tick_s)
{
    const double duration_s = scenario_duration(scenario);
    const bool is_last = start_s < duration_s && end_s > duration_s - STEPPING_ROUNDING * tick_s;
    return is_last ? duration_s : end_s;
}

bool stepping_fail(const Scenario *scenario, double time_s, size_t step, double step_s, Err *err)
{
    char instant[LINKAGE_INSTANT_SIZE];
    char where[2 * LINKAGE_INSTANT_SIZE];
    linkage_describe_instant(&scenario->linkage, time_s, instant);
    snprintf(where, sizeof where, "%s, step %zu of %.4g us", instant, step, 1e6 * step_s);
    err_prefix(err, where);
    return false;
}

void stepping_label(const Scenario *scenario, const char *stepping, const char *map,
                    char label[TRAJECTORY_LABEL_SIZE])
{
    const bool has_play = scenario_has_clearance(scenario);
    const bool is_poisson = has_play && scenario->contact.model == CONTACT_POISSON;
    const bool has_collider = has_play && scenario->ode.collider != ODE_COLLIDER_PIN_HOLE;
    snprintf(label, TRAJECTORY_LABEL_SIZE, "ode %s/%s/%s%s%s",
             OPTIONS_ODE_SOLVERS[scenario->ode.solver], stepping,
             is_poisson ? "poisson"
             : has_play ? map
                        : "ideal",
             has_collider ? "/" : "",
             has_collider ? OPTIONS_ODE_COLLIDERS[scenario->ode.collider] : "");
}

void stepping_observe_line(const Linkage *linkage, int joint, const Motion *motions,
                           JointState *state)
{
    JointRows rows;
    joint_rows_find(linkage, motions, joint, &rows);
    const Vec2 offset = linkage_joint_gap(linkage, motions, joint).position;
    const double along = vec2_dot(joint_rows_along(linkage, motions, joint), offset);
    state->eccentricity = (Vec2){along, rows.position[0]};
    state->tilt = remainder(rows.position[1], 2.0 * M_PI);
}

void stepping_observe_coordinate(const Linkage *linkage, int joint, const Motion *motions,
                                 JointState *state)
{
    const Joint *data = &linkage->joints[joint];
    if (data->limits.kind == LIMIT_NONE) {
        return;
    }
    switch (joint_coordinate(data->kind)) {
    case JOINT_COORDINATE_TEETH:
    case JOINT_COORDINATE_RACK: {
        const double position = coordinate_position(linkage, motions, joint);
        state->eccentricity = (Vec2){position - data->limits.middle, 0.0};
        break;
    }
    case JOINT_COORDINATE_ANGLE:
        state->tilt = coordinate_position(linkage, motions, joint);
        break;
    case JOINT_COORDINATE_NONE:
    case JOINT_COORDINATE_POSITION: // stepping_observe_line has it
        break;
    }
}

SteppingRate stepping_beside_jump(double before, double mean, double jump_s, double step_s,
                                  double since_s)
{
    const double after = (step_s * mean - jump_s * before) / (step_s - jump_s);
    return since_s <= jump_s ? (SteppingRate){before, since_s * before}
                             : (SteppingRate){after, step_s * mean - (step_s - since_s) * after};
}

// The smallest gap of a joint's places, m; infinite where it has none.
static double smallest_gap(const Linkage *linkage, int joint, const Motion *motions)
{
    Touch places[TOUCH_CORNERS];
    const size_t count = touch_places(linkage, joint, places);
    double gap = INFINITY;
    for (size_t i = 0; i < count; i++) {
        gap = fmin(gap, touch_pose(linkage, &places[i], motions).gap);
    }
    return gap;
}

void stepping_observe_joint(const Linkage *linkage, size_t joint, Sample *sample)
{
    const Joint *data = &linkage->joints[joint];
    const Vec2 hole = linkage_point(sample->bodies, data->body_a, data->anchor_a);
    const Vec2 pin = linkage_point(sample->bodies, data->body_b, data->anchor_b);
    const bool is_limited = data->limits.kind != LIMIT_NONE;
    const bool is_ideal = joint_is_ideal(data->kind) && !is_limited;
    JointState *state = &sample->joints[joint];
    state->eccentricity = vec2_sub(pin, hole);
    if (joint_slides(data->kind)) {
        stepping_observe_line(linkage, (int)joint, sample->bodies, state);
    }
    stepping_observe_coordinate(linkage, (int)joint, sample->bodies, state);
    if (joint_has_guides(data->kind) || joint_has_disc(data->kind) || is_limited) {
        state->gap = smallest_gap(linkage, (int)joint, sample->bodies);
    } else {
        state->gap =
            is_ideal ? 0.0 : linkage_radial_clearance(data) - vec2_length(state->eccentricity);
    }
    state->is_touching = is_ideal || state->gap < 0.0;
}
