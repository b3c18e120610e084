// Bodies at the end of a step whose ODE joints are closed there, in position and speed.
#pragma once

#include "world/play.h"

// Whether ODE's joints of all known bodies have no bound: none of them presses only one way or
// slips. Then a step is linear in all forces.
bool closing_is_linear(const JpWorld *world);

// Whether somebody reads the forces of one of these joints.
bool closing_is_read(const JpWorld *world);

// What a step writes of a joint beside the bodies, and the ERP of one that has its own.
typedef struct ClosingJoint {
    dJointID joint;
    dJointFeedback feedback;
    bool yields; // whether it has a row that does
    double erp;
} ClosingJoint;

// The joints of all known bodies.
typedef struct Closing {
    size_t count;
    ClosingJoint *joints; // owned
    double *speeds;       // owned: room for those of all bodies, twice
    BodyMoment *kept;     // owned: room for how the step has kept them
    bool has_any;         // whether one of them holds
    double erp;           // the world's own
    bool is_held;         // while joints have another ERP
    bool is_open;         // while feedback is set aside, too
} Closing;

// Lists the joints; false where there is no memory.
bool closing_make(const JpWorld *world, Closing *closing);
void closing_free(Closing *closing);

// Lets steps hold joints that are closed at their start so that they are closed at their end, up to
// the third power of the step, by another ERP; and ends that. Joints must have the world's. With
// CLOSING_ERP, with which closed joints stay closed.
static const double CLOSING_ERP = 4.0;
void closing_hold(JpWorld *world, Closing *closing, double erp);
void closing_release(JpWorld *world, Closing *closing);

// Whether joints of a linear world may be closed in steps of a length: all in the same way, and if
// they do not yield.
bool closing_is_possible(const JpWorld *world, double step);

// Takes from the bodies' velocities what would open the joints where the bodies are now, in a world
// that is linear and in which no forces act; and from positions what the joints are open by, or
// leaves these.
void closing_run(JpWorld *world, Closing *closing, double step, bool has_positions);

// Puts back what is set aside where that was left in between.
void closing_put_back(Closing *closing);
