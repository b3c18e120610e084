// Steps MuJoCo with the contacts of pins in holes integrated within its steps.
//
// q and v are MuJoCo's positions and velocities, both at the time t; u the rows, two a pin: pin
// less hole, in the world's x and y; J their Jacobian, A = M^-1 J' what a unit impulse in a row
// does to v, W = J A. A step h:
//     q_m = q + h/2 v + h^2/8 (a + A P/h)                      a, P, A of the step before
//     v_m = v + h/2 a + 3/8 h^2 a' + 7/48 h^3 a''
//     W, A, g = u'' without contacts, at q_m and v_m
//     P, Q, R                                       the kernel's impulses, and their integrals
//     v^ = v_m + A Q/h                              the mean velocity, with what the contacts do
//     a + B Q/h + A P/h from MuJoCo's step at q_m, v^, under the mean force P/h
//     v' = v + h a + h^3/24 a'' + B Q + B' (h/2 Q - R) + A P + A' (h/2 P - Q)
//     q' = q + h v + h^2/2 a - h^3/12 a' + h^4/48 a'' + B R + A Q + A' (h/2 Q - 2 R)
// The accelerations without contacts are quadratic in v. Those of the rows, F(v), an impulse P
// changes by 2 S P, those of the coordinates, G(v), by B P:
//     2 S = (F(v + e A) - F(v)) / e,   B = (G(v + e A) - G(v)) / e,   e small;   W' = S + S'
#include "drivers/common/within.h"
#include "drivers/mujoco/mujoco_driver.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// of the velocities: what they are changed by for S
static const double NUDGE = 1e-5;

typedef struct Adapter {
    Within in;
    MujocoRun *run;
    mjModel *model;
    mjData *data;
    int *sites[2];          // by contact: of hole and pin
    double *sites_jacobian; // of one site: 3 by nv, of its place
    double *turns_jacobian; // and of its turning
} Adapter;

// -- what stands between the marks is the adapter that docs/kernel.md shows

// J, A and W at MuJoCo's present positions.
static void find_response(Adapter *by)
{
    Within *in = &by->in;
    const size_t nv = in->count;
    double *response = in->responses[0];
    for (size_t i = 0; i < in->kernel.contact_count; i++) {
        const KernelContact *contact = &in->kernel.contacts[i];
        double *rows = in->jacobian + contact->first_row * nv;
        for (size_t side = 0; side < 2; side++) {
            mj_jacSite(by->model, by->data, by->sites_jacobian, by->turns_jacobian,
                       by->sites[side][i]);
            for (size_t k = 0; k < 2 * nv; k++) {
                rows[k] = side == 0 ? -by->sites_jacobian[k] : rows[k] + by->sites_jacobian[k];
            }
            if (contact->has_friction) { // about z
                mju_copy(rows + (KERNEL_ROW_TURN + side) * nv, by->turns_jacobian + 2 * nv,
                         (int)nv);
            }
        }
    }
    mj_solveM(by->model, by->data, response, in->jacobian, (int)in->rows);
    for (size_t i = 0; i < in->rows; i++) {
        for (size_t k = 0; k < in->rows; k++) {
            *kernel_mobility(&in->kernel, i, k) =
                mju_dot(in->jacobian + i * nv, response + k * nv, (int)nv);
        }
    }
}

// u'' without the contacts, at MuJoCo's positions and those velocities.
static void find_free(Adapter *by, const double *velocities, double *accelerations)
{
    Within *in = &by->in;
    mjData *data = by->data;
    mju_copy(data->qvel, velocities, (int)in->count);
    mj_fwdVelocity(by->model, data);
    mju_sub(data->qacc, data->qfrc_passive, data->qfrc_bias, (int)in->count);
    mj_solveM(by->model, data, data->qacc, data->qacc, 1);
    mj_rnePostConstraint(by->model, data);
    for (size_t i = 0; i < in->kernel.contact_count; i++) {
        const KernelContact *contact = &in->kernel.contacts[i];
        double *own = accelerations + contact->first_row;
        double hole[6]; // turning first
        double pin[6];
        mj_objectAcceleration(by->model, data, mjOBJ_SITE, by->sites[0][i], hole, 0);
        mj_objectAcceleration(by->model, data, mjOBJ_SITE, by->sites[1][i], pin, 0);
        own[0] = pin[3] - hole[3];
        own[1] = pin[4] - hole[4];
        if (contact->has_friction) {
            own[KERNEL_ROW_TURN] = hole[2];
            own[KERNEL_ROW_TURN + 1] = pin[2];
        }
    }
}

// S, by a velocity that is a little different for each row.
static void find_drift(Adapter *by, const double *velocities)
{
    Within *in = &by->in;
    const size_t nv = in->count;
    const double speed = mju_norm(velocities, (int)nv);
    for (size_t k = 0; k < in->rows; k++) {
        const double *response = in->responses[0] + k * nv;
        const double size = mju_norm(response, (int)nv);
        if (size == 0.0) {
            continue; // a turn of the ground
        }
        const double nudge = NUDGE * (speed > 0.0 ? speed : 1.0) / size;
        mju_addScl(in->nudged, velocities, response, nudge, (int)nv);
        find_free(by, in->nudged, in->work);
        mju_sub(in->bend + k * nv, by->data->qacc, in->free, (int)nv);
        mju_scl(in->bend + k * nv, in->bend + k * nv, 1.0 / nudge, (int)nv);
        for (size_t i = 0; i < in->rows; i++) {
            in->drift[i * in->rows + k] = (in->work[i] - in->kernel.free[i]) / (2.0 * nudge);
        }
    }
}

// MuJoCo's own step, at mid-step under the contacts' mean force.
static void step_engine(Adapter *by, double step_s)
{
    Within *in = &by->in;
    mjData *data = by->data;
    const int nv = (int)in->count;
    mju_copy(data->qvel, in->v_middle, nv);
    within_add_rows(in, in->responses[0], in->sums.moment, 1.0 / step_s, data->qvel);
    mj_fwdVelocity(by->model, data);
    mju_zero(data->qfrc_applied, nv);
    within_add_rows(in, in->jacobian, in->sums.impulse, 1.0 / step_s, data->qfrc_applied);
    mj_step2(by->model, data);
    within_take_accelerations(in, data->qacc, step_s);
    mju_zero(data->qfrc_applied, nv);
}

static void take_step(Adapter *by, double step_s, const DriverMotion *motions)
{
    Within *in = &by->in;
    mjData *data = by->data;
    const int nv = (int)in->count;
    within_find_middle(in, step_s);
    within_keep_free(in);
    mju_copy(data->qpos, in->q_middle, nv);
    mju_copy(data->qvel, in->v_middle, nv);
    mj_step1(by->model, data);
    within_age_responses(in);
    find_response(by);
    within_find_rate(in, step_s);
    find_free(by, in->v_middle, in->kernel.free);
    mju_copy(in->free, data->qacc, nv);
    find_drift(by, in->v_middle);
    within_find_free_rate(in, step_s);
    within_find_rows(in, motions);
    within_integrate(in, step_s);
    step_engine(by, step_s);
    within_find_end(in, step_s);
}

// -- the end of the adapter

static void make(MujocoRun *run, Adapter *by)
{
    const DriverCase *of = run->of;
    *by = (Adapter){.run = run, .model = run->model, .data = run->data};
    if (run->tree.left_count > 0) {
        driver_refuse("contacts within the step beside a loop of ideal joints");
    }
    within_open(of, (size_t)run->model->nv, &by->in);
    by->sites_jacobian = within_numbers(3 * by->in.count);
    by->turns_jacobian = within_numbers(3 * by->in.count);
    for (int side = 0; side < 2; side++) {
        by->sites[side] = calloc(of->joint_count + 1, sizeof *by->sites[side]);
        if (by->sites[side] == NULL) {
            driver_fail("there is no memory");
        }
    }
    for (size_t i = 0; i < by->in.kernel.contact_count; i++) {
        char name[DRIVER_NAME_SIZE];
        for (int side = 0; side < 2; side++) {
            snprintf(name, sizeof name, "%s%zu", side == 0 ? "hole" : "pin", by->in.joints[i]);
            by->sites[side][i] = mj_name2id(run->model, mjOBJ_SITE, name);
        }
    }
}

// The bodies at a time in the step that has been taken.
static void read_inside(void *adapter, double since_s, const KernelSums *sums,
                        DriverMotion *motions)
{
    const Adapter *by = adapter;
    const Within *in = &by->in;
    within_find_inside(in, since_s, in->of->step_s, sums, in->nudged, by->data->qvel);
    mujoco_read(by->run, in->nudged, by->data->qvel, motions);
}

void mujoco_run_kernel(MujocoRun *run)
{
    Adapter by;
    Within *in = &by.in;
    const double step_s = run->of->step_s;
    make(run, &by);
    KernelSums sums = kernel_sums(in->rows);
    const int nv = (int)in->count;
    WithinStep step = {.kernel = &in->kernel,
                       .joints = in->joints,
                       .states = run->contacts,
                       .step_s = step_s,
                       .motions = read_inside,
                       .adapter = &by,
                       .room = run->motions,
                       .sums = &sums};
    mju_copy(in->q, run->data->qpos, nv);
    mju_copy(in->v, run->data->qvel, nv);
    mujoco_let_act(run, false);
    driver_run_begin(&run->run);
    mj_forward(run->model, run->data);
    mju_copy(in->a, run->data->qacc, nv);
    while (!driver_run_is_full(&run->run)) {
        step.start_s = step_s * (double)run->run.steps;
        run->from_s = step.start_s;
        run->to_s = step.start_s + step_s;
        mujoco_read(run, in->q, in->v, run->motions);
        take_step(&by, step_s, run->motions);
        in->steps = ++run->run.steps;
        within_look(&step, &run->run);
        within_go_on(in);
        mujoco_check(run);
    }
    kernel_sums_free(&sums);
    kernel_finish(&in->kernel);
}
