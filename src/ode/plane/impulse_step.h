// One step of the world with the contacts integrated inside it, and the state at any time in it.
#pragma once

#include "contact/touch.h"
#include "kernel/kernel.h"
#include "model/response_drift.h"
#include "model/trajectory.h"
#include "ode/impulse.h"
#include "ode/plane/impulse_curves.h"
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

typedef struct ImpulseStep {
    const Scenario *scenario;
    World world;
    Response response;      // at mid-step
    Kernel kernel;          // a joint of it is a place
    KernelIslands *islands; // of the kernel's places; NULL where they are few
    ResponseGroups groups;  // where there are islands
    ImpulseScope whole;
    size_t place_count;
    Touch *places; // owned, as are all arrays here
    double tick_s; // the finest step
    size_t tick;   // at the end of the last step, or before it
    bool
        is_kink; // whether the last step ends at a kink of the drive's speed, or where a load jumps
    double end_s; // likewise
    size_t count;
    double start_s; // of the last step
    double width_s;
    Motion *before;                      // at its start
    Motion *middle;                      // at mid-step, with the speeds of its start
    Motion *after;                       // at its end
    SteppingArm arms[LINKAGE_DRIVE_MAX]; // of the driven bodies, at mid-step
    double *free;                        // mean acceleration beside the contacts', three a body
    double *free_rate;                   // its rate of change
    double *ahead;     // of few rows, what it will be at mid-step, from the steps before, or zero
    size_t steady;     // steps before this one since the start, or since a kink
    bool is_calm;      // whether the contacts did not change the accelerations much in the last
    double *rest;      // of the end's positions, beyond the formula for inside
    double drive_work; // J, in the whole step
    double load_work;  // J, of loads, likewise
    double damped;     // J, in dampers, likewise
    KernelSums total;  // of the contacts, in the whole step
    bool has_few_rows; // what each of them does, and how that changes, is worked out in each step
    // of few rows: what 1 N s in each does to all speeds, three a body, in this step and in those
    // before it, and when these had their middles; this step's belong to `drift`
    ResponseDrift drift;
    double *columns[IMPULSE_COLUMNS];
    double middles_s[IMPULSE_COLUMNS];
    ImpulseCurves curves; // what is inside the step, once there have been so many
    double *moved[2];     // by the contacts in the whole step: speeds and positions, three a body
    double *closing;      // N s, of the ideal joints' rows, beside the world's step
    JointState *mean;     // mean forces of the ideal joints
    double *pressing;     // N, of the rows of play, likewise
    bool has_coordinates; // whether a joint that slides or is limited is to be observed
    ImpulseWork *work;
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

// Writes what the contacts have done up to a time in the step to the speeds and to the positions of
// all bodies, three each, from their sums.
void impulse_step_push_bodies(const ImpulseStep *step, double since_s, const KernelSums *sums,
                              double *speeds, double *positions);

// Whether the curves of the last step are known: of few rows, once there have been steps enough.
static inline bool impulse_step_has_curves(const ImpulseStep *step)
{
    return step->has_few_rows && step->count >= IMPULSE_COLUMNS;
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
