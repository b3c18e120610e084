// Asks MuJoCo for accelerations and responses, of which contacts integrated within the step are
// made (drivers/common/trial.c).
//
// Coordinates of the tree are MuJoCo's own, in another order. With M the mass matrix,
//     M a = pushes - bias,   A = M^-1 J'
#include "drivers/common/trial.h"
#include "drivers/mujoco/mujoco_driver.h"

#include <stdlib.h>
#include <string.h>

typedef struct Adapter {
    MujocoRun *run;
    const mjModel *model;
    mjData *data;
    size_t count;         // of coordinates
    const int *addresses; // by coordinate: in MuJoCo's
    double *placed;       // by coordinate: where MuJoCo has been put last
    double *pushes;       // room, by coordinate
    bool is_placed;
} Adapter;

// -- what stands between the marks is the adapter that docs/kernel.md shows

// Puts MuJoCo to positions; once for all that is asked there.
static void place(Adapter *by, const double *q)
{
    const size_t size = by->count * sizeof *q;
    if (by->is_placed && memcmp(by->placed, q, size) == 0) {
        return;
    }
    memcpy(by->placed, q, size);
    by->is_placed = true;
    for (size_t i = 0; i < by->count; i++) {
        by->data->qpos[by->addresses[i]] = q[i];
    }
    mj_kinematics(by->model, by->data);
    mj_comPos(by->model, by->data);
    mj_crb(by->model, by->data);
    mj_factorM(by->model, by->data);
}

// Adds what forces and moments on the bodies do along the coordinates; most often there are none.
static void push(Adapter *by, const double *q, const double *v, const DriverAction *actions)
{
    const Tree *tree = &by->run->tree;
    bool is_any = false;
    for (size_t i = 0; i < tree->of->body_count; i++) {
        const DriverAction *on = &actions[i];
        is_any = is_any || on->force.x != 0.0 || on->force.y != 0.0 || on->moment != 0.0;
    }
    if (!is_any) {
        return;
    }
    memset(by->pushes, 0, by->count * sizeof *by->pushes);
    tree_motions(tree, q, v, by->run->acted);
    tree_act(tree, by->run->acted, actions, by->pushes);
    for (size_t i = 0; i < by->count; i++) {
        by->data->qacc[by->addresses[i]] += by->pushes[i];
    }
}

// The accelerations at positions and rates, under forces and moments on the bodies.
static void accelerate(void *engine, const double *q, const double *v, const DriverAction *actions,
                       double *a)
{
    Adapter *by = engine;
    mjData *data = by->data;
    place(by, q);
    for (size_t i = 0; i < by->count; i++) {
        data->qvel[by->addresses[i]] = v[i];
    }
    mj_comVel(by->model, data);
    mj_rne(by->model, data, 0, data->qfrc_bias);
    mju_scl(data->qacc, data->qfrc_bias, -1.0, by->model->nv);
    push(by, q, v, actions);
    mj_solveM(by->model, data, data->qacc, data->qacc, 1);
    for (size_t i = 0; i < by->count; i++) {
        a[i] = data->qacc[by->addresses[i]];
    }
}

// What forces along the coordinates, row by row, do to the accelerations at positions.
static void respond(void *engine, const double *q, size_t rows, const double *forces,
                    double *accelerations)
{
    Adapter *by = engine;
    double *work = by->data->qacc;
    place(by, q);
    for (size_t k = 0; k < rows; k++) {
        for (size_t i = 0; i < by->count; i++) {
            work[by->addresses[i]] = forces[k * by->count + i];
        }
        mj_solveM(by->model, by->data, work, work, 1);
        for (size_t i = 0; i < by->count; i++) {
            accelerations[k * by->count + i] = work[by->addresses[i]];
        }
    }
}

// -- the end of the adapter

void mujoco_run_kernel(MujocoRun *run)
{
    Adapter by = {.run = run,
                  .model = run->model,
                  .data = run->data,
                  .count = run->tree.coordinates,
                  .addresses = run->addresses};
    by.placed = driver_room(by.count, sizeof *by.placed);
    by.pushes = driver_room(by.count, sizeof *by.pushes);
    trial_run(&run->tree, &(TrialEngine){accelerate, respond, &by}, &run->run);
}
