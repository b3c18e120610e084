// With which forces did the joints and the drive hold the bodies in a step?
//
// The ideal joints: F = (what ODE's rows did + what put the speeds back onto the joints) / h. ODE's
// rows stand at mid-step, the speeds are kept at the step's end.
// The drive, m (a - g) = F_drive + sum F_i of the driven body:
//     work = h P(mean forces, mid-step) - sum (h/2 P_c - Q_c) a_c
// with P_c and Q_c impulse and moment of a contact's row, a_c the acceleration along it of the
// driven body's point: the contact's force does not stand in the middle of the step.
#include "ode/space_impulse_means.h"

// Mean forces of the ideal joints, and what they do to the driven body.
static void find_means(SpaceImpulseStep *step)
{
    const Linkage *linkage = &step->scenario->linkage;
    SpaceChange *sum = &step->on_driven;
    *sum = (SpaceChange){{0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}};
    for (size_t i = 0; i < linkage->joint_count; i++) {
        const Joint *joint = &linkage->joints[i];
        if (!linkage_is_ideal(linkage, i)) {
            continue;
        }
        step->mean[i] = space_world_force(&step->world, i);
        if (step->driven >= 0 && (joint->body_a == step->driven || joint->body_b == step->driven)) {
            const SpaceChange load = space_world_load(&step->world, i, step->driven);
            sum->move = vec3_add(sum->move, load.move);
            sum->turn = vec3_add(sum->turn, load.turn);
        }
    }
    double *closing = step->ideal[0];
    for (size_t i = 0; i < step->response->ideal_rows; i++) {
        closing[i] = step->closing[i] / step->width_s;
    }
    space_response_add_forces(step->response, closing, step->mean);
    if (step->driven >= 0) {
        space_response_add_reactions(step->response, closing, step->driven, sum);
    }
}

// The same of a stop, whose axis turns with body a: against body b's own turning.
static double work_of_stop(const SpaceImpulseStep *step, size_t place)
{
    const Linkage *linkage = &step->scenario->linkage;
    const StopSpace *stop = space_impulse_step_stop(step, place);
    const Joint *joint = &linkage->joints[stop->joint];
    const size_t row = step->kernel.contacts[place].first_row;
    if (joint->body_b != step->driven || joint->body_a == LINKAGE_GROUND) {
        return 0.0;
    }
    const double early = 0.5 * step->width_s * step->total.impulse[row] - step->total.moment[row];
    const Vec3 axis = step->rows[place].rows[0].angular[1];
    const Vec3 turning = vec3_cross(step->middle[joint->body_a].omega, axis);
    return -early * vec3_dot(turning, step->middle[step->driven].omega);
}

// What the contacts' force does beyond its mean, as the points of the driven body turn.
static double work_beyond(const SpaceImpulseStep *step, size_t place)
{
    if (place >= step->pin_count) {
        return work_of_stop(step, place);
    }
    const PinSpaceRows *rows = &step->rows[place];
    double work = 0.0;
    for (size_t k = 0; k < PIN_SPACE_PLAIN_ROWS; k++) {
        const size_t row = step->kernel.contacts[place].first_row + k;
        const SpaceRow *of = &rows->rows[k];
        const double early =
            0.5 * step->width_s * step->total.impulse[row] - step->total.moment[row];
        for (int side = 0; side < 2; side++) {
            if (of->body[side] == step->driven) {
                const Vec3 at = side == 0 ? rows->at_a : rows->at_b;
                const Vec3 turning = space_acceleration_at(step->middle, step->driven, at);
                work -= early * vec3_dot(of->linear[side], turning);
            }
        }
    }
    return work;
}

// The work of the drive: that of the mean forces at mid-step, and what is beyond.
static void find_drive_work(SpaceImpulseStep *step)
{
    step->drive_work = 0.0;
    if (step->driven < 0) {
        return;
    }
    const double rate = 1.0 / step->width_s;
    SpaceChange *loads = step->changes[0];
    space_response_load(step->response, step->total.impulse, loads);
    const SpaceChange *own = &loads[step->driven];
    const SpaceChange others = {
        vec3_add(step->on_driven.move, vec3_scale(rate, own->move)),
        vec3_add(step->on_driven.turn, vec3_scale(rate, own->turn)),
    };
    Vec3 force;
    step->drive_work =
        step->width_s *
        space_joints_drive(step->scenario, &step->middle[step->driven], &others, &force);
    for (size_t i = 0; i < step->place_count; i++) {
        step->drive_work += work_beyond(step, i);
    }
}

void space_impulse_means_find(SpaceImpulseStep *step)
{
    find_means(step);
    find_drive_work(step);
}
