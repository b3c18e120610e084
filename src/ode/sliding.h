// A prismatic joint in ODE's world: two rows in the plane, those of model/joint_rows.h.
#pragma once

#include "model/joint_rows.h"
#include "model/trajectory.h"

#include <ode/ode.h>

typedef struct Sliding {
    int joint;      // number in the linkage
    dBodyID ids[2]; // of bodies a and b; NULL: the ground
    Vec2 anchors[2];
    Vec2 direction;  // unit, of the line on body a
    Vec2 held;       // unit: where body b's x axis points in body a's frame
    double reach;    // m, least length at which the row across the line is written
    double erp;      // 1
    dJointID across; // the row across the line
    dJointID turn;   // the row that keeps the angle
    dJointFeedback across_feedback;
    dJointFeedback turn_feedback;
    Vec2 offset; // m, from anchor a to anchor b when the rows were last set
} Sliding;

// Makes the rows of a joint in a world whose bodies are given by number. ODE keeps pointers into
// the result: it must not be copied.
void sliding_make(const Linkage *linkage, int joint, dWorldID world, const dBodyID *bodies,
                  double erp, double cfm, Sliding *sliding);

// Before a step: brings the rows to where the bodies stand.
void sliding_set(Sliding *sliding, double step_s);

// Fills in the force and the couple of the last step.
void sliding_force(const Sliding *sliding, JointState *state);
