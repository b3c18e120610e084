// One side of a joint with play: where it touches, how hard, and what came of it since it was made.
#pragma once

#include "contact/law_row.h"
#include "contact/overlap.h"
#include "kernel/contact_peaks.h"
#include "kernel/contact_state.h"
#include "kernel/force_law.h"

#include <stdbool.h>
#include <stddef.h>

typedef struct Side {
    ForceLaw law;
    double sign;  // 1: pushes the coordinate up; -1: down
    double limit; // rad or m: where it begins to touch; infinite where there is none
    ContactState state;
    bool begins;         // whether the step under way is the first in which it touches
    double age;          // s, of the contact under way, before this step
    double lasts;        // s, that it lasts if it is an impact
    double tried;        // mobility that the world has, found for that; 0: not found
    double depth;        // of the row in the step under way, 0 where it does not touch
    double share;        // 1, of the step in which it touches
    double step_force;   // largest in the step under way, of contacts within the step
    double inside;       // the depth where the step finds it
    double closing;      // at its start
    double last_closing; // where bodies were at the start of the step before, where nothing touched
                         // then
    double last_step;    // s, of that step; 0 where it is not known
    double mobility;     // of the coordinate, found by trial in the contact under way; 0: not yet
    // what came of it
    double force;       // N m or N, mean of the last step, >= 0
    ContactPeaks peaks; // of the contact under way
    double force_max;
    double depth_max;
    double impulse;
    double work; // J, done by the contact on bodies and rotor
    size_t impacts;
} Side;

// The distance to the side from a position of the coordinate, < 0 where it is inside.
static inline double side_gap(const Side *side, double position)
{
    return side->sign * (position - side->limit);
}

// How a step finds a side.
typedef struct SideMotion {
    double gap;           // where forces are evaluated
    double gaps[2];       // at the step's start, and at its end as bodies go
    double closing;       // rate of the depth there with the velocities of the step's start
    double start_closing; // the same where bodies are at the step's start
    double earlier;       // s: the start, before forces are evaluated
} SideMotion;

void side_find(Side *side, const SideMotion *motion, double step);

// The contact as a map looks at it, of a side that touches.
MapContact side_contact(const Side *side, double step);

// Whether a map is stable for the contact, with a mobility of the coordinate.
bool side_is_stable(const Side *side, const Map *map, double mobility, double step);

// A contact begins, with a closing speed.
void side_begin(Side *side, double closing);

// Notes a force of the law at a depth that the step has found, as they are.
void side_note(Side *side, double force);

// Notes the force of the step that was made, N m or N, and the rates before and after it.
void side_book(Side *side, double force, double rate_before, double rate_after, double step);
