// The pieces of work that a comparison gives to child processes.
#pragma once

#include "measure/child.h"
#include "measure/ladder.h"
#include "measure/truth.h"

// Bytes of one child: a run keeps its samples, some tens of megabytes; a run that needs more than
// this is out of control.
static const size_t TASK_MEMORY_LIMIT = (size_t)4 << 30;

// Runs that a truth consists of: the trajectory, once more on finer samples, a second one, and a
// perturbed one for each freedom, of which three joints with play leave six.
enum { TASK_TRUTH_RUNS = 10 };

typedef struct Task {
    Scenario scenario; // with scheme and step applied
    BackendKind backend;
    const EngineDriver *driver; // of another engine, in whose place the backend then is
    const char *way;
    LadderRun run;      // kind, point and round of a run that is measured
    const Truth *truth; // NULL where there is none at hand
} Task;

// The task of a run of a ladder; the truth is needed for LADDER_ERROR, and a step that is chosen
// for a tolerance makes its own without it.
Task task_make(const Ladder *ladder, const Scenario *scenario, LadderRun run, const Truth *truth);

// Each is a ChildWork and takes a Task. What comes of it is, in this order: a LadderRun; a packed
// truth; the same by all processors, where nothing else goes on; an Ensemble.
void task_measure(const void *task, void *run);
void task_certify(const void *task, void *packed);
void task_spread(const void *task, void *ensemble);

// What came of a child that did task_measure: its result, or where it did not come back the run
// that was asked for, lost.
LadderRun task_run(LadderRun asked, const LadderRun *result, const Child *child);

// The truth of a scenario, computed in a child process, so that a crash cannot take the program
// down.

typedef struct TruthChild {
    const Scenario *scenario;
    double run_limit_s; // s, of each of the runs that the truth consists of
    void (*wait)(const char *doing, void *context); // a few times a second
    bool (*should_stop)(void *context);             // likewise; NULL: never
    void *context;
} TruthChild;

// Makes the truth; the caller finishes it. Fails with ERR_SOLVER where there is none or it was
// stopped, the truth then being zeroed. A truth that could not be certified says so in its message.
bool truth_child_make(const TruthChild *work, Truth *truth, Err *err);
