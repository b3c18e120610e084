// What will a step meet, as far as the steps before it tell?
//
// Of few rows the step is taken with what turns in it (ode/impulse_columns.c). All of this is right
// to one order more than a step without it, and has no part in it where nothing is known yet:
// a_f, the acceleration beside the contacts', is that of the step before, P_1 / h the mean force in
// it, g the rows' free acceleration at mid-step, at the speeds v + (h/2) a_f:
//     q_m = q + (h/2) v + (h^2/8) (a_f + A P_1 / h)
//     g' = (g - g_1 - 2 S_1 P_1) / h                  what is left is no work of the contacts
#include "ode/impulse_step.h"

#include "ode/stepping.h"

#include <math.h>
#include <string.h>

// of the free accelerations, what impulses may change them by: their own change, which comes of the
// second power of speeds, is then known to as much
static const double CALM = 0.1;

void impulse_step_look_ahead(ImpulseStep *step)
{
    const bool is_known = step->has_few_rows && step->steady > 0;
    for (size_t i = 0; i < 3 * step->scenario->linkage.body_count; i++) {
        step->ahead[i] = is_known ? step->free[i] : 0.0;
    }
}

// Adds to the bodies at mid-step what their accelerations have moved them by then, the contacts
// pressing as they did in the mean of the step before: at its end an impact may have been under
// way.
static void move_middle(const ImpulseStep *step, double width_before_s, Motion *middle)
{
    const double share = 0.125 * step->width_s * step->width_s;
    double *mean = step->work->rows[0];
    double *pressed = step->work->changes[0];
    double *speeds = step->work->changes[1];
    for (size_t i = 0; i < kernel_rows(&step->kernel); i++) {
        mean[i] = step->total.impulse[i] / width_before_s;
    }
    impulse_step_press_bodies(step, 0.0, mean, pressed);
    for (size_t i = 0; i < 3 * step->scenario->linkage.body_count; i++) {
        pressed[i] = share * (pressed[i] + step->ahead[i]);
    }
    memset(speeds, 0, 3 * step->scenario->linkage.body_count * sizeof *speeds);
    impulse_step_change_motions(step, pressed, speeds, middle);
}

// The bodies at mid-step, with the speeds of its start.
void impulse_step_find_middle(ImpulseStep *step, double width_before_s, Motion *middle)
{
    const double half_s = 0.5 * step->width_s;
    for (size_t i = 0; i < step->scenario->linkage.body_count; i++) {
        const Motion *motion = &step->before[i];
        middle[i] = *motion;
        middle[i].position = vec2_add(motion->position, vec2_scale(half_s, motion->velocity));
        middle[i].angle = motion->angle + half_s * motion->omega;
    }
    if (step->driven >= 0) {
        const Linkage *linkage = &step->scenario->linkage;
        step->arm = stepping_arm(linkage, step->start_s + half_s);
        middle[step->driven] =
            stepping_driven_since(linkage, &step->arm, step->start_s, step->start_s + half_s);
    }
    if (step->has_few_rows && step->steady > 0) {
        move_middle(step, width_before_s, middle);
    }
}

// The free accelerations of the rows of play at mid-step, where the contacts have not changed the
// speeds.
void impulse_step_find_free(ImpulseStep *step, const Motion *middle)
{
    Motion *motions = step->work->motions;
    const double half_s = 0.5 * step->width_s;
    const Applied *applied = &step->world.applied;
    memcpy(motions, middle, step->scenario->linkage.body_count * sizeof *motions);
    for (size_t i = 0; i < step->scenario->linkage.body_count; i++) {
        const double *ahead = step->ahead + 3 * i;
        motions[i].velocity.x += half_s * ahead[0];
        motions[i].velocity.y += half_s * ahead[1];
        motions[i].omega += half_s * ahead[2];
    }
    response_free(&step->response, motions, step->scenario->gravity,
                  applied->is_any ? applied->loads : NULL, step->kernel.free);
}

// Lets what the rows of play feel change in the step: their mobility with the bodies, the free
// acceleration beside that as it did from the middle of the step before, when the contacts changed
// it by 2 S P.
void impulse_step_set_drift(ImpulseStep *step, const double *free_before)
{
    Kernel *kernel = &step->kernel;
    const bool is_known = step->steady > 1 && step->is_calm;
    const double apart_s = step->middles_s[0] - step->middles_s[1];
    for (size_t i = 0; i < kernel_rows(kernel); i++) {
        kernel->free_rate[i] = is_known ? (kernel->free[i] - free_before[i]) / apart_s : 0.0;
    }
    kernel_set_drift(kernel, step->drift.drift, step->width_s);
}

// The free accelerations in the step before, with what its contacts did to them; whether that was
// so little that they say how these change by themselves.
void impulse_step_keep_free(ImpulseStep *step, double *free_before)
{
    const size_t rows = kernel_rows(&step->kernel);
    double size = 0.0;
    double pushed = 0.0;
    for (size_t i = 0; i < rows; i++) {
        double change = 0.0;
        for (size_t k = 0; k < rows; k++) {
            change += 2.0 * step->drift.drift[i * rows + k] * step->total.impulse[k];
        }
        free_before[i] = step->kernel.free[i] + change;
        size = fmax(size, fabs(step->kernel.free[i]));
        pushed = fmax(pushed, fabs(change));
    }
    step->is_calm = pushed <= CALM * size;
}
