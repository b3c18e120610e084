// The friction of ideal pivots in a world of ODE: rows about their axes.
#pragma once

#include "base/carry.h"
#include "contact/rub_row.h"
#include "model/forces.h"
#include "model/scenario.h"
#include "model/trajectory.h"
#include "ode/plane/applied.h"

#include <ode/ode.h>

// The friction of one pivot.
typedef struct RubbingRow {
    int joint;
    dJointID row; // NULL: a drive has both of its bodies
    dJointFeedback feedback;
    RubRow rub;    // of the turned body
    double moment; // N m, on it, in all
} RubbingRow;

typedef struct Rubbing {
    const Linkage *linkage;
    const dBodyID *bodies; // of the world
    size_t count;
    RubbingRow *rows; // owned
} Rubbing;

// Makes the rows of a scenario's pivots. Part of world_build.
void rubbing_make(const Scenario *scenario, dWorldID world, const dBodyID *bodies,
                  Rubbing *rubbing);
void rubbing_finish(Rubbing *rubbing);

// Carries what is known of the last steps.
void rubbing_carry(Rubbing *rubbing, Carry *carry);

// Before a step, the bodies having the speeds of its start: puts the rows to them.
void rubbing_push(Rubbing *rubbing, double step_s, AppliedRule rule);

// After it, the bodies having the speeds of its end: adds the torques to the loads, by body, and
// takes those of the step before from the joints. Returns the work lost, J.
double rubbing_book(Rubbing *rubbing, double step_s, BodyLoad *loads, JointState *joints);

// Behind what is worked out from joints and loads: takes the joints' forces of the step, for the
// next ones, and tells the joints the moments that they give their bodies.
void rubbing_note(Rubbing *rubbing, JointState *joints);
