// Makes the runs of a ladder, each in a child process.
#pragma once

#include "measure/ladder.h"

// Called as results come. A keeper that fails ends everything with its error.
typedef struct RunnerListener {
    bool (*keep_truth)(const LadderTruth *truth, void *context, Err *err);
    bool (*keep_run)(const LadderRun *run, void *context, Err *err);
    bool (*keep_ensemble)(size_t scheme, const LadderEnsemble *ensemble, void *context, Err *err);
    void (*wait)(const char *doing, void *context); // a few times a second
    bool (*should_stop)(void *context);             // likewise; NULL: never
    void *context;
} RunnerListener;

typedef struct Runner {
    Ladder *ladder;
    const Scenario *scenario;
    size_t jobs;         // error runs and ensembles at a time; timing runs go one by one
    double time_limit_s; // of one run; an ensemble or the truth may take that for each of theirs
    RunnerListener listener;
} Runner;

// Makes all that is missing in the ladder: the truth, the error runs, the timing runs, and where
// the truth is limited by a horizon the ensembles. A run that fails, hangs or dies is a failed run
// of the ladder. Fails with ERR_SOLVER where there is no truth or it was stopped, and with what a
// keeper says.
bool runner_execute(const Runner *runner, Err *err);
