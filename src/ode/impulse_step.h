// One step of the world with the contacts integrated inside it, and the state at any time in it.
#pragma once

#include "contact/encounter_islands.h"
#include "contact/touch.h"
#include "model/trajectory.h"
#include "ode/impulse_scope.h"
#include "ode/world.h"

enum { IMPULSE_COLUMNS = 3 }; // steps of which it is known what rows do: a parabola in time

// What a step works with: arrays by row of the response, by body three numbers each, by body and by
// joint.
typedef struct ImpulseWork {
    Response there; // at whatever time is looked at
    double *rows[2];
    double *changes[2];
    Motion *motions;
    BodyLoad *loads;
    Vec2 *offsets;
    JointState *joints;
} ImpulseWork;

typedef struct ImpulseStep {
    const Scenario *scenario;
    World world;
    Response response;         // at mid-step
    Encounter encounter;       // a joint of it is a place
    EncounterIslands *islands; // of the encounter's places; NULL where they are few
    ResponseGroups groups;     // where there are islands
    ImpulseScope whole;
    size_t place_count;
    Touch *places; // owned, as are all arrays here
    int driven;    // body, or LINKAGE_GROUND
    double tick_s; // the finest step
    size_t tick;   // at the end of the last step, or before it
    bool is_kink;  // whether the last step ends at a kink of the drive's speed
    double end_s;  // likewise
    size_t count;
    double start_s; // of the last step
    double width_s;
    Motion *before;      // at its start
    Motion *middle;      // at mid-step, with the speeds of its start
    Motion *after;       // at its end
    double *free;        // mean acceleration beside the contacts', three a body
    double *free_rate;   // its rate of change
    double *rest;        // of the end's positions, beyond the formula for inside
    double drive_work;   // J, in the whole step
    double damped;       // J, in dampers, likewise
    EncounterSums total; // of the contacts, in the whole step
    // of few rows: what 1 N s in each does to all speeds, three a body, in this step and in those
    // before it, and when these had their middles; NULL where there are more rows
    double *columns[IMPULSE_COLUMNS];
    double middles_s[IMPULSE_COLUMNS];
    double *moved[2]; // by the contacts in the whole step: speeds and positions, three a body
    double *closing;  // N s, of the ideal joints' rows, beside the world's step
    JointState *mean; // mean forces of the ideal joints
    ImpulseWork *work;
} ImpulseStep;

// Whether a body moves by the forces on it, and not by the drive.
static inline bool impulse_step_is_free(const ImpulseStep *step, size_t body)
{
    return (int)body != step->driven;
}

// Builds the world of a scenario at its start. The step must not be copied, and is to be finished
// after a failure too.
bool impulse_step_init(const Scenario *scenario, ImpulseStep *step, Err *err);
void impulse_step_finish(ImpulseStep *step);

// How the places of a response move each other.
EncounterCoupling impulse_step_coupling(const Response *response);

// Adds what an ideal joint does to its body b: the values of its two rows, forces in N, the first
// of which is given; a linkage's bodies are where the motions say.
void impulse_step_add_ideal(const ImpulseStep *step, size_t row, const double *values,
                            const Motion *motions, JointState *state);

// Adds what an end of a limited coordinate presses with, N or N m.
void impulse_step_add_end(const Linkage *linkage, const Touch *place, double pressing,
                          const Motion *motions, JointState *state);

// Finds the mean forces of the joints with play and the works of the drive and of dampers in the
// step that has just been taken, from the bodies at mid-step.
void impulse_step_find_work(ImpulseStep *step, const Motion *middle);

// Writes what impulses in the rows of play do to the speeds of all bodies, three each, at mid-step.
void impulse_step_apply(const ImpulseStep *step, const double *impulses, double *changes);

// Takes the next step.
bool impulse_step_take(ImpulseStep *step, Err *err);

// Of a step: springs, dampers and torque push the bodies, which move as given at mid-step; and once
// the contacts are integrated, what the dampers feel of when in the step their impulse came.
void impulse_step_push(ImpulseStep *step, const Motion *middle);
void impulse_step_push_late(ImpulseStep *step, const Motion *middle);

// How the bodies of a scope move and what its joints do then, from the contacts' sums up to then,
// and how deep each place is, m.
void impulse_step_inside(const ImpulseStep *step, const ImpulseScope *scope, ImpulseTime at,
                         const EncounterSums *sums, Motion *motions, JointState *joints,
                         double *depths);
