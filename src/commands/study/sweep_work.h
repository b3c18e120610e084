// What the processes of a sweep do: one run, one truth. Tests put other work in its place.
#pragma once

#include "commands/study/metrics.h"
#include "commands/study/sweep.h"
#include "measure/task.h"

// Where a process works.
typedef struct SweepPlace {
    const SweepWork *work;
    int words; // where what it says goes: base/last_words.h
    int lanes; // study/lane.h
    size_t lane;
    double limit_s; // of its work
} SweepPlace;

// A run as its process sees it.
typedef struct SweepRun {
    SweepPlace place;
    const Spec *spec;
    const Layout *layout;
    const Truth *truth; // NULL where there is none
    uint64_t run;
} SweepRun;

// A truth as its process sees it.
typedef struct SweepTruth {
    SweepPlace place;
    Task task; // its scenario alone
} SweepTruth;

struct SweepWork {
    void (*run)(const SweepRun *task, Record *record);
    void (*certify)(const SweepTruth *task, void *packed);
};

extern const SweepWork SWEEP_WORK;

// Each is a ChildWork: takes a SweepRun or SweepTruth, waits for its lane, and does its work out of
// everyone's earshot.
void sweep_work_run(const void *task, void *record);
void sweep_work_certify(const void *task, void *packed);

// Tells a process that its lane's limit ended from one that a signal did.
void sweep_work_tell_time(const SweepPlace *place, Child *child);

// The record of a run whose process ended without one: why is in the child and in its last words.
void sweep_work_lost(const SweepRun *run, const Child *child, double wall_s, Record *record);
