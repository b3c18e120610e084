// One step of the world with the contacts integrated inside it, and the state at any time in it.
#pragma once

#include "contact/touch.h"
#include "kernel/step.h"
#include "model/response_drift.h"
#include "model/trajectory.h"
#include "ode/impulse.h"
#include "ode/plane/impulse_curves.h"
#include "ode/plane/impulse_rubs.h"
#include "ode/plane/world.h"
#include "ode/stepping.h"

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

// What an ideal joint does to its body b.
typedef struct ImpulseHold {
    Vec2 force;    // N
    double moment; // N m
} ImpulseHold;

typedef struct ImpulseStep {
    KernelStep scheme; // three coordinates a body
    const Scenario *scenario;
    World world;
    Response response;     // at mid-step
    ResponseGroups groups; // where there are islands
    ImpulseScope whole;
    size_t place_count;
    size_t
        touch_count; // of these, the first, at which bodies touch; the others are joints that rub
    Touch *places;   // owned, as are all arrays here
    ImpulseRubs rubs;
    ImpulseTicks ticks;
    Motion *before;                      // at the start of the last step
    Motion *middle;                      // at mid-step, with the speeds of its start
    Motion *after;                       // at its end
    SteppingArm arms[LINKAGE_DRIVE_MAX]; // of the driven bodies, at mid-step
    double drive_work;                   // J, in the whole step
    double load_work;                    // J, of loads, likewise
    double damped;                       // J, in dampers, likewise
    double rubbed;                       // J, in pivots that drives turn, likewise
    ResponseDrift drift;                 // with drift: of few rows
    ImpulseCurves curves;                // what is inside the step, once there have been so many
    JointState *mean;                    // mean forces of the ideal joints
    ImpulseHold *hold;      // with drift, of these: what they do beside answering the contacts
    ImpulseHold *hold_rate; // how that changes, per s
    bool has_coordinates;   // whether a joint that slides or is limited is to be observed
    ImpulseWork *work;
    Err *err; // of the step that is being taken
} ImpulseStep;

// Whether a body moves by the forces on it, and not by the drive.
static inline bool impulse_step_is_free(const ImpulseStep *step, size_t body)
{
    return !linkage_is_driven(&step->scenario->linkage, (int)body);
}

// Puts the driven bodies to a time within the step, from where they stand at its middle.
void impulse_step_place_driven(const ImpulseStep *step, double time_s, Motion *motions);

// Builds the world of a scenario at its start, for a linkage in space that never leaves the plane
// with the scenario in space, else NULL. The step must not be copied, and is to be finished after a
// failure too.
bool impulse_step_init(const Scenario *scenario, const Scenario *spatial, ImpulseStep *step,
                       Err *err);
void impulse_step_finish(ImpulseStep *step);

// Adds what a prismatic joint does to its body b: the values of its two rows, N and N m; a
// linkage's bodies are where the motions say.
void impulse_step_add_sliding(const Linkage *linkage, int joint, const double *values,
                              const Motion *motions, JointState *state);

// The same of any ideal joint, of which the first row is given: forces in N.
static inline void impulse_step_add_ideal(const ImpulseStep *step, size_t row, const double *values,
                                          const Motion *motions, JointState *state)
{
    const Linkage *linkage = &step->scenario->linkage;
    const int number = step->response.joint_of[row];
    const Joint *joint = &linkage->joints[number];
    if (joint_slides(joint->kind)) {
        impulse_step_add_sliding(linkage, number, values, motions, state);
    } else {
        state->force_on_b = vec2_add(state->force_on_b, (Vec2){values[0], values[1]});
    }
    if (joint->limits.kind == LIMIT_NONE) {
        state->force = vec2_length(state->force_on_b);
    }
}

// What acts in the rows of a slot, in the world.
Vec2 impulse_step_from_slot(const Linkage *linkage, const Touch *place, const Motion *motions,
                            Vec2 in_rows);

// Adds what an end of a limited coordinate presses with, N or N m.
void impulse_step_add_end(const Linkage *linkage, const Touch *place, double pressing,
                          const Motion *motions, JointState *state);

// Whether the curves of the last step are known: of few rows, once there have been steps enough.
static inline bool impulse_step_has_curves(const ImpulseStep *step)
{
    return step->scheme.has_drift && step->scheme.count >= KERNEL_COLUMNS_KNOWN;
}

// Finds the mean forces of the joints with play and the works of the drives, of loads and of
// dampers in the step that has just been taken, from the bodies at mid-step (impulse_work.c).
void impulse_step_find_work(ImpulseStep *step, const Motion *middle);

// Takes the next step.
bool impulse_step_take(ImpulseStep *step, Err *err);

// How the bodies of a scope move and what its joints do then, from the contacts' sums up to then,
// and how deep each place is, m.
void impulse_step_inside(const ImpulseStep *step, const ImpulseScope *scope, ImpulseTime at,
                         const KernelSums *sums, Motion *motions, JointState *joints,
                         double *depths);

// The same of a scope in which single bodies or joints are asked for: accelerations of those that
// are placed, as all are at a peak, and joints where they are not NULL.
void impulse_step_inside_some(const ImpulseStep *step, const ImpulseScope *scope, ImpulseTime at,
                              const KernelSums *sums, Motion *motions, JointState *joints,
                              double *depths);
