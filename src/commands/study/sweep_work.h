// What the processes of a sweep do: one run, one truth. Tests replace it.
#pragma once

#include "commands/study/metrics.h"
#include "commands/study/sweep.h"
#include "measure/task.h"

// The worker slot of a process, and what it needs there.
typedef struct SweepSlot {
    const SweepWork *work;
    int words;      // where its output goes: study/last_words.h
    int slots;      // study/slot.h
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
} SweepRun;

// A truth as its process sees it.
typedef struct SweepTruth {
    SweepSlot slot;
    Task task; // its scenario alone
} SweepTruth;

struct SweepWork {
    void (*run)(const SweepRun *task, Record *record);
    void (*certify)(const SweepTruth *task, void *packed);
};

extern const SweepWork SWEEP_WORK;

// Each is a ChildWork: takes a SweepRun or SweepTruth, waits for its slot, and does its work with
// its output captured.
void sweep_work_run(const void *task, void *record);
void sweep_work_certify(const void *task, void *packed);

// Marks a process that its slot's time limit ended as timed out; SIGALRM did it.
void sweep_work_mark_timeout(const SweepSlot *slot, Child *child);

// The record of a run whose process ended without one: why is in the child and in its last words.
void sweep_work_lost(const SweepRun *run, const Child *child, double wall_s, Record *record);
