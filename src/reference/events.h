// When does a contact begin, end or go slack?
#pragma once

#include "reference/system.h"

typedef struct Event {
    double time; // s
    size_t contact;
    ContactMode mode; // the mode that begins
} Event;

// Events of a step, at most one a contact.
typedef struct EventList {
    size_t count;
    Event *events; // owned by the stepper, one a contact
} EventList;

// A step is looked at in some points, equal parts of it, the last at its end. While nothing presses
// steps are long, and a pin might reach its wall and leave it within one; while something does some
// ten steps make a swing, and the end is enough.
enum { EVENTS_POINTS_MAX = 4 };

typedef struct EventPoints {
    size_t count;
    SystemState *states[EVENTS_POINTS_MAX]; // owned by the stepper
} EventPoints;

// Evaluates the points of the tried step, and the rates at its end with the last of them. Returns
// false where the accelerations are not determined.
bool events_look(const System *system, Dop853 *integrator, EventPoints *points);

// The time of one point.
double events_point_time(const Dop853 *integrator, const EventPoints *points, size_t point);

// The first event of each contact in the step, as far as there is one.
void events_find(const System *system, Dop853 *integrator, const EventPoints *points,
                 EventList *found);

// The earliest of those that were found; NULL where there is none.
const Event *events_first(const EventList *found);

// Shortens the tried step so that it ends on the event to rounding.
void events_land(const System *system, Dop853 *integrator, Event *event);

// Keeps of the events that were found the one that the step has landed on and those that nothing
// but rounding keeps apart from it: within a time, s, of it, or at the wall like it.
void events_gather(const System *system, const Dop853 *integrator, const EventPoints *points,
                   const Event *landed, double same_s, EventList *found);

// Changes the contacts' modes at the end of the step, with their impact speeds.
void events_apply(System *system, const EventList *events, double time_s, const double *y);
