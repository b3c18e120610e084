// Which values does a run of a study have? From its number alone, so that no list of runs is ever
// held, and any machine can make any part of them.
//
// From slow to fast: the grid of what changes the truth, the draws, the grid of what does not.
#pragma once

#include "commands/study/spec.h"

// Parts that a study is ever divided into: each has a store, a file in one folder.
enum { DESIGN_SHARD_MAX = 100000 };

// A part of a study: every count-th run or group of runs. {0, 1} is all of it.
typedef struct Shard {
    uint64_t index; // from 0
    uint64_t count; // at most DESIGN_SHARD_MAX
} Shard;

// The number of runs, 1 to 2^53.
uint64_t design_run_count(const Spec *spec);

// The values of the variables of a run, in the order of the spec.
void design_values(const Spec *spec, uint64_t run, Cell values[RECORD_SETTING_MAX]);

// The number of the group of a run: runs of one group differ in nothing that changes the truth and
// follow one another.
uint64_t design_group(const Spec *spec, uint64_t run);

// The first run of a shard from a number on, or design_run_count. A shard takes whole groups where
// there are at least as many of them as shards, else single runs.
uint64_t design_next(const Spec *spec, Shard shard, uint64_t from);

// The number of runs of a shard.
uint64_t design_shard_count(const Spec *spec, Shard shard);

// The scenario of a run. Fails with ERR_CASE where its values make no valid case, saying why in
// one line.
bool design_scenario(const Spec *spec, const Cell *values, Scenario *scenario, BackendKind *backend,
                     Err *err);
