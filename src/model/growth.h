// How far small changes of the start drive two motions apart: by the fastest of all of them.
#pragma once

#include "base/side_by_side.h"
#include "model/perturb.h"
#include "model/solver.h"

// A sign of life from work that takes long.
typedef struct GrowthPulse {
    void (*beat)(void *context); // NULL: none is wanted
    void *context;
} GrowthPulse;

typedef struct GrowthWork {
    const Solver *solver;
    const Scenario *scenario;       // unperturbed
    const Trajectory *beside;       // its motion; growth is looked at at its samples
    const DistanceMeasure *measure; // of that
    const PerturbBasis *basis;      // the starts that are run
    double size;                    // of their perturbations, before the basis stretches them
    double most;                    // growth at which it ends
    double until_s;                 // or here, s
    size_t threads;                 // that may run starts at the same time, at least 1
    GrowthPulse pulse;              // from the caller's thread alone
} GrowthWork;

typedef struct Growth {
    double until_s;  // the last sample up to which the growth is not above the most, s
    double largest;  // 1: growth up to there, at least 1
    bool is_limited; // whether it came to the most
    bool is_failed;  // a perturbed run failed, for which `failure` has the reason
    Err failure;
    size_t steps; // of all perturbed runs
    size_t evaluations;
} Growth;

// Runs the starts of the basis side by side up to where the growth comes to the most.
Growth growth_find(const GrowthWork *work);

// The same among other work that goes on side by side (base/side_by_side.h): pieces of perturbed
// runs, as many at a time as the basis has starts. The work and all that it points to must stay;
// its number of threads does not matter.
typedef struct GrowthRuns GrowthRuns;
GrowthRuns *growth_begin(const GrowthWork *work);
SideBySideNext growth_next(size_t *index, void *runs);
void growth_walk(size_t index, bool is_callers, void *runs);
void growth_walked(size_t index, void *runs);

// What came of it up to a time, s, which may be known only now; no piece may be going on. Frees the
// runs.
Growth growth_end(GrowthRuns *runs, double until_s);
