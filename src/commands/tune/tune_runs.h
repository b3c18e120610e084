// The runs of a search, made side by side in child processes.
#pragma once

#include "commands/tune/tune.h"
#include "measure/task.h"

// What the search may use, and a listener.
typedef struct TuneSearch {
    Tune *tune;
    const Scenario *scenario;
    size_t jobs;         // runs at a time; timing runs go one by one
    double time_limit_s; // of one run
    // Called a few times a second, with the time left, s, INFINITY where it is not known.
    void (*wait)(const char *doing, double left_s, void *context);
    void *context;
    const Truth *truth; // that runs are held against; the search makes it
} TuneSearch;

// Runs of one kind.
typedef struct TuneRuns {
    const char *doing; // for the listener
    size_t count;      // their numbers are those below
    // Makes the scenario of the search that of a run.
    void (*apply)(void *owner, size_t number, Scenario *scenario);
    // Takes in a run that is over; one whose process died or hung is not complete.
    void (*take)(void *owner, size_t number, const LadderRun *run);
    void *owner;
    // Chooses the next run; false: none can begin now. NULL: each once, by rising number.
    bool (*choose)(void *owner, size_t *number);
    // The time, s, that runs which are chosen will still take one after another; NULL: not known.
    double (*left)(void *owner);
    bool is_timing;    // one at a time, and nothing but the time is measured
    bool is_reference; // runs of the reference, not of ODE
} TuneRuns;

// Makes the runs until none is left. Fails with ERR_SOLVER where the system has no process left.
bool tune_runs_make(const TuneSearch *search, const TuneRuns *runs, Err *err);

// What can be had at a step that is held: every scheme, and the best constants.

// Runs every scheme at the step that is held, and takes in what comes of it.
bool tune_held_run(const TuneSearch *search, Err *err);

// Adds constants to those that are to be run: the best for an impact of median mass and speed, and
// for the hardest, as kp and kd and as ERP and CFM. Adds nothing where the law has no such impact.
// Fails with ERR_SOLVER where the reference does.
bool tune_held_constants(const TuneSearch *search, Err *err);
