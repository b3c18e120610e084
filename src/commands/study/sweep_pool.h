// The processes of a sweep: which are at work, and what is to be started next.
#pragma once

#include "commands/study/sweep_group.h"

enum { SWEEP_SLOT_DEPTH = 2 }; // processes of a slot: one at work, one ready

// One process. It lives for many runs of one group, since it knows the truth from its start.
typedef struct SweepJob {
    SweepGroup *group; // NULL: none
    bool is_truth;
    SweepSlot slot;
    SweepRun run;
    Record record;
    uint64_t serves; // the worker there: `end` of the group whose truth it knows
    size_t made;     // and the runs that it was given
} SweepJob;

typedef struct SweepPool {
    const Sweep *sweep;
    const SweepWork *work;
    SweepState *state;
    int slots;
    size_t slot_count;
    double *ended_s;  // by the clock, of each slot's last process
    size_t job_count; // those of slot k are k, k + slot_count, ...
    SweepJob *jobs;
    Child *children; // of the jobs
    size_t group_count;
    SweepGroup *groups;
    uint64_t from; // the first run of no group yet
    uint64_t end;  // number of runs of the study
    size_t busy;   // processes
    bool has_news; // rows were added to the store
} SweepPool;

void sweep_pool_open(const Sweep *sweep, SweepState *state, SweepPool *pool);

// Ends the processes that are still there.
void sweep_pool_close(SweepPool *pool);

// Whether anything is left to be done.
bool sweep_pool_has_more(const SweepPool *pool);

// Starts a process for every free job, as far as there is work. Fails with ERR_FILE where the store
// does, with ERR_SOLVER where the system has no process at all.
bool sweep_pool_fill(SweepPool *pool, Err *err);

// Takes the results of ended processes into the store and the state, and closes finished groups.
// ERR_FILE.
bool sweep_pool_take(SweepPool *pool, Err *err);
