// Contacts integrated within the steps of an engine that tells no response: trial steps show it.
//
// The engine is asked for accelerations at states of the driver's choosing, by itself and with a
// force in each row of a contact; from the differences come the responses that the contact kernel
// wants. It needs an engine that solves exactly, or nearly so. Coordinates are those of a tree;
// loops are held by rows (drivers/common/hold.h).
#pragma once

#include "drivers/common/hold.h"
#include "drivers/common/rubs.h"
#include "drivers/common/within.h"

// The accelerations of the coordinates at positions and rates under gravity, the engine's own drive
// and the actions on all bodies besides.
typedef void (*TrialAccelerate)(void *engine, const double *q, const double *v,
                                const DriverAction *actions, double *a);

// How an engine is asked.
typedef struct TrialEngine {
    TrialAccelerate accelerate;
    // Writes what unit forces along the coordinates, row by row, do to the accelerations at
    // positions. NULL: trials with and without each force show it.
    void (*respond)(void *engine, const double *q, size_t rows, const double *forces,
                    double *accelerations);
    void *engine;
} TrialEngine;

// Whether a drive or an ideal joint is held by rows of the driver's own in this way, and the engine
// is not to know of it.
static inline bool trial_holds(const Tree *tree, size_t joint)
{
    return driver_is_way(tree->of, "kernel") && tree->is_left[joint];
}

// Runs a case to its end, and counts every trial as a step; of an engine that responds every step.
void trial_run(const Tree *tree, const TrialEngine *engine, DriverRun *run)
    __attribute__((noreturn));

// For engines whose coordinates are those of bodies, and whose joints are held by velocities at
// the end of a step:
//     J v' = 0      J the joints' Jacobian
// Accelerations are right where J a = -J' v. Those that velocities alone give the bodies, b, are
// so: with forces -M b besides, the engine is left to find a - b, for which J (a - b) = 0.

// The length of a step for evaluations, s. It changes what they are by rounding alone.
double trial_step(const DriverCase *of);

// The bodies for it, and what is to act on them.
void trial_place(const Tree *tree, const double *q, const double *v, const DriverAction *given,
                 DriverMotion *motions, DriverAction *actions);

// The coordinates' accelerations from the bodies' velocities before and after such a step.
void trial_read(const Tree *tree, const DriverMotion *before, const DriverMotion *after,
                double step_s, double *a);
