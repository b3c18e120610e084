// A solver's state at instants inside its last step, where it provides them.
#pragma once

#include "run/recorder.h"

// of a step; a chord of a quarter of a swing is then off by 1e-3 of its height
enum { LOOK_PARTS_MAX = 16, LOOK_TOPS_MAX = 8, LOOK_MAX = LOOK_PARTS_MAX + LOOK_TOPS_MAX };

// The signals at one instant.
typedef struct Look {
    double time_s;
    double omega[LINKAGE_BODY_MAX];
    double alpha[LINKAGE_BODY_MAX];
    double force[LINKAGE_JOINT_MAX];
} Look;

// Whom to ask; nothing owned. What it says the recorder sees, too.
typedef struct Looker {
    const Scenario *scenario;
    const Solver *solver;
    const void *state; // of the solver
    Recorder *recorder;
} Looker;

Look look_inside(const Looker *looker, double time_s);

// The end of a step as its record has it.
Look look_at_end(const Looker *looker, const StepRecord *step);

// Looks in a step for maxima and minima of the signals that come near the run's extremes, down to
// rounding. `before` is the start of the step, the looks the ends of its parts, LOOK_PARTS_MAX at
// most. Those at maxima are put in between; returns how many looks there are then.
int look_for_extremes(const Looker *looker, const Look *before, int parts, Look looks[LOOK_MAX]);
