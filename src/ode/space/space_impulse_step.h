// One step of a world in space with the contacts integrated inside it, and the state at any time in
// it: ode/plane/impulse_step.h in space.
#pragma once

#include "contact/pin_space_rows.h"
#include "contact/stop_space.h"
#include "kernel/step.h"
#include "model/space_response_groups.h"
#include "ode/impulse.h"
#include "ode/space/space_joints.h"
#include "ode/space/space_world.h"

enum { SPACE_IMPULSE_ROOMS = 2 };

typedef struct SpaceImpulseStep {
    KernelStep scheme; // six coordinates a body: what a SpaceChange has
    const Scenario *scenario;
    World world;
    SpaceResponse *response; // at mid-step; owned
    SpaceResponse *there;    // at whatever time is looked at; owned
    ResponseGroups groups;   // where there are islands
    ImpulseScope whole;
    size_t place_count;
    size_t pin_count; // of them the first, which are of pins; the others are stops
    PinSpace *places; // of pins; owned, as are all arrays here
    StopSpace *stops;
    double *angles;     // rad, by joint: of limited ones at the start of the step
    PinSpaceRows *rows; // by place, at mid-step; of a stop the first two rows alone
    int driven;         // body, or LINKAGE_GROUND
    ImpulseTicks ticks;
    SpaceMotion *before;   // by body, at the start of the last step
    SpaceMotion *after;    // at its end
    Vec3 *gyration;        // rad/s^2, of turning inertias, in the step
    SpaceMotion *middle;   // at mid-step, with the speeds of the start
    double drive_work;     // J, in the whole step
    SpaceHold *hold;       // owned; NULL where the ideal joints are rows of ODE
    Vec3 *mean;            // N, by joint: mean forces of the ideal ones on bodies b
    SpaceChange on_driven; // N, N m: mean of what they do to the driven body
    Err *err;              // of the step that is being taken
    // room to work in
    SpaceMotion *motions;
    SpaceChange *changes[SPACE_IMPULSE_ROOMS]; // by body
    SpaceRow *play_rows;                       // by row of play
    double *play;                              // likewise
    double *ideal;                             // by ideal row, of as many as there can be
    Vec3 *forces;                              // by joint
} SpaceImpulseStep;

// Whether a body moves by the forces on it, and not by the drive.
static inline bool space_impulse_step_is_free(const SpaceImpulseStep *step, size_t body)
{
    return (int)body != step->driven;
}

// Builds the world of a scenario at its start. The step must not be copied, and is to be finished
// after a failure too.
bool space_impulse_step_init(const Scenario *scenario, SpaceImpulseStep *step, Err *err);
void space_impulse_step_finish(SpaceImpulseStep *step);

// The joint that a place is of.
static inline int space_impulse_step_joint(const SpaceImpulseStep *step, size_t place)
{
    return step->scheme.kernel.contacts[place].joint;
}

// The stop that a place is; NULL of a pin's.
static inline const StopSpace *space_impulse_step_stop(const SpaceImpulseStep *step, size_t place)
{
    return place < step->pin_count ? NULL : &step->stops[place - step->pin_count];
}

// Takes the next step.
bool space_impulse_step_take(SpaceImpulseStep *step, Err *err);

// How the bodies of a scope move and what its joints do at a time within the step, from the
// contacts' sums up to then.
void space_impulse_step_inside(const SpaceImpulseStep *step, const ImpulseScope *scope,
                               ImpulseTime at, const KernelSums *sums, SpaceMotion *motions,
                               SpaceJoints *joints);
