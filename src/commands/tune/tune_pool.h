// Runs that go on side by side, each in a process of its own, taken in as they end.
#pragma once

#include "measure/child.h"
#include "measure/task.h"

enum { TUNE_POOL_MAX = 256 };

typedef struct TunePoolJob {
    bool is_busy;
    size_t tag; // the caller's own
    Task task;
    LadderRun run;
} TunePoolJob;

typedef struct TunePool {
    size_t jobs;         // at most so many at a time
    double time_limit_s; // of one run
    size_t busy;
    TunePoolJob *places; // owned
    Child *children;     // owned
} TunePool;

void tune_pool_init(TunePool *pool, size_t jobs, double time_limit_s);

// Ends what is still running; accepts a zeroed pool.
void tune_pool_finish(TunePool *pool);

bool tune_pool_has_place(const TunePool *pool);

// Starts the run of a task in a free place. Fails with ERR_SOLVER where the system has no process
// left.
bool tune_pool_start(TunePool *pool, const Task *task, size_t tag, Err *err);

// Waits a moment, at most, for a run that is over, and hands it on with its tag. A run whose
// process died or hung is one that is not complete. Returns false where none has ended.
bool tune_pool_take(TunePool *pool, size_t *tag, LadderRun *run);
