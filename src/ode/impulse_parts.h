// Mechanisms that share nothing but the ground, side by side: contacts integrated within the step.
#pragma once

#include "model/solver.h"

#include <ode/ode.h>

// How many mechanisms of a linkage can be stepped apart; 1 where they have to be stepped
// together.
size_t impulse_parts_count(const Scenario *scenario);

// Whether the part that an impulse solver has taken last ends with its step.
bool impulse_is_at_end(const void *state);
dWorldID impulse_world(const void *state);

// How a mechanism by itself is stepped, whether the part that was taken last ends with its step,
// and its world.
typedef struct ImpulsePartsOf {
    const Solver *solver;
    bool (*is_at_end)(const void *state);
    dWorldID (*world)(const void *state);
} ImpulsePartsOf;

// A solver of several mechanisms, each stepped so: impulse_parts_open and the rest.
bool impulse_parts_open(const Scenario *scenario, const ImpulsePartsOf *of, void **state, Err *err);
bool impulse_parts_step(void *state, double stop_s, Err *err);
StepRecord impulse_parts_record(const void *state);
void impulse_parts_observe(const void *state, double time_s, Sample *sample);
void impulse_parts_observe_part(const void *state, double time_s, Sample *sample);
SolverModel impulse_parts_model(const void *state);
void impulse_parts_close(void *state);

extern const Solver STEPPING_IMPULSE_PARTS; // of several in the plane
