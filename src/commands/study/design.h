// The values of each run of a study, from the run's number alone, so that no list of runs is kept.
// From its number alone, so that no list of runs is ever held, and any machine can make any part of
// them.
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

// One of the values of a variable of the grid that takes numbers, from 0.
double design_number(const Variable *variable, uint64_t digit);

// The values of the variables of a run, in the order of the spec.
void design_values(const Spec *spec, uint64_t run, Cell values[RECORD_SETTING_MAX]);

// The number of the group of a run: runs of one group differ in nothing that changes the truth and
// follow one another.
uint64_t design_group(const Spec *spec, uint64_t run);

// The number of runs of a group.
uint64_t design_group_size(const Spec *spec);

// Groups in a row that look for their settled motions together (commands/study/neighbours.h).
enum { DESIGN_BLOCK_GROUPS = 20 };

// The number of runs that are made by one process after another: of a block where there are such,
// which the last run may end before, else of a group.
uint64_t design_block_size(const Spec *spec);

// The first run of a shard from a number on, or design_run_count. A shard takes whole blocks
// where there are at least as many of them as shards, or whole groups, else single runs.
uint64_t design_next(const Spec *spec, Shard shard, uint64_t from);

// The number of runs of a shard.
uint64_t design_shard_count(const Spec *spec, Shard shard);

// The scenario of a run. Fails with ERR_CASE where its values make no valid case, saying why in
// one line.
bool design_scenario(const Spec *spec, const Cell *values, Scenario *scenario, BackendKind *backend,
                     Err *err);

// Random numbers by their position: what a draw of a variable is follows from its number alone, so
// that no list of draws is ever held, and any machine can make any of them.

// A number above 0 and below 1 of a stream, independent of all other positions and streams.
double draw_share(uint64_t seed, uint64_t stream, uint64_t position);

// The position of an item, below count, in an order of the items 0 to count - 1 that is as good as
// shuffled: another for each stream. Needs no memory. The count is 1 to 2^53.
uint64_t draw_position(uint64_t seed, uint64_t stream, uint64_t count, uint64_t item);

// The stream of a variable: that of its key, so that one variable more changes no other's draws.
uint64_t draw_stream(const char *key);

// The share, above 0 and below 1, of a variable's distribution below the value that it has in a
// draw. Of a Latin hypercube the draws of each variable fall one into each of `draws` equal shares;
// of DRAW_SOBOL those of each sample do, of which draw_base draws follow one another: the first two
// are independent, and each further one has one of the variables of the second, the others of the
// first.
double draw_variable_share(const Spec *spec, const Variable *variable, uint64_t draw);

// The value that has the share of a drawn variable's distribution below it; a whole number where
// the variable is.
double draw_value(const Variable *variable, double share);
