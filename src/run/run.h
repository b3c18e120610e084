// One scenario on one solver makes one trajectory, observed at every step, timed.
#pragma once

#include "run/recorder.h"

// Called now and then with the share of the run that is done, 0 to 1, and the wall time so far, s.
typedef void (*RunProgress)(double share, double wall_s, void *context);

typedef struct RunWatch {
    RunProgress progress; // NULL: not wanted
    void *context;
} RunWatch;

// What looks at every step of a run besides the recorder, for those who ask for more than that. The
// trajectory keeps ranges, too, where the scenario's options say that somebody reads them.
typedef struct RunProbe {
    // Once the solver is open; what the probe asks the solver for it shows to the recorder. NULL:
    // there is nothing to look at in this run.
    void *(*begin)(const Scenario *scenario, const Solver *solver, const void *state,
                   Recorder *recorder, const void *shared);
    void (*look)(void *own, const StepRecord *step);
    // Fills in what it found, where the trajectory is complete, and frees its own.
    void (*end)(void *own, Trajectory *trajectory);
    // What is the same in all runs of a scenario, whatever their step: for `shared`, and free.
    // NULL: nothing is.
    void *(*share)(const Scenario *scenario);
    const void *shared; // NULL: each run finds it itself
} RunProbe;

// Asked at every sample whether the run is to go on: it ends where the answer is no, which is then
// the reason that it is not complete.
typedef struct RunGuard {
    // The samples up to this one stand in the trajectory.
    bool (*may_go_on)(const Trajectory *trajectory, size_t sample, void *context, Err *err);
    void *context;
} RunGuard;

// Runs the scenario. Never fails as a function: where the solver fails, the trajectory is not
// complete and says when and why. The caller destroys it.
Trajectory *run_scenario(const Scenario *scenario, const Solver *solver, RunWatch watch);

// The same with a probe and ranges, and with a guard; without them where they are NULL.
Trajectory *run_guarded(const Scenario *scenario, const Solver *solver, RunWatch watch,
                        const RunProbe *probe, const RunGuard *guard);

// Runs the scenario for the bodies' positions and velocities at the samples alone:
// nothing else in the trajectory is for use but whether it is complete, or why not.
Trajectory *run_motion(const Scenario *scenario, const Solver *solver, RunWatch watch);

// 1: of a step, by so little before a sample as one ends that has reached it.
extern const double RUN_ROUNDING;

// Whether the motion of a part, or of all bodies (NULL), is determined at a sample. Fails with
// ERR_SOLVER.
bool run_check_sample(const Linkage *linkage, const SolverPart *part, const Sample *sample,
                      Err *err);
