// A solver taken from sample to sample, without anything recorded on the way.
#pragma once

#include "model/solver.h"

// A sign of life from work that takes long.
typedef struct WalkPulse {
    void (*beat)(void *context); // NULL: nobody waits for it
    void *context;
} WalkPulse;

typedef struct Walk {
    const Solver *solver;
    WalkPulse pulse;
    void *state;
    bool has_step;
    double reached_s;
} Walk;

// Opens the solver on a scenario. Fails as Solver.open does, with nothing to close.
bool walk_open(Walk *walk, const Solver *solver, const Scenario *scenario, WalkPulse pulse,
               Err *err);

// Goes on to a time, not before the last one, and looks at the bodies and joints there. Fails as
// Solver.step does.
bool walk_to(Walk *walk, double time_s, Sample *sample, Err *err);

// Closes the solver and adds what it has done to the counts.
void walk_close(Walk *walk, size_t *steps, size_t *evaluations);
