// Steps MuJoCo with the contacts of pins in holes integrated within its steps.
//
// q and v are MuJoCo's positions and velocities, both at the time t; u the rows, two a pin: pin
// less hole, in the world's x and y; J their Jacobian, A = M^-1 J' what a unit impulse in a row
// does to v, W = J A. A step h:
//     q_m = q + h/2 v + h^2/8 (a + A P/h), v_m = v + h/2 a     a, P, A of the step before
//     W, A, g = u'' without contacts, at q_m and v_m
//     P, Q, R                                       the kernel's impulses, and their integrals
//     v^ = v + h/2 a + A Q/h                        the mean velocity, with what the contacts do
//     a + B Q/h + A P/h from MuJoCo's step at q_m, v^, under the mean force P/h
//     v' = v + h a + B Q + A P + A' (h/2 P - Q)
//     q' = q + h v + h^2/2 a - h^3/12 a' + B R + A Q + A' (h/2 Q - 2 R)
// The accelerations without contacts are quadratic in v. Those of the rows, F(v), an impulse P
// changes by 2 S P, those of the coordinates, G(v), by B P:
//     2 S = (F(v + e A) - F(v)) / e,   B = (G(v + e A) - G(v)) / e,   e small;   W' = S + S'
#include "drivers/common/within.h"
#include "drivers/mujoco/mujoco_driver.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { BEFORE = 3 }; // A of this step and those before, from which its rate follows

// of the velocities: what they are changed by for S
static const double NUDGE = 1e-5;

// of the free accelerations, what impulses may change them by in a step for these to say how they
// change by themselves
static const double CALM = 0.1;

typedef struct Within {
    MujocoRun *run;
    mjModel *model;
    mjData *data;
    size_t rows;
    size_t count;   // nv
    size_t *joints; // by contact: its number in the case
    int *sites[2];  // by contact: of hole and pin
    Kernel kernel;
    KernelSums sums;
    double *q; // of the step's start; all arrays by coordinate, owned
    double *v;
    double *q_next;
    double *v_next;
    double *a; // beside the contacts'
    double *a_rate;
    double *ahead; // a as it is to be expected: that of the step before, after its impulses
    double *responses[BEFORE]; // A: row by row
    double *rate;              // A'
    double *jacobian;          // row by row
    double *drift;             // S
    double *bend;              // B
    double *free;              // G, at mid-step
    double *free_before;
    double *nudged;
    double *sites_jacobian; // of one site: 3 by nv
    double *work;           // by row
    size_t steps;
    bool is_calm;
} Within;

static double *numbers(size_t count)
{
    double *room = calloc(count + 1, sizeof *room);
    if (room == NULL) {
        driver_fail("there is no memory");
    }
    return room;
}

// -- what stands between the marks is the adapter that docs/kernel.md shows

// J, A and W at MuJoCo's present positions.
static void find_response(Within *in)
{
    const size_t nv = in->count;
    double *response = in->responses[0];
    for (size_t i = 0; i < in->rows; i += 2) {
        for (int side = 0; side < 2; side++) {
            mj_jacSite(in->model, in->data, in->sites_jacobian, NULL, in->sites[side][i / 2]);
            for (size_t k = 0; k < 2 * nv; k++) {
                double *entry = &in->jacobian[i * nv + k];
                *entry = side == 0 ? -in->sites_jacobian[k] : *entry + in->sites_jacobian[k];
            }
        }
    }
    mj_solveM(in->model, in->data, response, in->jacobian, (int)in->rows);
    for (size_t i = 0; i < in->rows; i++) {
        for (size_t k = 0; k < in->rows; k++) {
            *kernel_mobility(&in->kernel, i, k) =
                mju_dot(in->jacobian + i * nv, response + k * nv, (int)nv);
        }
    }
}

// u'' without the contacts, at MuJoCo's positions and those velocities.
static void find_free(Within *in, const double *velocities, double *accelerations)
{
    mjData *data = in->data;
    mju_copy(data->qvel, velocities, (int)in->count);
    mj_fwdVelocity(in->model, data);
    mju_sub(data->qacc, data->qfrc_passive, data->qfrc_bias, (int)in->count);
    mj_solveM(in->model, data, data->qacc, data->qacc, 1);
    mj_rnePostConstraint(in->model, data);
    for (size_t i = 0; i < in->rows; i += 2) {
        double hole[6];
        double pin[6];
        mj_objectAcceleration(in->model, data, mjOBJ_SITE, in->sites[0][i / 2], hole, 0);
        mj_objectAcceleration(in->model, data, mjOBJ_SITE, in->sites[1][i / 2], pin, 0);
        accelerations[i] = pin[3] - hole[3];
        accelerations[i + 1] = pin[4] - hole[4];
    }
}

// S, by a velocity that is a little different for each row.
static void find_drift(Within *in, const double *velocities)
{
    const size_t nv = in->count;
    const double speed = mju_norm(velocities, (int)nv);
    for (size_t k = 0; k < in->rows; k++) {
        const double *response = in->responses[0] + k * nv;
        const double nudge = NUDGE * speed / mju_norm(response, (int)nv);
        mju_addScl(in->nudged, velocities, response, nudge, (int)nv);
        find_free(in, in->nudged, in->work);
        mju_sub(in->bend + k * nv, in->data->qacc, in->free, (int)nv);
        mju_scl(in->bend + k * nv, in->bend + k * nv, 1.0 / nudge, (int)nv);
        for (size_t i = 0; i < in->rows; i++) {
            in->drift[i * in->rows + k] = (in->work[i] - in->kernel.free[i]) / (2.0 * nudge);
        }
    }
}

// Where the rows are at the step's start, and how fast they go.
static void find_rows(Within *in, const DriverMotion *motions)
{
    for (size_t i = 0; i < in->rows; i += 2) {
        const DriverJoint *joint = &in->run->of->joints[in->joints[i / 2]];
        const PinHole pose = driver_pose(joint, motions);
        const Vec2 going =
            vec2_sub(driver_point_velocity(motions, joint->bodies[1], joint->anchors[1]),
                     driver_point_velocity(motions, joint->bodies[0], joint->anchors[0]));
        in->kernel.position[i] = pose.eccentricity.x;
        in->kernel.position[i + 1] = pose.eccentricity.y;
        in->kernel.speed[i] = going.x;
        in->kernel.speed[i + 1] = going.y;
    }
}

// A' at the middle of the step, from A there and in the steps before.
static void find_rate(Within *in, double step_s)
{
    for (size_t i = 0; i < in->rows * in->count; i++) {
        const double now = in->responses[0][i];
        const double last = in->responses[1][i];
        const double first = in->responses[2][i];
        in->rate[i] = in->steps == 0   ? 0.0
                      : in->steps == 1 ? (now - last) / step_s
                                       : (1.5 * now - 2.0 * last + 0.5 * first) / step_s;
    }
}

// How the free accelerations change by themselves, from those of the step before, which the
// contacts have changed by 2 S P.
static void find_free_rate(Within *in, double step_s)
{
    for (size_t i = 0; i < in->rows; i++) {
        const bool is_known = in->steps > 1 && in->is_calm;
        in->kernel.free_rate[i] =
            is_known ? (in->kernel.free[i] - in->free_before[i]) / step_s : 0.0;
    }
}

static void keep_free(Within *in)
{
    double size = 0.0;
    double pushed = 0.0;
    for (size_t i = 0; i < in->rows; i++) {
        double change = 0.0;
        for (size_t k = 0; k < in->rows; k++) {
            change += 2.0 * in->drift[i * in->rows + k] * in->sums.impulse[k];
        }
        in->free_before[i] = in->kernel.free[i] + change;
        size = fmax(size, fabs(in->kernel.free[i]));
        pushed = fmax(pushed, fabs(change));
    }
    in->is_calm = pushed <= CALM * size;
}

// Adds sums over the rows of A, or of A', to something by coordinate.
static void add_rows(const Within *in, const double *columns, const double *by_row, double scale,
                     double *target)
{
    for (size_t k = 0; k < in->rows; k++) {
        mju_addToScl(target, columns + k * in->count, scale * by_row[k], (int)in->count);
    }
}

// Positions and velocities at a time in the step, from the kernel's sums then.
static void find_inside(const Within *in, double since_s, double step_s, const KernelSums *sums,
                        double *q, double *v)
{
    const int nv = (int)in->count;
    const double off_s = since_s - 0.5 * step_s;
    const double bend = since_s * (since_s / 6.0 - 0.25 * step_s) * since_s;
    mju_addScl(q, in->q, in->v, since_s, nv);
    mju_addToScl(q, in->a, 0.5 * since_s * since_s, nv);
    mju_addToScl(q, in->a_rate, bend, nv);
    mju_addScl(v, in->v, in->a, since_s, nv);
    mju_addToScl(v, in->a_rate, 0.5 * since_s * (since_s - step_s), nv);
    add_rows(in, in->responses[0], sums->impulse, 1.0, v);
    add_rows(in, in->bend, sums->moment, 1.0, v);
    add_rows(in, in->rate, sums->impulse, off_s, v);
    add_rows(in, in->rate, sums->moment, -1.0, v);
    add_rows(in, in->responses[0], sums->moment, 1.0, q);
    add_rows(in, in->bend, sums->moment + in->rows, 1.0, q);
    add_rows(in, in->rate, sums->moment, off_s, q);
    add_rows(in, in->rate, sums->moment + in->rows, -2.0, q);
}

// MuJoCo's own step, at mid-step under the contacts' mean force: `a`, and how it has changed.
static void step_engine(Within *in, double step_s)
{
    mjData *data = in->data;
    const int nv = (int)in->count;
    mju_addScl(data->qvel, in->v, in->ahead, 0.5 * step_s, nv);
    add_rows(in, in->responses[0], in->sums.moment, 1.0 / step_s, data->qvel);
    mj_fwdVelocity(in->model, data);
    mju_zero(data->qfrc_applied, nv);
    add_rows(in, in->jacobian, in->sums.impulse, 1.0 / step_s, data->qfrc_applied);
    mj_step2(in->model, data);
    add_rows(in, in->responses[0], in->sums.impulse, -1.0 / step_s, data->qacc);
    add_rows(in, in->bend, in->sums.moment, -1.0 / step_s, data->qacc);
    for (int i = 0; i < nv; i++) {
        const bool is_known = in->steps > 1 && in->is_calm;
        in->a_rate[i] = is_known ? (data->qacc[i] - in->ahead[i]) / step_s : 0.0;
        in->a[i] = data->qacc[i];
    }
    mju_zero(data->qfrc_applied, nv);
}

static void take_step(Within *in, double step_s, const DriverMotion *motions)
{
    mjData *data = in->data;
    const int nv = (int)in->count;
    // mid-step, with the velocities that are to be expected there
    mju_addScl(data->qpos, in->q, in->v, 0.5 * step_s, nv);
    mju_copy(in->ahead, in->a, nv);
    add_rows(in, in->bend, in->sums.impulse, 1.0, in->ahead);
    mju_addScl(data->qvel, in->v, in->ahead, 0.5 * step_s, nv);
    mju_addToScl(data->qpos, in->ahead, 0.125 * step_s * step_s, nv);
    add_rows(in, in->responses[0], in->sums.impulse, 0.125 * step_s, data->qpos);
    keep_free(in);
    mju_copy(in->nudged, data->qvel, nv);
    mj_step1(in->model, data);
    double *oldest = in->responses[BEFORE - 1];
    memmove(in->responses + 1, in->responses, (BEFORE - 1) * sizeof *in->responses);
    in->responses[0] = oldest;
    find_response(in);
    find_rate(in, step_s);
    double *expected = in->q_next; // room
    mju_copy(expected, in->nudged, nv);
    find_free(in, expected, in->kernel.free);
    mju_copy(in->free, data->qacc, nv);
    find_drift(in, expected);
    find_free_rate(in, step_s);
    find_rows(in, motions);
    kernel_set_drift(&in->kernel, in->drift, step_s);
    if (!kernel_run(&in->kernel, step_s)) {
        driver_fail("the contacts took more than 100000 local steps in one step");
    }
    kernel_at(&in->kernel, in->kernel.node_count - 1, step_s, &in->sums);
    step_engine(in, step_s);
    find_inside(in, step_s, step_s, &in->sums, in->q_next, in->v_next);
}

// -- the end of the adapter

static void make(MujocoRun *run, Within *in)
{
    const DriverCase *of = run->of;
    *in = (Within){.run = run,
                   .model = run->model,
                   .data = run->data,
                   .count = (size_t)run->model->nv,
                   .kernel = kernel_start(0.0)};
    if (run->tree.left_count > 0) {
        driver_refuse("contacts within the step beside a loop of ideal joints");
    }
    in->joints = calloc(of->joint_count + 1, sizeof *in->joints);
    for (int side = 0; side < 2; side++) {
        in->sites[side] = calloc(of->joint_count + 1, sizeof *in->sites[side]);
    }
    within_add_contacts(of, &in->kernel, in->joints);
    for (size_t i = 0; i < in->kernel.contact_count; i++) {
        char name[DRIVER_NAME_SIZE];
        for (int side = 0; side < 2; side++) {
            snprintf(name, sizeof name, "%s%zu", side == 0 ? "hole" : "pin", in->joints[i]);
            in->sites[side][i] = mj_name2id(run->model, mjOBJ_SITE, name);
        }
    }
    in->rows = kernel_rows(&in->kernel);
    in->sums = kernel_sums(in->rows);
}

static void make_numbers(Within *in)
{
    const size_t block = in->rows * in->count;
    double **by_coordinate[] = {&in->q, &in->v,      &in->q_next, &in->v_next,
                                &in->a, &in->a_rate, &in->nudged, &in->ahead};
    for (size_t i = 0; i < sizeof by_coordinate / sizeof *by_coordinate; i++) {
        *by_coordinate[i] = numbers(in->count);
    }
    for (size_t i = 0; i < BEFORE; i++) {
        in->responses[i] = numbers(block);
    }
    in->rate = numbers(block);
    in->bend = numbers(block);
    in->free = numbers(in->count);
    in->jacobian = numbers(block);
    in->sites_jacobian = numbers(3 * in->count);
    in->drift = numbers(in->rows * in->rows);
    in->free_before = numbers(in->rows);
    in->work = numbers(in->rows);
}

// The bodies at a time in the step that has been taken.
static void read_inside(void *adapter, double since_s, const KernelSums *sums,
                        DriverMotion *motions)
{
    const Within *in = adapter;
    find_inside(in, since_s, in->run->of->step_s, sums, in->nudged, in->data->qvel);
    mujoco_read(in->run, in->nudged, in->data->qvel, motions);
}

void mujoco_run_kernel(MujocoRun *run)
{
    Within in;
    const double step_s = run->of->step_s;
    make(run, &in);
    make_numbers(&in);
    KernelSums sums = kernel_sums(in.rows);
    const int nv = (int)in.count;
    WithinStep step = {.kernel = &in.kernel,
                       .joints = in.joints,
                       .states = run->contacts,
                       .step_s = step_s,
                       .motions = read_inside,
                       .adapter = &in,
                       .room = run->motions,
                       .sums = &sums};
    mju_copy(in.q, run->data->qpos, nv);
    mju_copy(in.v, run->data->qvel, nv);
    driver_run_begin(&run->run);
    mj_forward(run->model, run->data);
    mju_copy(in.a, run->data->qacc, nv);
    while (!driver_run_is_full(&run->run)) {
        step.start_s = step_s * (double)run->run.steps;
        mujoco_read(run, in.q, in.v, run->motions);
        take_step(&in, step_s, run->motions);
        in.steps = ++run->run.steps;
        within_look(&step, &run->run);
        mju_copy(in.q, in.q_next, nv);
        mju_copy(in.v, in.v_next, nv);
        mujoco_check(run);
    }
    kernel_sums_free(&sums);
    kernel_finish(&in.kernel);
}
