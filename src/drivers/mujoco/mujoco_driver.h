// What the files of MuJoCo's driver share: the model made of a case, and the ways to step it.
#pragma once

#include "drivers/common/place.h"
#include "drivers/common/tree.h"

#include <mujoco/mujoco.h>

typedef struct MujocoRun {
    const DriverCase *of;
    Tree tree;
    mjModel *model;
    mjData *data;
    int *addresses; // by coordinate of the tree: in qpos and qvel
    DriverRun run;
    // room
    double *coordinates; // of the tree
    double *rates;
    DriverMotion *motions;
    DriverContact *contacts; // by place
    DriverMotion *acted;     // by body, as is felt where forces are asked for
    DriverAction *actions;   // by body
    Vec2 *pressed;           // by joint: forces of the contacts
    double from_s;           // between which loads act as their mean
    double to_s;
    bool is_instant; // or as at MuJoCo's time
} MujocoRun;

// How the model differs between the ways.
typedef struct MujocoModel {
    const char *integrator; // "Euler", "RK4"
    bool has_tendons;       // limited tendons in the place of pins in their holes
    bool has_springs;       // their limits are the law's spring and damper, all laws being linear
    double hardness_s;      // time constant of limits and of loops that are closed by constraints
} MujocoModel;

// Makes the model of a case, with the bodies at the start.
void mujoco_make(const DriverCase *of, const MujocoModel *how, MujocoRun *run);

// Reads the engine's coordinates and rates into those of the tree, and moves the bodies so.
void mujoco_read(MujocoRun *run, const double *qpos, const double *qvel, DriverMotion *motions);

// Fails where MuJoCo has warned: it starts over on numbers that are none, and says so nowhere else.
void mujoco_check(const MujocoRun *run);

// Lets springs and loads act, and contacts by their law where the way is not to do so itself.
void mujoco_let_act(MujocoRun *run, bool has_contacts);

// Reads a model, MJCF or URDF, and answers with what a mechanism of it is. Returns the status of
// the program.
int mujoco_tell_model(const char *path);

// The contacts integrated within the step, by jointplay's kernel.
void mujoco_run_kernel(MujocoRun *run) __attribute__((noreturn));
