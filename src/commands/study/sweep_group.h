// Runs that share one truth, and the truth as long as it is needed.
#pragma once

#include "commands/study/sweep.h"
#include "commands/study/sweep_work.h"

typedef enum SweepGroupState {
    SWEEP_GROUP_NONE,   // no group
    SWEEP_GROUP_WANTED, // its truth is to be made
    SWEEP_GROUP_MAKING, // its truth is being made
    SWEEP_GROUP_READY,  // its runs may start
} SweepGroupState;

typedef struct SweepGroup {
    SweepGroupState state;
    uint64_t next;      // its next run to be started, or end
    uint64_t end;       // number behind its last
    size_t busy;        // of its runs at work
    bool has_truth;     // of SWEEP_GROUP_READY
    bool lacks_truth;   // there should be one, and it cannot be computed
    Truth truth;        // owned
    SweepTruth *wanted; // owned; while the truth is to be made
    void *packed;       // owned; the truth as it arrives
    size_t packed_size; // bytes
    size_t lost;        // processes that died over the truth
} SweepGroup;

// Finds the first run of the sweep from a number on, and below an end, that is not in its store;
// the end where there is none. ERR_FILE.
bool sweep_group_next(const Sweep *sweep, uint64_t from, uint64_t end, uint64_t *run, Err *err);

// Opens the group that a run is the first of to be made.
void sweep_group_open(const Sweep *sweep, uint64_t run, SweepGroup *group);

// Takes the result of the truth's process, which has ended. False where the truth is to be tried
// again. `reason`, of RECORD_REASON_SIZE, is filled where it cannot be computed.
bool sweep_group_take(SweepGroup *group, const Child *child, char *reason);

// The limits of the process that makes a truth.
ChildLimits sweep_group_limits(const Sweep *sweep);

// Drops the truth. Accepts zeroed groups, and leaves one.
void sweep_group_close(SweepGroup *group);
