// A step in which contacts of joints with play are integrated by themselves.
#pragma once

#include "world/inside.h"
#include "world/play.h"

// What a step needs to know of a world's answer, and what it is to put right afterwards.
typedef struct Impulse {
    size_t joint_count;
    JpJoint **joints;      // all, in the world's order
    InsideJoint *contacts; // of each; behind them room for those of the active ones
    bool *is_active;       // whether its contacts are integrated
    size_t *active;        // their numbers
    size_t active_count;
    double *rates;    // of all coordinates: at the start, after the base, after the step
    double *pushed;   // by joint: the impulses of the base
    double *columns;  // by joint: rates of all coordinates per impulse of 1 in it
    double *bodies;   // by joint: speeds of all bodies per impulse of 1 in it
    double *base;     // speeds of all bodies after it
    double *mobility; // of the active ones, with their rotors
    double *room;
    void *memory; // owned, of all of the above
} Impulse;

// Makes the world's step in velocities, from bodies that are kept at mid-step. `is_done` is false
// where that could not be done; bodies are as they were kept then.
JpStatus impulse_step(JpWorld *world, double step, Impulse *impulse, bool *is_done, JpError *error);

// What remains to be done once bodies have moved on from mid-step: contacts that press early move
// them farther than their mean does. Books rotors and sides.
void impulse_finish(JpWorld *world, double step, Impulse *impulse);

void impulse_free(Impulse *impulse);
