// Springs, bushings, dampers and the torque of a drive in a world. Springs and torque push before a
// step; a damper is a constraint row with CFM, so that no damper, however strong, makes a step
// unstable.
#pragma once

#include "base/carry.h"
#include "model/forces.h"

#include <ode/ode.h>

// One damper: ODE's joint that holds its row, and the force in it.
typedef struct AppliedRow {
    dJointID row; // NULL: the spring has no damper
    dJointFeedback feedback;
    double late; // N or N m: tension or moment beside the row's (applied_push_late)
} AppliedRow;

typedef struct Applied {
    const Linkage *linkage;
    const dBodyID *bodies; // of the world
    bool is_any;           // whether anything acts; else nothing below is used
    bool is_held;          // whether loads that jump keep the value that they have from a time on
    double held_s;         // that time
    double *angles;        // rad, of the bodies when last looked at, not wrapped;
                           // owned, as all arrays below
    AppliedRow *dampers;   // of the springs
    AppliedRow *torsions;  // of the torsion springs
    AppliedRow *bushings;  // of the bushings, BUSHING_ROWS of each
    BushingPose *poses;    // of these, at the positions of the step
    AppliedRow *gaps;      // of dampers in gaps, GAP_DAMPING_ROWS of each joint
    GapDampingRow *drags;  // likewise, at the positions of the step
    SpringLine *lines;     // at the positions of the step
    Motion *motions;       // likewise, with the speeds of its start
    Motion *seen;          // as the engine holds them
    BodyLoad *late;        // room
    BodyLoad *loads;       // of springs and torque, and of the dampers: before the step
                           // as the speeds of its start have them, behind it as they
                           // were
    AppliedRow motor;      // of the drive's torque, where its rate takes some
    double *pushed;        // N or N m, by load: mean over the step
    double *rates;         // m/s or rad/s, by load, at its start
    double torque;         // N m, mean over the step, but for what the rate takes; of a drive
                           // with a limit all of it
    double held;           // N m, of a drive with a limit: without what the rate takes, unlimited
    double wanted;         // rad/s, of its row: the speed on its right-hand side
    double turning;        // rad/s, rate of the drive's joint at its start
} Applied;

// How a step reads the speeds that dampers feel.
typedef enum AppliedRule {
    APPLIED_AT_END,  // those of its end: first order
    APPLIED_AT_MEAN, // mean of start and end, symmetric in time: second order
} AppliedRule;

// Makes the rows of the dampers in a world whose bodies stand in the motions given. Part of
// world_build.
void applied_make(const Linkage *linkage, dWorldID world, const dBodyID *bodies,
                  const Motion *motions, Applied *applied);

void applied_finish(Applied *applied);

// Carries what is known of the last step.
void applied_carry(Applied *applied, Carry *carry);

// Before a step: puts springs and torque on the bodies where they stand, and the dampers' rows to
// their speeds, those of its start. A step backwards in time has a negative direction.
void applied_push(Applied *applied, double start_s, double step_s, AppliedRule rule, int direction);

// The same for motions that are known better than the world has them.
void applied_push_at(Applied *applied, const Motion *motions, double start_s, double step_s,
                     AppliedRule rule, int direction);

// After that: lets the dampers feel that the mean speeds in the step will be so much above those of
// its start and end, which their rows know; motions that have these for speeds.
void applied_push_late(Applied *applied, const Motion *beyond);

// What the drive's torque and the loads gave and the dampers took in a step, J. Of a torque whose
// rate takes some, that is apart.
typedef struct AppliedWork {
    double torque;
    double slope;
    double loads;
    double damping;
} AppliedWork;

// After the step: finds the dampers' forces and books the work.
AppliedWork applied_book(Applied *applied, double step_s);

// The load on a body, zero on the ground.
BodyLoad applied_on(const Applied *applied, int body);
