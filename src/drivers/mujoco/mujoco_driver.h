// What the files of MuJoCo's driver share: the model made of a case, and the ways to step it.
#pragma once

#include "drivers/common/native.h"

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
    double *turning; // by body, rad/s^2: what its drive does from from_s to to_s, in the mean
    Native native;   // of that way: what touches
} MujocoRun;

// How the model differs between the ways.
typedef struct MujocoModel {
    const char *integrator; // "Euler", "RK4"
    bool has_tendons;       // what touches is MuJoCo's own, and pins in their holes limited tendons
    bool has_springs;       // their limits are the law's spring and damper, all laws being linear
    double hardness_s;      // time constant of limits and of loops that are closed by constraints
} MujocoModel;

// The armature of a driven body, kg m^2.
extern const double MUJOCO_ARMATURE;

// Makes the model of a case, with the bodies at the start.
void mujoco_make(const DriverCase *of, const MujocoModel *how, MujocoRun *run);

// Reads the engine's coordinates and rates into those of the tree, and moves the bodies so.
void mujoco_read(MujocoRun *run, const double *qpos, const double *qvel, DriverMotion *motions);

// Fails where MuJoCo has warned: it starts over on numbers that are none, and says so nowhere else.
void mujoco_check(const MujocoRun *run);

// Lets springs and loads act, and contacts by their law where the way is not to do so itself.
void mujoco_let_act(MujocoRun *run, bool has_contacts);

// What touches by MuJoCo's own means, and what that has pushed with in the last step, N or N m by
// place, with run->motions after it.
void mujoco_native(MujocoRun *run);
void mujoco_read_pushes(const MujocoRun *run, double *pushes);

// Reads a model, MJCF or URDF, and answers with what a mechanism of it is. Returns the status of
// the program.
int mujoco_tell_model(const char *path);

// The contacts integrated within the step, by jointplay's kernel.
void mujoco_run_kernel(MujocoRun *run) __attribute__((noreturn));
