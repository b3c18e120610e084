// When does a contact begin, end or go slack?
#pragma once

#include "reference/dop853.h"
#include "reference/dynamics.h"

typedef struct Event {
    bool is_present;
    double time; // s
    size_t contact;
    ContactMode mode; // the mode that begins
} Event;

// A step is looked at in some points, equal parts of it, the last at its end. While nothing presses
// steps are long, and a pin might reach its wall and leave it within one; while something does some
// ten steps make a swing, and the end is enough.
enum { EVENTS_POINTS_MAX = 4 };

typedef struct EventPoints {
    size_t count;
    DynamicsState states[EVENTS_POINTS_MAX];
} EventPoints;

// Evaluates the points of the tried and filled step. Returns false where the accelerations are not
// determined.
bool events_look(const Dynamics *dynamics, const Dop853 *integrator, EventPoints *points);

// The time of one point.
double events_point_time(const Dop853 *integrator, const EventPoints *points, size_t point);

// The earliest event in the step.
Event events_find(const Dynamics *dynamics, const Dop853 *integrator, const EventPoints *points);

// Shortens the tried step so that it ends on the event to rounding, and fills it again.
void events_land(const Dynamics *dynamics, Dop853 *integrator, Event *event);

// Changes the contact's mode at the end of the step, with its impact speed.
void events_apply(Dynamics *dynamics, const Event *event, double time_s, const double *y);
