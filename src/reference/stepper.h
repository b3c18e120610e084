// The motion step by step: from event to event, each step no longer than its error allows.
#pragma once

#include "base/root.h"
#include "model/scale.h"
#include "reference/integrators.h"
#include "reference/system.h"

// Events: a contact begins, ends, goes slack, has outlasted its impact, or comes to another wall of
// its slot (reference/events.c).

typedef struct Event {
    double time; // s
    size_t contact;
    ContactMode mode; // the mode that begins
    bool is_rest;     // it stays in its mode, and its impact is over
    bool is_full;     // it stays in its mode, and passes where its damping is whole
    ContactWall wall; // of a slot that it comes to, in its mode; WALL_NEAREST: it is no such event
    bool is_onset;    // nothing touched before: set where it is applied
    bool is_drive;    // of a soft drive with a limit (reference/drive_limit.c)
    int side;         // of that: where its torque is then
    // of a bristle (reference/bristle_events.c), whose number stands in place of the contact's:
    bool is_bristle;
    BristleMode bends; // the mode that begins
    int face;          // of a guide that presses then
} Event;

// Events of a step, at most one a contact, a bristle and the drive.
typedef struct EventList {
    size_t count;
    Event *events; // owned by the stepper, one a contact
} EventList;

// A step is evaluated in some points, equal parts of it, the last at its end. While nothing presses
// steps are long, and a pin might reach its wall and leave it within one; while something does some
// ten steps make a swing, and the end is enough.
enum { EVENTS_POINTS_MAX = 4 };

typedef struct EventPoints {
    size_t count;
    SystemState *states[EVENTS_POINTS_MAX]; // owned by the stepper
} EventPoints;

// Evaluates the points of the tried step, and the rates at its end with the last of them. Returns
// false where the accelerations are not determined.
bool events_evaluate(const System *system, Dop853 *integrator, EventPoints *points);

// The time of one point.
double events_point_time(const Dop853 *integrator, const EventPoints *points, size_t point);

// Where a margin first turns negative between two times, the first of which may be the event that
// the step began with: there it is zero but for rounding, of either sign.
double events_crossing(RootFunction margin, void *context, double first, double last);

// The first event of a drive with a limit in the tried step (reference/drive_limit.c); false where
// there is none. At the start it finds where the torque is.
bool drive_limit_find(const System *system, Dop853 *integrator, Event *event);
void drive_limit_start(System *system, const double *y);

// The first event of each contact in the step, as far as there is one.
void events_find(const System *system, Dop853 *integrator, const EventPoints *points,
                 EventList *found);

// The same of the bristles alone, which are added to those of contacts.
void bristle_events_find(const System *system, Dop853 *integrator, const EventPoints *points,
                         EventList *found);

// Changes a bristle's mode at the base, and its bend to what that has. Returns whether it has.
void bristle_events_apply(System *system, const Event *event, double *y);

// Lets the bristle of a contact that begins to press at the base begin, unbent.
void bristle_events_onset(System *system, size_t contact, double *y);

// Lets all bristles begin at the start.
void bristle_events_start(System *system, double *y);

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

// What the ends of contacts have shown so far.
typedef struct Ending {
    double crossed; // N s: ends with less than so much impulse to come can be crossed
    double size;    // N s, to come at the end that the present step is to cross; negative: none
} Ending;

// How far the motion has got, while steps or events might pile up at one instant.
typedef struct Pace {
    size_t steps; // since
    double since_s;
    size_t events; // since
    double instant_s;
} Pace;

// Counts a step that starts at a time, and the events there. Fails with ERR_SOLVER and the joint to
// blame where steps or events have come so close together that the run would not end.
bool pace_keep(Pace *pace, const System *system, const EventList *events, double time_s, Err *err);

// The equations for the accelerations have no solution: joints hold each other up, or friction has
// no single answer. Returns false, with ERR_SOLVER.
bool pace_undetermined(const System *system, Err *err);

// Which of the two methods takes the next step: the explicit one, or the implicit one where a
// contact is damped so strongly that explicit steps are far shorter than the motion is smooth.
typedef struct Stiffness {
    Radau *radau; // owned; NULL before the first check
    size_t steps; // explicit ones since the last event or check
    // While the implicit method is on trial: the explicit step that it has to beat, s; else 0.
    double beaten_s;
    size_t wait;  // checks until another trial may follow the last one
    size_t pause; // as many were waited for after the last trial that was lost
    double cost;  // of an implicit step, in explicit ones
    // Where that is much: explicit steps that were held back since the last trial; the step that
    // was beaten then, times the rate of decay there; and by how much the implicit steps since then
    // have been worth their work, in steps.
    double held;
    double beaten_decay;
    double gain;
} Stiffness;

typedef struct Stepper {
    const Scenario *scenario;
    System *system;    // owned
    Dop853 integrator; // its tried step is the present one
    EventPoints points;
    EventList events; // at its end
    EventList found;  // room for those of a step that is checked
    Pace pace;
    Stiffness stiffness;
    bool has_step;
    double duration_s;
    double wave_s;       // the longest step that sees every sinusoid, s
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

// Carries all that steps from here on depend on; the last one's polynomial comes along.
void stepper_carry(Stepper *stepper, Carry *carry);

// Goes on by one step of some length, at whose end there may be an event. Fails with ERR_SOLVER.
bool stepper_next(Stepper *stepper, Err *err);
