// The pieces of work that a comparison gives to child processes.
#pragma once

#include "measure/child.h"
#include "measure/ladder.h"
#include "measure/truth_pack.h"

// Bytes of one child: a run keeps its samples, some tens of megabytes; a run that needs more than
// this is out of control.
static const size_t TASK_MEMORY_LIMIT = (size_t)4 << 30;

// Runs that a truth consists of: the trajectory, once more on finer samples, a second one, and a
// perturbed one for each freedom, of which three joints with play leave six.
enum { TASK_TRUTH_RUNS = 10 };

typedef struct Task {
    Scenario scenario; // with scheme and step applied
    BackendKind backend;
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
void task_certify_alone(const void *task, void *packed);
void task_spread(const void *task, void *ensemble);

// What came of a child that did task_measure: its result, or where it did not come back the run
// that was asked for, lost.
LadderRun task_run(LadderRun asked, const LadderRun *result, const Child *child);
