// Makes the runs of a study that are missing in its store, each in a process of its own.
#pragma once

#include "commands/study/design.h"
#include "commands/study/metrics.h"
#include "commands/study/store.h"
#include "measure/task.h"

enum { SWEEP_JOB_MAX = 256 };

// How far a sweep has come; reported a few times a second.
typedef struct SweepState {
    uint64_t total;                    // runs of the shard
    uint64_t done;                     // of them in the store, those of earlier included
    uint64_t made;                     // by this process
    uint64_t failed;                   // of them, by this process
    uint64_t without_truth;            // of them successful, but without a truth
    char no_truth[RECORD_REASON_SIZE]; // why not, of the first
    double wall_s;                     // since the start
    double inside_s; // wall time of all processes that made runs and truths, added up
} SweepState;

// Why a sweep ended though nothing failed.
typedef enum SweepEnd { SWEEP_COMPLETE, SWEEP_STOPPED } SweepEnd;

typedef struct SweepWork SweepWork;

typedef struct Sweep {
    const Spec *spec;
    const Layout *layout;
    Shard shard;
    size_t jobs; // runs at a time
    Store *store;
    void (*report)(const SweepState *state, void *context);
    bool (*should_stop)(void *context); // asked often: true ends it in good order
    void *context;
    const SweepWork *work; // what the processes do; NULL for SWEEP_WORK
} Sweep;

// Fails with ERR_FILE where the store fails, with ERR_SOLVER where the system has no process left
// for a single run. A run that fails, hangs or dies is a row. The state is that at the end. Runs in
// progress at an early end are killed, and made when the study is resumed.
bool sweep_execute(const Sweep *sweep, SweepEnd *end, SweepState *state, Err *err);

// What the processes of a sweep do: one run, one truth. Tests replace it.

// The worker slot of a process, and what it needs there.
typedef struct SweepSlot {
    const SweepWork *work;
    int words;      // where its output goes: commands/study/worker.h
    int slots;      // commands/study/worker.h
    size_t number;  // of the slot
    double limit_s; // of its work
} SweepSlot;

// A run as its process sees it.
typedef struct SweepRun {
    SweepSlot slot;
    const Spec *spec;
    const Layout *layout;
    const Truth *truth; // NULL where there is none
    uint64_t run;
    bool is_alone; // it settles by itself: a process died over its block
} SweepRun;

// A truth as its process sees it.
typedef struct SweepTruth {
    SweepSlot slot;
    const Spec *spec;
    uint64_t run; // one of those that it is of
    Task task;    // its scenario alone
} SweepTruth;

struct SweepWork {
    void (*run)(const SweepRun *task, Record *record);
    void (*certify)(const SweepTruth *task, void *packed);
};

extern const SweepWork SWEEP_WORK;
