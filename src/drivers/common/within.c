// Steps in an engine's coordinates whose contacts the kernel integrates, and what is seen in them:
// samples, records and totals.
#include "drivers/common/within.h"

#include "kernel/marks.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// of the largest velocities: what a step may change them by through the second power of what its
// impulses change in it, some tens of times the error
static const double ROUGH_LEAST = 2e-7;

// of the velocities: what changes them less is resolved by the step
static const double CHANGE_LEAST = 0.1;

// of the largest velocities: slower ones are as these
static const double SLOW = 1e-3;

static void add_contacts(const DriverCase *of, Within *in)
{
    for (size_t i = 0; i < of->place_count + of->rub_count; i++) {
        const KernelContact contact = place_contact(&of->places[i]);
        const bool has_turns = contact.shape != KERNEL_LINE && contact.law.friction > 0.0;
        kernel_add(&in->kernel, &contact, has_turns ? KERNEL_ROWS_PLANE : KERNEL_ROWS_PLAIN);
    }
    in->rows = kernel_rows(&in->kernel);
    kernel_make_room(&in->kernel, in->rows);
    kernel_make_drift(&in->kernel);
    in->sums = kernel_sums(in->rows);
}

static double *numbers(size_t count)
{
    return driver_room(count, sizeof(double));
}

void within_open(const DriverCase *of, size_t count, Within *in)
{
    *in = (Within){.of = of, .count = count, .kernel = kernel_start(0.0)};
    add_contacts(of, in);
    double **by_coordinate[] = {&in->q,     &in->v,        &in->q_next,   &in->v_next,
                                &in->a,     &in->a_rate,   &in->a_bend,   &in->a_change,
                                &in->ahead, &in->q_middle, &in->v_middle, &in->free,
                                &in->nudged};
    for (size_t i = 0; i < sizeof by_coordinate / sizeof *by_coordinate; i++) {
        *by_coordinate[i] = numbers(count);
    }
    double **by_block[] = {&in->response,    &in->rate,     &in->bend_rate,
                           &in->bend_before, &in->jacobian, &in->bend};
    for (size_t i = 0; i < sizeof by_block / sizeof *by_block; i++) {
        *by_block[i] = numbers(in->rows * count);
    }
    in->drift = numbers(in->rows * in->rows);
    in->free_before = numbers(in->rows);
    in->work = numbers(in->rows);
}

// to += scale from
static void add(double *to, const double *from, double scale, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        to[i] += scale * from[i];
    }
}

static double size_of(const double *numbers, size_t count)
{
    double sum = 0.0;
    for (size_t i = 0; i < count; i++) {
        sum += numbers[i] * numbers[i];
    }
    return sqrt(sum);
}

void within_add_rows(const Within *in, const double *columns, const double *by_row, double scale,
                     double *target)
{
    for (size_t k = 0; k < in->rows; k++) {
        add(target, columns + k * in->count, scale * by_row[k], in->count);
    }
}

void within_start(Within *in)
{
    in->known = 0;
    in->before_s = 0.0;
    in->calm_steps = 0;
    in->fastest = fmax(in->fastest, size_of(in->v, in->count));
    memset(in->a_rate, 0, in->count * sizeof *in->a_rate);
    memset(in->a_bend, 0, in->count * sizeof *in->a_bend);
    memset(in->a_change, 0, in->count * sizeof *in->a_change);
    memset(in->sums.impulse, 0, in->rows * sizeof *in->sums.impulse);
}

void within_find_middle(Within *in, double step_s)
{
    const size_t count = in->count;
    memcpy(in->ahead, in->a, count * sizeof *in->ahead);
    within_add_rows(in, in->bend, in->sums.impulse, 1.0, in->ahead);
    memcpy(in->q_middle, in->q, count * sizeof *in->q);
    memcpy(in->v_middle, in->v, count * sizeof *in->v);
    add(in->q_middle, in->v, 0.5 * step_s, count);
    add(in->q_middle, in->ahead, 0.125 * step_s * step_s, count);
    if (in->known > 0) {
        within_add_rows(in, in->response, in->sums.impulse, 0.125 * step_s * step_s / in->before_s,
                        in->q_middle);
    }
    // the parabola of the last step, about its middle, from its end to half a step behind that
    const double from = 0.5 * in->before_s;
    const double to = from + 0.5 * step_s;
    add(in->v_middle, in->ahead, 0.5 * step_s, count);
    add(in->v_middle, in->a_rate, 0.5 * (to * to - from * from), count);
    add(in->v_middle, in->a_bend, (to * to * to - from * from * from) / 6.0, count);
}

double within_apart(const Within *in, double step_s)
{
    return 0.5 * (in->before_s + step_s);
}

void within_keep_free(Within *in)
{
    const bool is_calm = kernel_columns_free_after(in->rows, in->drift, in->sums.impulse,
                                                   in->kernel.free, in->free_before);
    in->calm_steps = in->known > 0 && is_calm ? in->calm_steps + 1 : 0;
}

void within_find_free_rate(Within *in, double step_s)
{
    for (size_t i = 0; i < in->rows; i++) {
        in->kernel.free_rate[i] = in->calm_steps > 0 ? (in->kernel.free[i] - in->free_before[i]) /
                                                           within_apart(in, step_s)
                                                     : 0.0;
    }
}

bool within_has_pushed(const Within *in)
{
    bool has = false;
    for (size_t i = 0; i < in->rows; i++) {
        has = has || in->sums.impulse[i] != 0.0;
    }
    return has;
}

void within_find_rows(Within *in, const DriverMotion *motions)
{
    for (size_t i = 0; i < in->kernel.contact_count; i++) {
        const DriverPlace *place = &in->of->places[i];
        const KernelContact *contact = &in->kernel.contacts[i];
        place_position(place, motions, in->kernel.position + contact->first_row);
        PlaceRow first[KERNEL_ROW_TURN];
        place_rows(place, motions, first);
        for (size_t k = 0; k < contact->row_count; k++) {
            const PlaceRow row = k < KERNEL_ROW_TURN ? first[k] : place_row(place, motions, k);
            in->kernel.speed[contact->first_row + k] = place_rate(place, &row, motions);
        }
    }
}

void within_integrate(Within *in, double step_s)
{
    kernel_set_drift(&in->kernel, in->drift, step_s);
    if (!kernel_run(&in->kernel, step_s)) {
        driver_fail("the contacts took more than 100000 local steps in one step");
    }
    kernel_at(&in->kernel, in->kernel.node_count - 1, step_s, &in->sums);
}

// Leaves what the impulses do by such columns in `nudged`, and returns its size.
static double push_by(const Within *in, const double *columns)
{
    memset(in->nudged, 0, in->count * sizeof *in->nudged);
    within_add_rows(in, columns, in->sums.impulse, 1.0, in->nudged);
    return size_of(in->nudged, in->count);
}

bool within_is_rough(const Within *in, double step_s)
{
    const double bent = push_by(in, in->bend);
    const double pushed = push_by(in, in->response);
    add(in->nudged, in->free, step_s, in->count);
    const double change = size_of(in->nudged, in->count);
    const double speed = fmax(size_of(in->v_middle, in->count), SLOW * in->fastest);
    // not of the first: friction has only been found to hold in it
    return in->known > 0 && change > CHANGE_LEAST * speed &&
           step_s * bent * change * change > ROUGH_LEAST * pushed * speed * in->fastest;
}

void within_carry(Within *in, Carry *carry)
{
    kernel_carry(&in->kernel, carry);
    CARRY_ARRAY(carry, in->sums.impulse, in->rows);
    CARRY_ARRAY(carry, in->response, in->rows * in->count);
    CARRY_ARRAY(carry, in->bend, in->rows * in->count);
    CARRY_ARRAY(carry, in->drift, in->rows * in->rows);
    CARRY(carry, in->calm_steps);
}

void within_take_accelerations(Within *in, const double *a, double step_s)
{
    const double apart_s = within_apart(in, step_s);
    memcpy(in->a, a, in->count * sizeof *in->a);
    within_add_rows(in, in->response, in->sums.impulse, -1.0 / step_s, in->a);
    within_add_rows(in, in->bend, in->sums.moment, -1.0 / step_s, in->a);
    for (size_t i = 0; i < in->rows * in->count; i++) {
        in->bend_rate[i] = in->known > 0 ? (in->bend[i] - in->bend_before[i]) / apart_s : 0.0;
        in->bend_before[i] = in->bend[i];
    }
    for (size_t i = 0; i < in->count; i++) {
        const double before = in->a_change[i];
        in->a_change[i] = in->calm_steps > 0 ? (in->a[i] - in->ahead[i]) / apart_s : 0.0;
        in->a_bend[i] = in->calm_steps > 1 ? (in->a_change[i] - before) / apart_s : 0.0;
        in->a_rate[i] = in->a_change[i] + 0.5 * step_s * in->a_bend[i];
    }
}

// Adds what the accelerations beside the contacts do up to a time: a parabola about mid-step,
// a + a' t + a''/2 t^2.
static void add_beside(const Within *in, double since_s, double middle_s, double *q, double *v)
{
    const double t = since_s - middle_s;
    const double cube = middle_s * middle_s * middle_s;
    add(v, in->a, since_s, in->count);
    add(v, in->a_rate, 0.5 * (t * t - middle_s * middle_s), in->count);
    add(v, in->a_bend, (t * t * t + cube) / 6.0, in->count);
    add(q, in->v, since_s, in->count);
    add(q, in->a, 0.5 * since_s * since_s, in->count);
    add(q, in->a_rate, since_s * (since_s / 6.0 - 0.5 * middle_s) * since_s, in->count);
    add(q, in->a_bend, (t * t * t * t + cube * (4.0 * since_s - middle_s)) / 24.0, in->count);
}

void within_find_inside(const Within *in, double since_s, double step_s, const KernelSums *sums,
                        double *q, double *v)
{
    const double off_s = since_s - 0.5 * step_s;
    const double *second = sums->moment + in->rows; // integral of the moment
    memcpy(q, in->q, in->count * sizeof *q);
    memcpy(v, in->v, in->count * sizeof *v);
    add_beside(in, since_s, 0.5 * step_s, q, v);
    const KernelColumns columns = {
        .rows = in->rows, .coordinates = in->count, .columns = in->response, .rates = in->rate};
    kernel_columns_push(&columns, off_s, sums->impulse, sums->moment, v, q);
    within_add_rows(in, in->bend, sums->moment, 1.0, v);
    within_add_rows(in, in->bend_rate, sums->moment, off_s, v);
    within_add_rows(in, in->bend_rate, second, -1.0, v);
    within_add_rows(in, in->bend, second, 1.0, q);
}

void within_find_end(Within *in, double step_s)
{
    within_find_inside(in, step_s, step_s, &in->sums, in->q_next, in->v_next);
}

void within_go_on(Within *in, double step_s)
{
    in->known++;
    in->before_s = step_s;
    memcpy(in->q, in->q_next, in->count * sizeof *in->q);
    memcpy(in->v, in->v_next, in->count * sizeof *in->v);
    in->fastest = fmax(in->fastest, size_of(in->v, in->count));
}

// The force of a place on body b from those in its rows; of a torque that, and 0.
static Vec2 force_of(const DriverPlace *place, const DriverMotion *motions, const double *in_rows)
{
    Vec2 force = {0.0, 0.0};
    PlaceRow rows[KERNEL_ROW_TURN];
    place_rows(place, motions, rows);
    for (size_t k = 0; k < KERNEL_ROW_TURN; k++) {
        force = vec2_add(force, place_force(place, &rows[k], in_rows[k]));
    }
    return force;
}

static void make_samples(const WithinStep *step, DriverRun *run)
{
    const Kernel *kernel = step->kernel;
    while (!driver_run_is_full(run) && driver_run_next(run) <= step->start_s + step->step_s) {
        const double since_s = driver_run_next(run) - step->start_s;
        DriverMotion *motions = driver_run_motions(run);
        kernel_at(kernel, kernel_node(kernel, since_s), since_s, step->sums);
        step->motions(step->adapter, since_s, step->sums, motions);
        for (size_t i = 0; i < run->of->place_count; i++) {
            const DriverPlace *place = &run->of->places[i];
            const double *in_rows = step->sums->force + kernel->contacts[i].first_row;
            Vec2 *force = &driver_run_forces(run)[place->joint];
            *force = vec2_add(*force, force_of(place, motions, in_rows));
        }
        driver_run_sampled(run);
    }
}

// The force of a contact at a share of the interval behind a node.
static double force_between(const Kernel *kernel, size_t contact, size_t node, double share)
{
    double impulse[KERNEL_ROWS_MOST];
    double moment[KERNEL_ROWS_MOST];
    double force[KERNEL_ROWS_MOST];
    const double *times = kernel->times + node;
    kernel_contact_at(kernel, contact, node, times[0] + share * (times[1] - times[0]), impulse,
                      moment, force);
    return hypot(force[0], force[1]);
}

// The largest force within the interval behind a node: that of the kernel where a cubic through
// four of its forces, at the ends and thirds, has its top; 0 where that has none inside. Marks need
// a node on either side of one, which short steps have not.
static double top_between(const Kernel *kernel, size_t contact, size_t node)
{
    double forces[4];
    for (int i = 0; i < 4; i++) {
        forces[i] = force_between(kernel, contact, node, i / 3.0);
    }
    // f' = a u^2 + b u + c, u from 0 to 3
    const double first = forces[1] - forces[0];
    const double second = forces[2] - 2.0 * forces[1] + forces[0];
    const double third = forces[3] - 3.0 * forces[2] + 3.0 * forces[1] - forces[0];
    const double a = 0.5 * third;
    const double b = second - third;
    const double c = first - 0.5 * second + third / 3.0;
    const double root = sqrt(fmax(b * b - 4.0 * a * c, 0.0));
    const double at = 2.0 * c / (root - b);
    return at > 0.0 && at < 3.0 ? force_between(kernel, contact, node, at / 3.0) : 0.0;
}

// Notes which contacts touch from a node on, how fast those come that begin there, and how hard
// they press up to the next.
static void note_contacts(const WithinStep *step, size_t node, DriverRun *run)
{
    const Kernel *kernel = step->kernel;
    for (size_t i = 0; i < run->of->place_count; i++) {
        const int joint = run->of->places[i].joint;
        ContactState *state = &step->states[i].state;
        const bool touches = kernel_touches(kernel, node, i);
        if (touches && !state->is_touching) {
            const double time_s = kernel->times[node];
            kernel_at(kernel, node, time_s, step->sums);
            run->totals[joint].begun++;
            run->totals[joint].approach =
                kernel_pose(kernel, i, node, time_s, step->sums).pose.approach_speed;
        }
        state->is_touching = touches;
        if (touches && node + 1 < kernel->node_count) {
            double *force_max = &run->touches[joint].force_max;
            *force_max = fmax(*force_max, top_between(kernel, i, node));
        }
    }
}

// What of each joint stands for the part of the step that ends at a mark, with what marks at its
// start have shown. Of several places forces are added up.
static void look_at(const WithinStep *step, const Mark *mark, DriverRun *run)
{
    const Kernel *kernel = step->kernel;
    const size_t count = run->of->place_count;
    for (size_t i = 0; i < count;) {
        const DriverPlace *place = &run->of->places[i];
        DriverTouch *touch = &run->touches[place->joint];
        DriverTotals *totals = &run->totals[place->joint];
        double size = 0.0;
        double least = INFINITY;
        for (; i < count && run->of->places[i].joint == place->joint; i++) {
            const KernelPose at = kernel_pose(kernel, i, mark->node, mark->time_s, step->sums);
            size += at.is_touching ? vec2_length(at.force) : 0.0;
            least = fmin(least, at.pose.gap);
            touch->depth_max = fmax(touch->depth_max, at.is_touching ? at.pose.penetration : 0.0);
            touch->eccentricity =
                place->shape == DRIVER_HOLE ? at.pose.eccentricity : (Vec2){least, 0.0};
        }
        touch->force_max = fmax(touch->force_max, size);
        touch->approach = totals->approach;
        totals->force_max = fmax(totals->force_max, touch->force_max);
        totals->depth_max = fmax(totals->depth_max, touch->depth_max);
    }
}

// Records the part up to a mark, from a time in the step and the impulses there.
static void record_part(const WithinStep *step, double from_s, const double *before,
                        const Mark *mark, DriverRun *run)
{
    const Kernel *kernel = step->kernel;
    const double per_s = 1.0 / (mark->time_s - from_s);
    step->motions(step->adapter, mark->time_s, step->sums, step->room);
    for (size_t i = 0; i < run->of->place_count; i++) {
        const DriverPlace *place = &run->of->places[i];
        const size_t row = kernel->contacts[i].first_row;
        const double *after = step->sums->impulse;
        const double mean[2] = {per_s * (after[row] - before[row]),
                                per_s * (after[row + 1] - before[row + 1])};
        Vec2 *force = &run->touches[place->joint].force;
        *force = vec2_add(*force, force_of(place, step->room, mean));
    }
    driver_run_record(run, step->start_s + from_s, step->start_s + mark->time_s, step->room,
                      run->touches);
    for (size_t i = 0; i < run->of->place_count; i++) {
        run->touches[run->of->places[i].joint] = (DriverTouch){.force_max = 0.0};
    }
}

void within_look(const WithinStep *step, DriverRun *run)
{
    const Kernel *kernel = step->kernel;
    const size_t rows = kernel_rows(kernel);
    double *before = numbers(rows);
    double from_s = 0.0;
    size_t noted = 0;
    Marks marks = {.count = 0};
    make_samples(step, run);
    marks_find(&marks, kernel);
    for (size_t i = 0; i < marks.count; i++) {
        const Mark *mark = &marks.marks[i];
        for (; noted <= mark->node; noted++) {
            note_contacts(step, noted, run);
        }
        kernel_at(kernel, mark->node, mark->time_s, step->sums);
        look_at(step, mark, run);
        if (run->of->record_s > 0.0 && mark->time_s > from_s) {
            record_part(step, from_s, before, mark, run);
            memcpy(before, step->sums->impulse, rows * sizeof *before);
            from_s = mark->time_s;
        }
    }
    for (; noted < kernel->node_count; noted++) {
        note_contacts(step, noted, run);
    }
    marks_finish(&marks);
    free(before);
}
