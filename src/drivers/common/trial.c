// Steps an engine with the contacts of pins in holes integrated within its steps, by trials.
//
// The scheme is that of drivers/mujoco/mujoco_kernel.c, with G(q, v, f) the engine's accelerations
// of the coordinates under forces f in the rows, F = J G + J' v those of the rows:
//     A = G(q_m, v_m, 1) - G(q_m, v_m, 0),  W = J A
//     2 S = (F(v_m + e A) - F(v_m)) / e,    B = (G(v_m + e A) - G(v_m)) / e
//     a + B Q/h + A P/h = G(q_m, v_m + A Q/h, P/h)
//     v' = v + h a + B Q + A P + A' (h/2 P - Q)
//     q' = q + h v + h^2/2 a - h^3/12 a' + B R + A Q + A' (h/2 Q - 2 R)
#include "drivers/common/trial.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { BEFORE = 3 }; // A of this step and those before, from which its rate follows

// of the velocities: what they are changed by for S
static const double NUDGE = 1e-3;

// of the free accelerations, what impulses may change them by in a step for these to say how they
// change by themselves
static const double CALM = 0.1;

// rad, that the fastest body turns in a short step: its square is the error of directions, and
// over it rounding is seen
static const double TRIAL_PHASE = 4e-4;

typedef struct Trial {
    const DriverCase *of;
    const Tree *tree;
    TrialAccelerate accelerate;
    void *engine;
    DriverRun *run;
    size_t rows;
    size_t count;   // coordinates
    size_t *joints; // by contact; owned, as all arrays
    Kernel kernel;
    KernelSums sums;
    double *q; // of the step's start; by coordinate, as the next ones
    double *v;
    double *q_next;
    double *v_next;
    double *q_middle;
    double *v_middle;
    double *a; // beside the contacts'
    double *a_rate;
    double *ahead; // a as it is to be expected: that of the step before, after its impulses
    double *free;  // G, at mid-step
    double *nudged;
    double *other;
    double *responses[BEFORE]; // A: row by row
    double *rate;              // A'
    double *jacobian;          // row by row
    double *bend;              // B
    double *drift;             // S
    double *free_before;       // by row
    double *work;
    DriverMotion *motions; // by body
    Vec2 *bends;
    TrialPush *pushes;
    size_t steps; // of the run
    bool is_calm;
} Trial;

static double *numbers(size_t count)
{
    double *room = calloc(count + 1, sizeof *room);
    if (room == NULL) {
        driver_fail("there is no memory");
    }
    return room;
}

// to += scale from
static void add(double *to, const double *from, double scale, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        to[i] += scale * from[i];
    }
}

static double dot(const double *a, const double *b, size_t count)
{
    double sum = 0.0;
    for (size_t i = 0; i < count; i++) {
        sum += a[i] * b[i];
    }
    return sum;
}

// Adds sums over the rows of A, or of A', to something by coordinate.
static void add_rows(const Trial *trial, const double *columns, const double *by_row, double scale,
                     double *target)
{
    for (size_t k = 0; k < trial->rows; k++) {
        add(target, columns + k * trial->count, scale * by_row[k], trial->count);
    }
}

// The engine's accelerations under forces in the rows; NULL: none.
static void evaluate(Trial *trial, const double *q, const double *v, const double *forces,
                     double scale, double *a)
{
    size_t count = 0;
    for (size_t i = 0; forces != NULL && i < trial->rows; i += 2) {
        const DriverJoint *joint = &trial->of->joints[trial->joints[i / 2]];
        const Vec2 force = {scale * forces[i], scale * forces[i + 1]};
        for (int side = 0; side < 2; side++) {
            if (joint->bodies[side] != DRIVER_GROUND) {
                trial->pushes[count++] = (TrialPush){joint->bodies[side], joint->anchors[side],
                                                     vec2_scale(side == 0 ? -1.0 : 1.0, force)};
            }
        }
    }
    trial->accelerate(trial->engine, q, v, trial->pushes, count, a);
    trial->run->steps++;
}

// J at the positions of the motions.
static void find_jacobian(Trial *trial)
{
    memset(trial->jacobian, 0, trial->rows * trial->count * sizeof *trial->jacobian);
    for (size_t i = 0; i < trial->rows; i++) {
        const DriverJoint *joint = &trial->of->joints[trial->joints[i / 2]];
        const Vec2 unit = {i % 2 == 0 ? 1.0 : 0.0, i % 2 == 0 ? 0.0 : 1.0};
        double *row = trial->jacobian + i * trial->count;
        tree_push(trial->tree, trial->motions, joint->bodies[1], joint->anchors[1], unit, row);
        tree_push(trial->tree, trial->motions, joint->bodies[0], joint->anchors[0],
                  vec2_scale(-1.0, unit), row);
    }
}

// What the velocities alone accelerate a point of a body by.
static Vec2 bend_of(const Trial *trial, int body, Vec2 local)
{
    if (body == DRIVER_GROUND) {
        return (Vec2){0.0, 0.0};
    }
    const DriverMotion *motion = &trial->motions[body];
    const Vec2 arm = vec2_rotate(motion->angle, local);
    return vec2_sub(trial->bends[body], vec2_scale(motion->omega * motion->omega, arm));
}

// u'' = J a + J' v at the middle's positions and velocities like those there.
static void find_row_accelerations(Trial *trial, const double *v, const double *a, double *rows)
{
    tree_motions(trial->tree, trial->q_middle, v, trial->motions);
    tree_bends(trial->tree, trial->motions, v, trial->bends);
    for (size_t i = 0; i < trial->rows; i += 2) {
        const DriverJoint *joint = &trial->of->joints[trial->joints[i / 2]];
        const Vec2 bend = vec2_sub(bend_of(trial, joint->bodies[1], joint->anchors[1]),
                                   bend_of(trial, joint->bodies[0], joint->anchors[0]));
        rows[i] = bend.x + dot(trial->jacobian + i * trial->count, a, trial->count);
        rows[i + 1] = bend.y + dot(trial->jacobian + (i + 1) * trial->count, a, trial->count);
    }
}

// A and W, from a trial with a force in each row: one that does as much as all that acts.
static void find_response(Trial *trial)
{
    double *oldest = trial->responses[BEFORE - 1];
    memmove(trial->responses + 1, trial->responses, (BEFORE - 1) * sizeof *trial->responses);
    trial->responses[0] = oldest;
    const double size = 1.0 + sqrt(dot(trial->free, trial->free, trial->count));
    for (size_t k = 0; k < trial->rows; k++) {
        double *response = oldest + k * trial->count;
        memset(trial->work, 0, trial->rows * sizeof *trial->work);
        trial->work[k] = 1.0;
        evaluate(trial, trial->q_middle, trial->v_middle, trial->work, size, response);
        for (size_t i = 0; i < trial->count; i++) {
            response[i] = (response[i] - trial->free[i]) / size;
        }
    }
    for (size_t i = 0; i < trial->rows; i++) {
        for (size_t k = 0; k < trial->rows; k++) {
            *kernel_mobility(&trial->kernel, i, k) =
                dot(trial->jacobian + i * trial->count, oldest + k * trial->count, trial->count);
        }
    }
}

// S and B, by a velocity that is a little different for each row.
static void find_drift(Trial *trial)
{
    const size_t count = trial->count;
    const double speed = sqrt(dot(trial->v_middle, trial->v_middle, count));
    for (size_t k = 0; k < trial->rows; k++) {
        const double *response = trial->responses[0] + k * count;
        const double nudge =
            NUDGE * (speed > 0.0 ? speed : 1.0) / sqrt(dot(response, response, count));
        memcpy(trial->nudged, trial->v_middle, count * sizeof *trial->nudged);
        add(trial->nudged, response, nudge, count);
        evaluate(trial, trial->q_middle, trial->nudged, NULL, 0.0, trial->other);
        find_row_accelerations(trial, trial->nudged, trial->other, trial->work);
        for (size_t i = 0; i < count; i++) {
            trial->bend[k * count + i] = (trial->other[i] - trial->free[i]) / nudge;
        }
        for (size_t i = 0; i < trial->rows; i++) {
            trial->drift[i * trial->rows + k] =
                (trial->work[i] - trial->kernel.free[i]) / (2.0 * nudge);
        }
    }
}

// A' at the middle of the step, from A there and in the steps before.
static void find_rate(Trial *trial, double step_s)
{
    for (size_t i = 0; i < trial->rows * trial->count; i++) {
        const double now = trial->responses[0][i];
        const double last = trial->responses[1][i];
        const double first = trial->responses[2][i];
        trial->rate[i] = trial->steps == 0   ? 0.0
                         : trial->steps == 1 ? (now - last) / step_s
                                             : (1.5 * now - 2.0 * last + 0.5 * first) / step_s;
    }
}

// What the free accelerations are behind the step's impulses, to see how they change by themselves.
static void keep_free(Trial *trial)
{
    double size = 0.0;
    double pushed = 0.0;
    for (size_t i = 0; i < trial->rows; i++) {
        const double change =
            2.0 * dot(trial->drift + i * trial->rows, trial->sums.impulse, trial->rows);
        trial->free_before[i] = trial->kernel.free[i] + change;
        size = fmax(size, fabs(trial->kernel.free[i]));
        pushed = fmax(pushed, fabs(change));
    }
    trial->is_calm = pushed <= CALM * size;
}

static void find_free_rate(Trial *trial, double step_s)
{
    for (size_t i = 0; i < trial->rows; i++) {
        const bool is_known = trial->steps > 1 && trial->is_calm;
        trial->kernel.free_rate[i] =
            is_known ? (trial->kernel.free[i] - trial->free_before[i]) / step_s : 0.0;
    }
}

// Where the rows are at the step's start, and how fast they go.
static void find_rows(Trial *trial)
{
    tree_motions(trial->tree, trial->q, trial->v, trial->motions);
    for (size_t i = 0; i < trial->rows; i += 2) {
        const DriverJoint *joint = &trial->of->joints[trial->joints[i / 2]];
        const PinHole pose = driver_pose(joint, trial->motions);
        const Vec2 going =
            vec2_sub(driver_point_velocity(trial->motions, joint->bodies[1], joint->anchors[1]),
                     driver_point_velocity(trial->motions, joint->bodies[0], joint->anchors[0]));
        trial->kernel.position[i] = pose.eccentricity.x;
        trial->kernel.position[i + 1] = pose.eccentricity.y;
        trial->kernel.speed[i] = going.x;
        trial->kernel.speed[i + 1] = going.y;
    }
}

// Positions and velocities at a time in the step, from the kernel's sums then.
static void find_inside(const Trial *trial, double since_s, double step_s, const KernelSums *sums,
                        double *q, double *v)
{
    const size_t count = trial->count;
    const double off_s = since_s - 0.5 * step_s;
    memcpy(q, trial->q, count * sizeof *q);
    memcpy(v, trial->v, count * sizeof *v);
    add(q, trial->v, since_s, count);
    add(q, trial->a, 0.5 * since_s * since_s, count);
    add(q, trial->a_rate, since_s * (since_s / 6.0 - 0.25 * step_s) * since_s, count);
    add(v, trial->a, since_s, count);
    add(v, trial->a_rate, 0.5 * since_s * (since_s - step_s), count);
    add_rows(trial, trial->responses[0], sums->impulse, 1.0, v);
    add_rows(trial, trial->bend, sums->moment, 1.0, v);
    add_rows(trial, trial->rate, sums->impulse, off_s, v);
    add_rows(trial, trial->rate, sums->moment, -1.0, v);
    add_rows(trial, trial->responses[0], sums->moment, 1.0, q);
    add_rows(trial, trial->bend, sums->moment + trial->rows, 1.0, q);
    add_rows(trial, trial->rate, sums->moment, off_s, q);
    add_rows(trial, trial->rate, sums->moment + trial->rows, -2.0, q);
}

// Mid-step, with the velocities that are to be expected there.
static void find_middle(Trial *trial, double step_s)
{
    const size_t count = trial->count;
    memcpy(trial->ahead, trial->a, count * sizeof *trial->ahead);
    add_rows(trial, trial->bend, trial->sums.impulse, 1.0, trial->ahead);
    memcpy(trial->q_middle, trial->q, count * sizeof *trial->q);
    memcpy(trial->v_middle, trial->v, count * sizeof *trial->v);
    add(trial->q_middle, trial->v, 0.5 * step_s, count);
    add(trial->q_middle, trial->ahead, 0.125 * step_s * step_s, count);
    add_rows(trial, trial->responses[0], trial->sums.impulse, 0.125 * step_s, trial->q_middle);
    add(trial->v_middle, trial->ahead, 0.5 * step_s, count);
}

// The engine at mid-step under the contacts' mean force: `a`, and how it has changed.
static void find_accelerations(Trial *trial, double step_s)
{
    const double per_s = 1.0 / step_s;
    memcpy(trial->nudged, trial->v_middle, trial->count * sizeof *trial->nudged);
    add_rows(trial, trial->responses[0], trial->sums.moment, per_s, trial->nudged);
    evaluate(trial, trial->q_middle, trial->nudged, trial->sums.impulse, per_s, trial->a);
    add_rows(trial, trial->responses[0], trial->sums.impulse, -per_s, trial->a);
    add_rows(trial, trial->bend, trial->sums.moment, -per_s, trial->a);
    for (size_t i = 0; i < trial->count; i++) {
        const bool is_known = trial->steps > 1 && trial->is_calm;
        trial->a_rate[i] = is_known ? (trial->a[i] - trial->ahead[i]) / step_s : 0.0;
    }
}

static void take_step(Trial *trial, double step_s)
{
    find_middle(trial, step_s);
    keep_free(trial);
    tree_motions(trial->tree, trial->q_middle, trial->v_middle, trial->motions);
    find_jacobian(trial);
    evaluate(trial, trial->q_middle, trial->v_middle, NULL, 0.0, trial->free);
    find_response(trial);
    find_rate(trial, step_s);
    find_row_accelerations(trial, trial->v_middle, trial->free, trial->kernel.free);
    find_drift(trial);
    find_free_rate(trial, step_s);
    find_rows(trial);
    kernel_set_drift(&trial->kernel, trial->drift, step_s);
    if (!kernel_run(&trial->kernel, step_s)) {
        driver_fail("the contacts took more than 100000 local steps in one step");
    }
    kernel_at(&trial->kernel, trial->kernel.node_count - 1, step_s, &trial->sums);
    find_accelerations(trial, step_s);
    find_inside(trial, step_s, step_s, &trial->sums, trial->q_next, trial->v_next);
}

// The bodies at a time in the step that has been taken.
static void read_inside(void *adapter, double since_s, const KernelSums *sums,
                        DriverMotion *motions)
{
    Trial *trial = adapter;
    find_inside(trial, since_s, trial->of->step_s, sums, trial->nudged, trial->other);
    tree_motions(trial->tree, trial->nudged, trial->other, motions);
}

static void make_numbers(Trial *trial)
{
    const size_t block = trial->rows * trial->count;
    double **by_coordinate[] = {&trial->q,        &trial->v,        &trial->q_next, &trial->v_next,
                                &trial->q_middle, &trial->v_middle, &trial->a,      &trial->a_rate,
                                &trial->ahead,    &trial->free,     &trial->nudged, &trial->other};
    for (size_t i = 0; i < sizeof by_coordinate / sizeof *by_coordinate; i++) {
        *by_coordinate[i] = numbers(trial->count);
    }
    for (size_t i = 0; i < BEFORE; i++) {
        trial->responses[i] = numbers(block);
    }
    trial->rate = numbers(block);
    trial->jacobian = numbers(block);
    trial->bend = numbers(block);
    trial->drift = numbers(trial->rows * trial->rows);
    trial->free_before = numbers(trial->rows);
    trial->work = numbers(trial->rows);
}

static void *room(size_t count, size_t size)
{
    void *made = calloc(count + 1, size);
    if (made == NULL) {
        driver_fail("there is no memory");
    }
    return made;
}

static Trial make(const Tree *tree, TrialAccelerate accelerate, void *engine, DriverRun *run)
{
    const DriverCase *of = tree->of;
    if (tree->left_count > 0) {
        driver_refuse("contacts within the step beside a loop of ideal joints");
    }
    Trial trial = {.of = of,
                   .tree = tree,
                   .accelerate = accelerate,
                   .engine = engine,
                   .run = run,
                   .count = tree->coordinates,
                   .joints = room(of->joint_count, sizeof *trial.joints),
                   .kernel = kernel_start(0.0),
                   .motions = room(of->body_count, sizeof *trial.motions),
                   .bends = room(of->body_count, sizeof *trial.bends),
                   .pushes = room(2 * of->joint_count, sizeof *trial.pushes)};
    within_add_contacts(of, &trial.kernel, trial.joints);
    trial.rows = kernel_rows(&trial.kernel);
    trial.sums = kernel_sums(trial.rows);
    make_numbers(&trial);
    return trial;
}

void trial_run(const Tree *tree, TrialAccelerate accelerate, void *engine, DriverRun *run)
{
    Trial trial = make(tree, accelerate, engine, run);
    const double step_s = tree->of->step_s;
    DriverContact *states = room(tree->of->joint_count, sizeof *states);
    KernelSums sums = kernel_sums(trial.rows);
    const WithinStep still = {.kernel = &trial.kernel,
                              .joints = trial.joints,
                              .states = states,
                              .step_s = step_s,
                              .motions = read_inside,
                              .adapter = &trial,
                              .room = room(tree->of->body_count, sizeof(DriverMotion)),
                              .sums = &sums};
    for (size_t i = 0; i < tree->of->joint_count; i++) {
        states[i].state = tree->of->joints[i].contact;
    }
    driver_run_begin(run);
    tree_start(tree, trial.v);
    evaluate(&trial, trial.q, trial.v, NULL, 0.0, trial.a);
    while (!driver_run_is_full(run)) {
        WithinStep step = still;
        step.start_s = step_s * (double)trial.steps;
        take_step(&trial, step_s);
        trial.steps++;
        within_look(&step, run);
        memcpy(trial.q, trial.q_next, trial.count * sizeof *trial.q);
        memcpy(trial.v, trial.v_next, trial.count * sizeof *trial.v);
    }
    driver_run_write(run);
}

// Engines whose coordinates are those of bodies.

double trial_step(const DriverCase *of)
{
    double fastest = 0.0;
    for (size_t i = 0; i < of->body_count; i++) {
        fastest = fmax(fastest, fabs(of->bodies[i].start.omega));
    }
    return fastest > 0.0 ? fmin(of->step_s, TRIAL_PHASE / fastest) : of->step_s;
}

void trial_place(const Tree *tree, const double *q, const double *v, double step_s,
                 DriverMotion *motions, Vec2 *bends)
{
    tree_motions(tree, q, v, motions);
    tree_bends(tree, motions, v, bends);
    for (size_t i = 0; i < tree->of->body_count; i++) {
        motions[i].position = vec2_sub(motions[i].position, vec2_scale(step_s * step_s, bends[i]));
    }
}

void trial_read(const Tree *tree, const DriverMotion *before, const DriverMotion *after,
                const Vec2 *bends, double step_s, double *a)
{
    for (size_t i = 0; i < tree->of->body_count; i++) {
        const TreeBody *body = &tree->bodies[i];
        const bool has_parent = body->parent != DRIVER_GROUND;
        const double turning = (after[i].omega - before[i].omega) / step_s;
        const double carried =
            has_parent ? (after[body->parent].omega - before[body->parent].omega) / step_s : 0.0;
        const Vec2 going = vec2_sub(
            vec2_scale(1.0 / step_s, vec2_sub(after[i].velocity, before[i].velocity)), bends[i]);
        double *own = a + body->first;
        if (body->kind == TREE_FREE) {
            own[0] = going.x;
            own[1] = going.y;
            own[2] = turning;
        } else if (body->kind == TREE_TURNS) {
            own[0] = turning - carried;
        } else {
            Vec2 held = {0.0, 0.0};
            Vec2 from = {0.0, 0.0};
            if (has_parent) {
                held = vec2_sub(vec2_scale(1.0 / step_s, vec2_sub(after[body->parent].velocity,
                                                                  before[body->parent].velocity)),
                                bends[body->parent]);
                from = before[body->parent].position;
            }
            const Vec2 arm = vec2_sub(before[i].position, from);
            const Vec2 moved = vec2_add(held, vec2_scale(carried, vec2_perp(arm)));
            own[0] = vec2_dot(vec2_rotate(before[i].angle, body->axis), vec2_sub(going, moved));
        }
    }
}
