// The runs of a check, each start in a process of its own.
#pragma once

#include "compare/check_measure.h"

// One start of one case, and what came of it.
typedef struct CheckWork {
    const Scenario *scenario; // from its own start
    CheckPlan plan;
    CheckStart start;
    CheckMeasure *measure; // owned by the caller
} CheckWork;

typedef struct CheckWorkers {
    size_t jobs;                                            // at a time
    double time_limit_s;                                    // of one work
    void (*wait)(size_t done, size_t total, void *context); // a few times a second
    void *context;
} CheckWorkers;

// Does all of it. A process that dies or hangs leaves a measure that is not complete and says so.
// Fails with ERR_SOLVER where the system has no process left.
bool check_work_do(const CheckWorkers *workers, CheckWork *works, size_t count, Err *err);
