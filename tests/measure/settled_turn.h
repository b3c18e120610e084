// Turns the equations of a random case on, period by period, with the events of its contacts.
#pragma once

#include "settled_model.h"

typedef struct TurnScale {
    double length; // m or rad, of the play
    double speed;  // m/s or rad/s, of what crosses it
} TurnScale;

typedef struct Turn {
    const Model *model;
    double tolerance; // of a step, over the scale
    TurnScale scale;
    double time; // s, in the present period
    double step; // s, the next one
    double y[MODEL_STATES];
    double rates[MODEL_STATES];
    ModelOffset offset;
    ModelTouch touches[MODEL_CONTACTS];
    double peak;    // N or N m, largest force of the present period
    double reached; // largest |x| since the start
    double fastest; // largest |v| since the start
    size_t evaluations;
    bool is_failed;
} Turn;

// Begins at the start of a period in a state; a contact that overlaps there begins there.
Turn turn_start(const Model *model, TurnScale scale, double tolerance, const double *y);

// Goes on to the end of the period; the peak is then that of this period.
void turn_period(Turn *turn);
