// What do springs, dampers and a torque do in a step in which contacts are integrated?
//
// Dampers feel the mean speed in the step. With P the contacts' impulse and Q its integral it is
// not that of start and end but differs by A (Q - (h/2) P) / h; see ode/impulse_step.c.
#include "ode/impulse_step.h"

#include <string.h>

void impulse_step_push(ImpulseStep *step, const Motion *middle)
{
    if (!step->world.applied.is_any) {
        return;
    }
    Motion *motions = step->work->motions;
    memcpy(motions, middle, step->scenario->linkage.body_count * sizeof *motions);
    if (step->driven >= 0) {
        // the others have the speeds of the start already
        motions[step->driven].velocity = step->before[step->driven].velocity;
    }
    applied_push_at(&step->world.applied, motions, step->start_s, step->width_s, APPLIED_AT_MEAN,
                    1);
}

void impulse_step_push_late(ImpulseStep *step, const Motion *middle)
{
    const Linkage *linkage = &step->scenario->linkage;
    if (!forces_damp(linkage)) {
        return;
    }
    double *late = step->work->rows[0];
    double *moved = step->work->changes[0];
    Motion *motions = step->work->motions;
    BodyLoad *loads = step->work->loads;
    memset(loads, 0, linkage->body_count * sizeof *loads);
    for (size_t i = 0; i < kernel_rows(&step->kernel); i++) {
        late[i] = step->total.moment[i] / step->width_s - 0.5 * step->total.impulse[i];
    }
    response_apply(&step->response, late, moved);
    for (size_t i = 0; i < step->scenario->linkage.body_count; i++) {
        motions[i] = middle[i];
        motions[i].velocity = (Vec2){moved[3 * i], moved[3 * i + 1]};
        motions[i].omega = moved[3 * i + 2];
    }
    forces_add_dampers(linkage, motions, loads);
    for (size_t i = 0; i < step->scenario->linkage.body_count; i++) {
        dBodyAddForce(step->world.bodies[i], loads[i].force.x, loads[i].force.y, 0.0);
        dBodyAddTorque(step->world.bodies[i], 0.0, 0.0, loads[i].moment);
    }
}
