// The contacts of joints with play within one step of the world, whose answer to them is linear.
#pragma once

#include "world/side.h"

// One joint. The first four are given, the sides as the step before left them.
typedef struct InsideJoint {
    Side sides[2];     // go on from step to step
    double position;   // of the coordinate less the rotor's, at the start
    double speed;      // its rate there
    double free;       // its acceleration while nothing presses
    double impulse[2]; // of either side in the step, >= 0
    double moment; // integral over the step of the impulse so far, of the low side less the high
} InsideJoint;

enum { INSIDE_STATE = 5 }; // numbers of a joint: two impulses, the moment, two works

typedef struct Inside {
    size_t count;
    InsideJoint *joints;
    const double *mobility; // row by row: acceleration of a joint for a force of 1 in another
    double *room;           // INSIDE_ROOM(count) numbers to work with
} Inside;

#define INSIDE_ROOM(count) (7 * INSIDE_STATE * (count))

// Integrates a step, s, and adds to the totals of the sides. Returns false where that takes more
// local steps than there can be sense in.
bool inside_run(Inside *inside, double duration);

// The motion of a joint where nothing presses: whether a side touches at the start or until a time.
bool inside_is_near(const InsideJoint *joint, double duration);
