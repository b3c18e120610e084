// The store of a study: one SQLite file with a row for each run that is over.
//
// Tables: `study` (name, value: what makes rows of one store comparable), `run` (a row a run, its
// settings and results as columns, and their checksum) and `effort` (what differs each time:
// the wall time of each run, and its checksum). A row is written whole, and once. A reader of a
// store in use sees what has been committed. A store may not be used or closed in a process forked
// off the one that opened it.
#pragma once

#include "base/err.h"
#include "commands/study/record.h"

#include <stdbool.h>

enum { STORE_KEY_SIZE = 64, STORE_KEY_MAX = 16 };

// A value that must be equal for the rows of a store to be those of a study (of study, case or
// program), and the message where it is not.
typedef struct StoreKey {
    const char *name;  // "study", "program", ...
    const char *value; // what must be equal
    const char *words; // the message where it differs: "the study file has changed"
} StoreKey;

typedef struct StoreHead {
    const Layout *layout;
    uint64_t run_count; // of the whole study
    size_t key_count;
    StoreKey keys[STORE_KEY_MAX];
} StoreHead;

typedef struct Store Store;

// Opens the store of a study for writing; creates it where there is none, or anew where
// `is_fresh`. Fails with ERR_FILE where it cannot be read or written, is in use by another process,
// is not a store, is damaged, or belongs to another study or program: the message says what
// differs. Fails with ERR_CASE where two columns would have one name. Only a store or an empty file
// is ever created anew.
Store *store_open(const char *path, const StoreHead *head, bool is_fresh, Err *err);

// Opens a store for reading, also while another process writes to it.
Store *store_view(const char *path, Err *err);

// Commits what is not yet committed. Accepts NULL. Fails with ERR_FILE.
bool store_close(Store *store, Err *err);

// Whether a run is in the store, committed or not.
bool store_has(Store *store, uint64_t run, bool *has, Err *err);

// Adds a row, which store_commit commits; call that within a second or so of the first row. Fails
// with ERR_FILE where there is no space left: what was committed stays.
bool store_add(Store *store, const Record *record, Err *err);
bool store_commit(Store *store, Err *err);

// What is in a store.
typedef struct StoreCount {
    uint64_t run_count;                   // of the whole study
    uint64_t rows;                        // runs that are over
    uint64_t outcomes[RUN_OUTCOME_COUNT]; // of them
    double wall_s;                        // all their processes took
} StoreCount;

// Reads every row, and fails with ERR_FILE at one that does not match its checksum; so do
// store_reasons, store_values and store_spread when first called.
bool store_count(Store *store, StoreCount *count, Err *err);

// The columns of a store, and a value of its key; NULL where it has none of that name.
const Layout *store_layout(const Store *store);
const char *store_key(const Store *store, const char *name);

// The number of a column by name, settings first; the number of all columns where there is none.
size_t store_column(const Layout *layout, const char *name);
const Column *store_column_at(const Layout *layout, size_t column);

// Why runs ended other than with RUN_OUTCOME_OK: the most frequent reasons first.
typedef struct StoreReason {
    RunOutcome outcome;
    char reason[RECORD_REASON_SIZE];
    uint64_t count;
    uint64_t example; // the first run of them
} StoreReason;

bool store_reasons(Store *store, size_t most, StoreReason *reasons, size_t *count, Err *err);

// The distinct values of a column in ascending order, at most `most`; `count` is their number, or
// `most` + 1 where there are more.
bool store_values(Store *store, size_t column, size_t most, Cell *values, size_t *count, Err *err);

// The distribution of a column of numbers over the successful runs that have a number there, with
// quantiles as of sorted_quantile.
typedef struct StoreSpread {
    uint64_t count;
    double least; // NAN where there is none, as are the others
    double low;   // 5 %
    double median;
    double high; // 95 %
    double most;
} StoreSpread;

// Whether two columns are the same numbers to people, to three digits.
bool store_spreads_alike(const StoreSpread *a, const StoreSpread *b);

bool store_spread(Store *store, size_t column, StoreSpread *spread, Err *err);

// The same of so many columns in a row, in fewer passes through the store.
bool store_spreads(Store *store, size_t column, size_t count, StoreSpread *spreads, Err *err);

// Deletes the rows of failed runs and damaged rows, so that the runs are made again, and in a study
// with a truth those of runs without one. `forgotten` is their number.
bool store_forget_failed(Store *store, uint64_t *forgotten, Err *err);

// Passes the rows to a function by rising number of run. One that fails ends it with its error;
// however long it takes, it does not block a process that writes to the store. Fails with ERR_FILE
// at a row that does not match its checksum.
typedef bool (*StoreTaker)(const Layout *layout, const Record *record, void *context, Err *err);
bool store_each(Store *store, StoreTaker take, void *context, Err *err);

// Merges shards of one study into one store, new or existing. Runs that it has already stay as they
// are; a run with different results in two of them is an error, as is a source that belongs to
// another study or is in use. A run that was cut off in one of them (ended, timed out, no memory)
// is taken from another that has its result. All or nothing. Memory does not grow with the number
// of runs. `added` is the number of rows that are new to the target.
bool store_merge(const char *target, const char *const *sources, size_t source_count,
                 uint64_t *added, Err *err);
