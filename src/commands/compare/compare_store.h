// Where a comparison keeps what it has finished, and how it goes on from there.
#pragma once

#include "commands/compare/compare_options.h"
#include "measure/runner.h"
#include "write/journal.h"

enum { COMPARE_MACHINE_SIZE = 128 };

typedef struct CompareStore {
    Journal journal;
    const Linkage *linkage;
    const Ladder *ladder;
    char machine[COMPARE_MACHINE_SIZE]; // the processor, as the system names it
    size_t taken;                       // runs that were there
} CompareStore;

// Opens the store that the options name, or the usual one, which is named after its key, and takes
// the runs in it into the ladder. Says on standard error, unless quiet, what was taken. ERR_FILE.
bool compare_store_open(CompareStore *store, const CompareOptions *options,
                        const Scenario *scenario, Ladder *ladder, Err *err);

// The keepers of a runner, with the store as their context.
bool compare_store_keep_truth(const LadderTruth *truth, void *store, Err *err);
bool compare_store_keep_run(const LadderRun *run, void *store, Err *err);
bool compare_store_keep_ensemble(size_t scheme, const LadderEnsemble *ensemble, void *store,
                                 Err *err);

// Accepts a zeroed store.
void compare_store_close(CompareStore *store);
