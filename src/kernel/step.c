// Takes a step of a world whose contacts are integrated within the step.
//
// A step from t to t + h, positions q and speeds v both known at t:
//     q_m = q + (h/2) v                               positions at mid-step
//     W, g at q_m                                     the world as its joints with play feel it
//     P, Q = impulse of the contacts and its integral over the step, by kernel/run.c
//     v' from the world's own step at q_m under the mean force P / h, what is driven at its speed
//        of t + h
//     q' = q_m + (h/2) v' + A (Q - (h/2) P)           A P = what P does to the speeds
//     and where A' is known (with drift), R the integral of Q
//     v' += A' ((h/2) P - Q),   q' += A' ((h/2) Q - 2 R)
//     q', v' put back on the ideal joints along the rows at mid-step
// The last term of q' stands for when in the step the impulse came. The correction along the rows
// at mid-step, not at the end, leaves the step symmetric in time to the order that matters: the
// method is of second order in h, whatever the contacts do within a step.
//
// With drift A, what 1 N s in each row does to all speeds, is linear in time, s = t - h/2:
//     v(t) = .. + A P + A' (s P - Q),   q(t) = .. + A Q + A' (s Q - 2 R),   Q' = P, R' = Q
// with P and Q the contacts' impulse and its integral up to t. Else it is taken as constant. The
// step is then taken with what turns in it. All of this is right to one order more than a step
// without it: a_f, the acceleration beside the contacts', is that of the step before, P_1 / h the
// mean force in it, g the rows' free acceleration at mid-step, at the speeds v + (h/2) a_f. Where
// there was none, or a kink ended it, a_f and g_1 are those of the start, half a step before:
//     q_m = q + (h/2) v + (h^2/8) (a_f + A P_1 / h)
//     g' = (g - g_1 - 2 S_1 P_1) / h                  what is left is no work of the contacts
//
// Inside a step    v(t) = v + a_f t + A P(t),  q(t) = q + v t + a_f t^2 / 2 + A Q(t)
// with a_f, the acceleration beside the contacts', such that v(h) = v'. See docs/stepping.md.
#include "kernel/step.h"

#include "base/zeroed.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// a last step that is shorter than this share of the others tells no accelerations: rounding and
// the corrections would stand in them
static const double SHORT = 0.1;

void kernel_step_make_room(KernelStep *step, size_t coordinates, size_t ideal_rows)
{
    const size_t rows = kernel_rows(&step->kernel);
    KernelStepWork *work = &step->work;
    step->coordinate_count = coordinates;
    double **by_coordinate[] = {
        &step->free,     &step->free_rate, &step->ahead,      &step->rest,       &step->moved[0],
        &step->moved[1], &step->closed,    &work->changes[0], &work->changes[1], &work->changes[2]};
    for (size_t i = 0; i < sizeof by_coordinate / sizeof *by_coordinate; i++) {
        *by_coordinate[i] = zeroed(coordinates, sizeof(double));
    }
    step->total = kernel_sums(rows);
    step->pressing = zeroed(rows, sizeof *step->pressing);
    step->closing = zeroed(ideal_rows, sizeof *step->closing);
    work->rows = zeroed(rows, sizeof *work->rows);
    work->ideal[0] = zeroed(ideal_rows, sizeof *work->ideal[0]);
    work->ideal[1] = zeroed(ideal_rows, sizeof *work->ideal[1]);
}

void kernel_step_make_islands(KernelStep *step)
{
    kernel_make_rows(&step->kernel);
    step->islands = kernel_islands_create(&step->kernel, &step->coupling);
}

void kernel_step_make_drift(KernelStep *step, const double *rates, const double *drift)
{
    step->has_drift = true;
    step->rates = rates;
    step->drift = drift;
    kernel_make_drift(&step->kernel);
    for (size_t i = 0; i < KERNEL_COLUMNS_KNOWN; i++) {
        step->columns[i] =
            zeroed(step->coordinate_count * kernel_rows(&step->kernel), sizeof *step->columns[i]);
    }
}

void kernel_step_finish(KernelStep *step)
{
    KernelStepWork *work = &step->work;
    kernel_islands_destroy(step->islands);
    kernel_finish(&step->kernel);
    kernel_sums_free(&step->total);
    double *const arrays[] = {step->free,       step->free_rate,  step->ahead,    step->rest,
                              step->moved[0],   step->moved[1],   step->closed,   step->pressing,
                              step->closing,    work->rows,       work->ideal[0], work->changes[0],
                              work->changes[1], work->changes[2], work->ideal[1]};
    for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++) {
        free(arrays[i]);
    }
    for (size_t i = 0; i < KERNEL_COLUMNS_KNOWN; i++) {
        free(step->columns[i]);
    }
}

void kernel_step_carry(KernelStep *step, Carry *carry)
{
    const size_t rows = kernel_rows(&step->kernel);
    CARRY(carry, step->is_kink);
    CARRY(carry, step->end_s);
    CARRY(carry, step->count);
    CARRY(carry, step->start_s);
    CARRY(carry, step->width_s);
    CARRY(carry, step->steady);
    CARRY(carry, step->is_calm);
    CARRY_ARRAY(carry, step->free, step->coordinate_count);
    CARRY_ARRAY(carry, step->free_rate, step->coordinate_count);
    CARRY_ARRAY(carry, step->closed, step->coordinate_count);
    CARRY_ARRAY(carry, step->pressing, rows);
    CARRY_ARRAY(carry, step->total.impulse, rows);
    for (size_t i = 0; step->has_drift && i < KERNEL_COLUMNS_KNOWN; i++) {
        CARRY_ARRAY(carry, step->columns[i], step->coordinate_count * rows);
    }
    CARRY(carry, step->middles_s);
}

// What pushes do in a step with drift.
static KernelColumns columns_of(const KernelStep *step)
{
    return (KernelColumns){
        .rows = kernel_rows(&step->kernel),
        .coordinates = step->coordinate_count,
        .columns = step->columns[0],
        .rates = step->rates,
    };
}

void kernel_step_push(const KernelStep *step, double since_s, const KernelSums *sums,
                      double *speeds, double *positions)
{
    if (!step->has_drift) {
        step->adapter->push(step->own, 0.0, sums->impulse, speeds);
        step->adapter->push(step->own, 0.0, sums->moment, positions);
        return;
    }
    memset(speeds, 0, step->coordinate_count * sizeof *speeds);
    memset(positions, 0, step->coordinate_count * sizeof *positions);
    const KernelColumns columns = columns_of(step);
    kernel_columns_push(&columns, since_s - 0.5 * step->width_s, sums->impulse, sums->moment,
                        speeds, positions);
}

// Sets what the accelerations beside the contacts' will be at mid-step: those of the step before,
// or where there is none those of the start.
static bool look_ahead(KernelStep *step)
{
    if (!step->has_drift) {
        memset(step->ahead, 0, step->coordinate_count * sizeof *step->ahead);
        return true;
    }
    if (step->steady > 0) {
        memcpy(step->ahead, step->free, step->coordinate_count * sizeof *step->ahead);
        return true;
    }
    memset(step->free_rate, 0, step->coordinate_count * sizeof *step->free_rate);
    return step->adapter->find_start(step->own, step->ahead);
}

// What the accelerations have moved the bodies by at mid-step, the contacts pressing as they did in
// the mean of the step before: at its end an impact may have been under way.
static const double *find_beyond(KernelStep *step)
{
    if (!step->has_drift) {
        return NULL;
    }
    const double share = 0.125 * step->width_s * step->width_s;
    double *beyond = step->work.changes[0];
    step->adapter->push(step->own, step->start_s - step->middles_s[0], step->pressing, beyond);
    for (size_t i = 0; i < step->coordinate_count; i++) {
        beyond[i] = share * (beyond[i] + step->ahead[i]);
    }
    return beyond;
}

// The free accelerations in the step before, with what its contacts did to them; whether that was
// so little that they say how these change by themselves. Where there was none they are those of
// the start.
static void keep_free(KernelStep *step, double *free_before)
{
    const double *impulse = step->steady > 0 ? step->total.impulse : NULL;
    step->is_calm = kernel_columns_free_after(kernel_rows(&step->kernel), step->drift, impulse,
                                              step->kernel.free, free_before);
}

// The columns become those of the step before.
static void age_columns(KernelStep *step)
{
    double *oldest = step->columns[KERNEL_COLUMNS_KNOWN - 1];
    memmove(step->columns + 1, step->columns, (KERNEL_COLUMNS_KNOWN - 1) * sizeof *step->columns);
    memmove(step->middles_s + 1, step->middles_s,
            (KERNEL_COLUMNS_KNOWN - 1) * sizeof *step->middles_s);
    step->columns[0] = oldest;
    step->middles_s[0] = step->start_s + 0.5 * step->width_s;
}

// Lets what the rows feel change in the step: their mobility with the bodies, the free acceleration
// beside that as it did from the middle of the step before, when the contacts changed it by 2 S P,
// or from the start.
static void set_drift(KernelStep *step, const double *free_before)
{
    Kernel *kernel = &step->kernel;
    const double before_s = step->steady > 0 ? step->middles_s[1] : step->start_s;
    const double apart_s = step->middles_s[0] - before_s;
    for (size_t i = 0; i < kernel_rows(kernel); i++) {
        kernel->free_rate[i] = step->is_calm ? (kernel->free[i] - free_before[i]) / apart_s : 0.0;
    }
    kernel_set_drift(kernel, step->drift, step->width_s);
}

// Finds what the contacts feel of the world at mid-step.
static bool find_response(KernelStep *step)
{
    double *free_before = step->work.rows;
    double *gained = step->work.changes[0];
    if (step->has_drift) {
        keep_free(step, free_before);
        age_columns(step);
    }
    if (!step->adapter->respond(step->own)) {
        return false;
    }
    for (size_t i = 0; i < step->coordinate_count; i++) {
        gained[i] = 0.5 * step->width_s * step->ahead[i];
    }
    step->adapter->accelerate(step->own, gained);
    if (step->islands != NULL) {
        step->islands->coupling = step->coupling; // other rows may have been chosen
        return true;
    }
    kernel_fill(&step->kernel, &step->coupling, NULL);
    if (step->has_drift) {
        set_drift(step, free_before);
    }
    return true;
}

// Lets the contacts run through the step by themselves.
static bool run_contacts(KernelStep *step)
{
    Kernel *kernel = &step->kernel;
    const double width_s = step->width_s;
    if (step->islands != NULL) {
        if (!kernel_islands_run(step->islands, width_s)) {
            return false;
        }
        kernel_islands_look(step->islands, width_s, &step->total);
    } else {
        if (!kernel_run(kernel, width_s)) {
            return false;
        }
        kernel_at(kernel, kernel->node_count - 1, width_s, &step->total);
    }
    for (size_t i = 0; i < kernel_rows(kernel); i++) {
        step->pressing[i] = step->total.impulse[i] / width_s;
    }
    kernel_step_push(step, width_s, &step->total, step->moved[0], step->moved[1]);
    return true;
}

// Moves the end by when in the step the impulse came.
static void move_end(KernelStep *step)
{
    const double half_s = 0.5 * step->width_s;
    const double cube = step->width_s * step->width_s * step->width_s / 12.0;
    double *positions = step->work.changes[0];
    double *speeds = step->work.changes[1];
    // the world's step has the impulse along the rows of mid-step
    memset(speeds, 0, step->coordinate_count * sizeof *speeds);
    if (step->has_drift) {
        const KernelColumns columns = columns_of(step);
        kernel_columns_turn(&columns, step->width_s, step->total.impulse, step->total.moment,
                            speeds);
    }
    for (size_t i = 0; i < step->coordinate_count; i++) {
        positions[i] = kernel_columns_late(half_s, step->moved[1][i], step->moved[0][i], speeds[i]);
        if (step->has_drift && step->is_calm) {
            // accelerations that change beside the contacts'
            positions[i] -= cube * step->free_rate[i];
        }
    }
    step->adapter->shift(step->own, positions, speeds);
}

// Puts the end back onto the ideal joints. The rows are those of mid-step: one pass leaves speeds
// across the joints that fall as h^2, and with them an error that comes and goes with the length of
// the step; a second one leaves h^3.
static void put_back(KernelStep *step)
{
    const KernelAdapter *adapter = step->adapter;
    double *openings = step->work.ideal[0];
    double *rates = step->work.ideal[1];
    double *positions = step->work.changes[0];
    double *speeds = step->work.changes[1];
    adapter->find_openings(step->own, openings, rates);
    // the impulses that close the positions are of no interest
    adapter->close(step->own, openings, openings, positions);
    adapter->close(step->own, rates, step->closing, speeds);
    adapter->shift(step->own, positions, speeds);
    memcpy(step->closed, speeds, step->coordinate_count * sizeof *speeds);
    const size_t count = adapter->find_openings(step->own, openings, rates);
    adapter->close(step->own, rates, rates, speeds);
    memset(positions, 0, step->coordinate_count * sizeof *positions);
    adapter->shift(step->own, positions, speeds);
    for (size_t i = 0; i < count; i++) {
        step->closing[i] += rates[i];
    }
    for (size_t i = 0; i < step->coordinate_count; i++) {
        step->closed[i] = (step->closed[i] + speeds[i]) / step->width_s;
    }
}

// What the state inside the step is worked out from.
static void prepare_inside(KernelStep *step, double width_before_s)
{
    const double width_s = step->width_s;
    const double apart_s = 0.5 * (width_s + width_before_s);
    double *speeds = step->work.changes[0];
    double *gained = step->work.changes[1];
    double *moved = step->work.changes[2];
    step->adapter->compare(step->own, speeds, gained, moved);
    for (size_t i = 0; i < step->coordinate_count; i++) {
        double mean = (gained[i] - step->moved[0][i]) / width_s;
        if (width_s < SHORT * width_before_s) {
            mean = step->free[i] + apart_s * step->free_rate[i];
        } else {
            const double change = mean - step->free[i];
            step->free_rate[i] = width_before_s > 0.0 ? change / apart_s : 0.0;
        }
        step->free[i] = mean;
        const double bent =
            step->has_drift ? width_s * width_s * width_s / 12.0 * step->free_rate[i] : 0.0;
        step->rest[i] =
            moved[i] - width_s * (speeds[i] + 0.5 * width_s * mean) - step->moved[1][i] + bent;
    }
}

void kernel_step_begin(KernelStep *step)
{
    step->steady = step->count == 0 || step->is_kink ? 0 : step->steady + 1;
    step->start_s = step->end_s;
}

KernelStepEnd kernel_step_take(KernelStep *step)
{
    // accelerations before a kink say nothing of those after it
    const double width_before_s = step->steady == 0 ? 0.0 : step->width_s;
    step->width_s = step->end_s - step->start_s;
    if (!look_ahead(step)) {
        return KERNEL_STEP_REFUSED;
    }
    step->adapter->find_middle(step->own, find_beyond(step));
    if (!find_response(step)) {
        return KERNEL_STEP_REFUSED;
    }
    if (!run_contacts(step)) {
        return KERNEL_STEP_TOO_LONG;
    }
    if (!step->adapter->advance(step->own)) {
        return KERNEL_STEP_REFUSED;
    }
    move_end(step);
    put_back(step);
    prepare_inside(step, width_before_s);
    step->count++;
    return KERNEL_STEP_TAKEN;
}
