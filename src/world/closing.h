// Speeds at the end of a step that keep ODE's joints as they are there.
#pragma once

#include "world/play.h"

// Whether ODE's joints of all known bodies only hold: none of them presses, slips, drives or damps.
// Then a step is linear in all forces.
bool closing_is_linear(const JpWorld *world);

// Whether somebody reads the forces of one of these joints.
bool closing_is_read(const JpWorld *world);

// What a step writes of a joint beside the bodies.
typedef struct ClosingJoint {
    dJointID joint;
    dJointFeedback feedback;
    double erp;
} ClosingJoint;

// The joints of all known bodies.
typedef struct Closing {
    size_t count;
    ClosingJoint *joints; // owned
    bool is_open;         // while what is kept is set aside
} Closing;

// Lists the joints; false where there is no memory.
bool closing_make(const JpWorld *world, Closing *closing);
void closing_free(Closing *closing);

// Takes from the bodies' velocities what would open the joints where the bodies are now, in a world
// that is linear and in which no forces act: positions stay.
void closing_run(JpWorld *world, Closing *closing, double step);

// Puts back what closing_run had set aside where it was left in between.
void closing_put_back(Closing *closing);
