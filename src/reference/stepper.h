// The motion step by step: from event to event, each step no longer than its error allows.
#pragma once

#include "model/scale.h"
#include "reference/dop853.h"
#include "reference/ending.h"
#include "reference/events.h"
#include "reference/pace.h"
#include "reference/stiffness.h"
#include "reference/system.h"

typedef struct Stepper {
    const Scenario *scenario;
    System *system;    // owned
    Dop853 integrator; // its tried step is the present one
    EventPoints points;
    EventList events; // at its end
    EventList found;  // room for those of a step that is looked at
    Pace pace;
    Stiffness stiffness;
    bool has_step;
    double duration_s;
    SpeedScale scale;    // largest speeds so far
    bool is_after_onset; // whether a contact began where the present step does
    double onset_step;   // s, length that the first step of the last contact had
    double flight_step;  // s, with which the last flight would have gone on
    Ending ending;       // how near to the ends of contacts steps have come
} Stepper;

// Puts the stepper at the scenario's start. Fails with ERR_CASE where a law does not fit a joint
// and with ERR_SOLVER where the accelerations at the start are not determined.
bool stepper_init(Stepper *stepper, const Scenario *scenario, Err *err);
void stepper_finish(Stepper *stepper);

// Goes on by one step of some length, at whose end there may be an event. Fails with ERR_SOLVER.
bool stepper_next(Stepper *stepper, Err *err);
