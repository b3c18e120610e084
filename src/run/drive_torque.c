// Finds the torque of a drive by Euler's law of the body that it turns about the pivot there, whose
// force it does not need,
//
//     I alpha + s x m (a - g) = T + M + sum of (r x F + c)
//
// with s from the pivot to the centre of mass, g gravity, M the moment of springs and dampers and
// of friction in the pivot, and of each other joint its force F at the arm r and its moment c.
#include "run/drive_torque.h"
#include "contact/touch.h"
#include "model/joint_friction.h"
#include "model/loads.h"

#include <assert.h>
#include <stdlib.h>

double joint_moment(const Linkage *linkage, const Motion *motions, size_t joint,
                    const JointState *state)
{
    const JointKind kind = linkage->joints[joint].kind;
    if (!joint_has_hole(kind) && !joint_has_disc(kind)) {
        return state->moment_on_b;
    }
    Touch touches[TOUCH_CORNERS];
    touch_places(linkage, (int)joint, touches);
    const TouchPose pose = touch_pose(linkage, &touches[0], motions);
    Vec2 from_a;
    Vec2 from_b;
    touch_points(&touches[0], &pose, &from_a, &from_b);
    return vec2_cross(from_b, state->force_on_b);
}

bool drive_torque_exists(const Linkage *linkage)
{
    const bool is_pushed =
        linkage->torque.table.count > 0 && !forces_is_along_line(linkage, linkage->torque.joint);
    return !linkage->is_spatial &&
           (is_pushed || (linkage->driver.is_present &&
                          joint_has_angle(linkage->joints[linkage->driver.joint].kind)));
}

// The moment of springs and dampers on a body about a point, N m.
static double moment_of_loads(const Linkage *linkage, const Motion *motions, double time_s,
                              int body, Vec2 point)
{
    if (!forces_any(linkage)) {
        return 0.0;
    }
    BodyLoad *loads = calloc(linkage->body_count, sizeof *loads);
    assert(loads != NULL);
    loads_of_all(linkage, motions, time_s, time_s, loads);
    const Vec2 arm = vec2_sub(motions[body].position, point);
    const double moment = loads[body].moment + vec2_cross(arm, loads[body].force);
    free(loads);
    return moment;
}

// Whether what presses in a joint has a moment about its point: without friction that of a pin goes
// through the pin's centre.
static bool has_moment(const Scenario *scenario, const Joint *joint)
{
    return !joint_has_hole(joint->kind) || scenario_friction(scenario, joint) > 0.0;
}

double drive_torque_of(const Scenario *scenario, const Motion *motions, const JointState *states,
                       double time_s, size_t drive)
{
    const Linkage *linkage = &scenario->linkage;
    if (!linkage->driver.is_present) {
        return forces_drive_torque(linkage, motions, time_s);
    }
    const int driven = linkage_drive_body(linkage, drive);
    const int pivoted = linkage_drive(linkage, drive)->joint;
    const Motion *body = &motions[driven];
    const double mass = linkage->bodies[driven].mass;
    const Joint *pivot = &linkage->joints[pivoted];
    const Vec2 point = linkage_point(motions, pivot->body_b, pivot->anchor_b);
    const Vec2 pull = vec2_add(body->acceleration, scenario_upward(scenario));
    double torque = linkage->bodies[driven].inertia * body->alpha +
                    mass * vec2_cross(vec2_sub(body->position, point), pull) -
                    moment_of_loads(linkage, motions, time_s, driven, point);
    for (size_t i = 0; i < linkage->joint_count; i++) {
        const Joint *joint = &linkage->joints[i];
        if ((int)i == pivoted && joint_friction_is(joint)) {
            torque -= (joint->body_b == driven ? 1.0 : -1.0) * states[i].moment_on_b;
        }
        if ((int)i == pivoted || (joint->body_a != driven && joint->body_b != driven)) {
            continue;
        }
        const double sign = joint->body_b == driven ? 1.0 : -1.0;
        const Vec2 arm = vec2_sub(linkage_point(motions, joint->body_b, joint->anchor_b), point);
        const double moment =
            has_moment(scenario, joint) ? joint_moment(linkage, motions, i, &states[i]) : 0.0;
        torque -= sign * (vec2_cross(arm, states[i].force_on_b) + moment);
    }
    return torque;
}

double drive_torque_at(const Scenario *scenario, const Trajectory *run, size_t drive, size_t sample)
{
    return drive_torque_of(scenario, trajectory_motion(run, sample, 0),
                           trajectory_state(run, sample, 0), run->times[sample], drive);
}

size_t drive_torque_count(const Linkage *linkage)
{
    const size_t count = linkage_drive_count(linkage);
    return !drive_torque_exists(linkage) ? 0 : count > 1 ? count : 1;
}
