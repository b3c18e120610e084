// What do the contacts' impulses do to all bodies within a step?
//
// Of few rows A, what 1 N s in each does to all speeds, is linear in time (model/response_drift.h),
// s = t - h/2:
//     v(t) = .. + A P + A' (s P - Q),   q(t) = .. + A Q + A' (s Q - 2 R),   Q' = P, R' = Q
// with P and Q the contacts' impulse and its integral up to t. Of many it is taken as constant.
#include "ode/impulse_step.h"

#include <string.h>

void impulse_step_find_columns(ImpulseStep *step, const Motion *middle)
{
    double *oldest = step->columns[IMPULSE_COLUMNS - 1];
    memmove(step->columns + 1, step->columns, (IMPULSE_COLUMNS - 1) * sizeof *step->columns);
    memmove(step->middles_s + 1, step->middles_s, (IMPULSE_COLUMNS - 1) * sizeof *step->middles_s);
    step->columns[0] = step->drift.columns = oldest;
    step->middles_s[0] = step->start_s + 0.5 * step->width_s;
    response_drift_columns(&step->response, &step->drift);
    response_drift_find(&step->response, middle, 0.5 * step->width_s, &step->drift);
}

void impulse_step_push_bodies(const ImpulseStep *step, double since_s, const KernelSums *sums,
                              double *speeds, double *positions)
{
    if (!step->has_few_rows) {
        response_apply(&step->response, sums->impulse, speeds);
        response_apply(&step->response, sums->moment, positions);
        return;
    }
    const size_t count = 3 * step->scenario->linkage.body_count;
    const size_t rows = kernel_rows(&step->kernel);
    const double off_s = since_s - 0.5 * step->width_s;
    memset(speeds, 0, count * sizeof *speeds);
    memset(positions, 0, count * sizeof *positions);
    for (size_t row = 0; row < rows; row++) {
        const double *column = step->drift.columns + row * count;
        const double *rate = step->drift.rates + row * count;
        const double pushed = sums->impulse[row];
        const double moved = sums->moment[row];
        const double turned = off_s * pushed - moved;
        const double carried = off_s * moved - 2.0 * sums->moment[rows + row];
        for (size_t i = 0; i < count; i++) {
            speeds[i] += pushed * column[i] + turned * rate[i];
            positions[i] += moved * column[i] + carried * rate[i];
        }
    }
}

void impulse_step_turn_bodies(const ImpulseStep *step, double *speeds)
{
    const size_t count = 3 * step->scenario->linkage.body_count;
    memset(speeds, 0, count * sizeof *speeds);
    for (size_t row = 0; step->has_few_rows && row < kernel_rows(&step->kernel); row++) {
        const double turned =
            0.5 * step->width_s * step->total.impulse[row] - step->total.moment[row];
        for (size_t i = 0; i < count; i++) {
            speeds[i] += turned * step->drift.rates[row * count + i];
        }
    }
}

void impulse_step_press_bodies(const ImpulseStep *step, double since_s, const double *forces,
                               double *rates)
{
    if (impulse_step_has_curves(step)) {
        const double time_s = step->start_s + since_s;
        impulse_curves_press(&step->curves, time_s - step->middles_s[0], forces, rates);
    } else {
        response_apply(&step->response, forces, rates);
    }
}
