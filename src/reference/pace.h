// Does the motion get on, or do steps and events pile up at one instant?
#pragma once

#include "reference/events.h"

typedef struct Pace {
    size_t steps; // since
    double since_s;
    size_t events; // since
    double instant_s;
} Pace;

// Counts a step that starts at a time, and the events there. Fails with ERR_SOLVER and the joint to
// blame where steps or events have come so close together that the run would not end.
bool pace_keep(Pace *pace, const System *system, const EventList *events, double time_s, Err *err);

// An ideal joint cannot be kept closed. Returns false, with ERR_SOLVER.
bool pace_astray(Err *err);
bool pace_torn(const System *system, Err *err);

// The equations for the accelerations have no solution: joints hold each other up. Returns false,
// with ERR_SOLVER.
bool pace_undetermined(Err *err);
