// One step of a world in space with the contacts integrated inside it, and the state at any time in
// it: ode/impulse_step.h in space.
#pragma once

#include "contact/encounter.h"
#include "contact/pin_space_rows.h"
#include "ode/space_joints.h"
#include "ode/space_world.h"

typedef struct SpaceImpulseStep {
    const Scenario *scenario;
    World world;
    SpaceResponse *response; // at mid-step; owned
    SpaceResponse *there;    // at whatever time is looked at; owned
    Encounter encounter;     // a joint of it is a place
    size_t place_count;
    PinSpace places[PIN_SPACE_MAX];
    PinSpaceRows rows[PIN_SPACE_MAX]; // at mid-step
    int driven;                       // body, or LINKAGE_GROUND
    double tick_s;                    // the finest step
    size_t tick;                      // at the end of the last step
    double end_s;                     // likewise
    size_t count;
    double start_s; // of the last step
    double width_s;
    SpaceMotion before[SPACE_BODY_MAX];    // at its start
    SpaceMotion after[SPACE_BODY_MAX];     // at its end
    SpaceChange free[SPACE_BODY_MAX];      // mean acceleration beside the contacts'
    SpaceChange free_rate[SPACE_BODY_MAX]; // its rate of change
    SpaceChange rest[SPACE_BODY_MAX];      // of the end's positions, beyond the formula for inside
    Vec3 gyration[SPACE_BODY_MAX];         // rad/s^2, of turning inertias, in the step
    SpaceMotion middle[SPACE_BODY_MAX];    // at mid-step, with the speeds of the start
    double drive_work;                     // J, in the whole step
    EncounterSums total;                   // of the contacts, in the whole step
    double closing[SPACE_COLUMN_MAX];      // N s, of the ideal rows, beside the step of the world
    Vec3 mean[SPACE_JOINT_MAX];            // N, mean forces of the ideal joints on bodies b
    SpaceChange on_driven;                 // N, N m: mean of what they do to the driven body
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

// Takes the next step: all but its mean forces and the work of the drive, which
// ode/space_impulse_means.h finds.
bool space_impulse_step_take(SpaceImpulseStep *step, Err *err);

// How the bodies move and what the joints do at a time since the step's start, from the contacts'
// sums up to then. Accelerations at a peak are worked out where the bodies are, else at mid-step.
void space_impulse_step_inside(const SpaceImpulseStep *step, size_t node, double since_s,
                               bool is_peak, const EncounterSums *sums, SpaceMotion *motions,
                               SpaceJoints *joints);
