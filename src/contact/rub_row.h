// The row by which friction acts in a joint of ODE that is ideal but for it, for whichever world: a
// case's or a caller's.
#pragma once

#include "kernel/bristle.h"

#include <stdbool.h>

// Of a slider forces, metres and masses are meant.
typedef struct RubRow {
    // given
    BristlePair pair; // of which the law, the ratio and the speed, rad/s, count
    double steady;    // N m, that sliding holds whatever presses
    double arm;       // m, mu times the radius, of what presses, in its place; 0: steady
    double mobility;  // 1/(kg m^2), of the two bodies by themselves
    // of the last steps
    double pressing[2]; // N, in the last step and in the one before it
    int known;          // of these
    double gained;      // rad/s, of the rate in the last step
    double late;        // N m, that the last step is still owed
    // of the step under way
    double rate;     // rad/s, at its start
    double torque;   // N m, that sliding holds in it
    double pushed;   // N m, beside the row
    bool has_row;    // whether there is a row: J w' + softness t = wanted, |t| <= most
    double wanted;   // rad/s
    double softness; // rad/(N m s)
    double most;     // N m
} RubRow;

// Begins a step at a rate, and says what is pushed beside a row.
void rub_row_begin(RubRow *row, double rate);

// Sets the row of the step, where there is one. Of a step whose forces act on the mean of the
// speeds before and after it, or else on those after it.
void rub_row_set(RubRow *row, double step_s, bool is_at_mean);

// Ends a step at a rate.
void rub_row_end(RubRow *row, double end_rate);

// Notes what pressed in a step, N.
void rub_row_note(RubRow *row, double pressing);
