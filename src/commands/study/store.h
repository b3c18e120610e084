// The store of a study: one SQLite file with a row for each run that is over.
//
// Tables: `study` (name, value: what makes rows of one store comparable), `run` (a row a run, its
// settings and results as columns, and their checksum) and `effort` (what is never twice the same:
// the wall time of each run, and its checksum). A row is only ever written whole, and never twice.
// Whoever looks at a store that is at work sees what has been committed. No store may be used or
// closed in a process forked off the one that opened it.
#pragma once

#include "base/err.h"
#include "commands/study/record.h"

#include <stdbool.h>

enum { STORE_KEY_SIZE = 64, STORE_KEY_MAX = 16 };

// What must be equal for the rows of a store to be those of a study, and what differs when it is
// not: study, case and program.
typedef struct StoreKey {
    const char *name;  // "study", "program", ...
    const char *value; // what must be equal
    const char *words; // what to say where it differs: "the study file has changed"
} StoreKey;

typedef struct StoreHead {
    const Layout *layout;
    uint64_t run_count; // of the whole study
    size_t key_count;
    StoreKey keys[STORE_KEY_MAX];
} StoreHead;

typedef struct Store Store;

// Opens the store of a study for writing, or makes it where there is none, or anew where
// `is_fresh`. Fails with ERR_FILE where it cannot be read or written, is at work in another
// process, is no store of a study, is damaged, or belongs to another study or program: it then
// says what differs. Fails with ERR_CASE where two columns would have one name. Only a store of a
// study, or an empty file, is ever made anew.
Store *store_open(const char *path, const StoreHead *head, bool is_fresh, Err *err);

// Opens a store to look at it, also while it is at work in another process.
Store *store_view(const char *path, Err *err);

// Commits what is not yet committed. Accepts NULL. False, with ERR_FILE, where that fails.
bool store_close(Store *store, Err *err);

// Whether a run is in the store, committed or not.
bool store_has(Store *store, uint64_t run, bool *has, Err *err);

// Adds a row, to be committed by store_commit; within a second or so of the first row added that
// should be done. Fails with ERR_FILE where there is no space left: what was committed stays.
bool store_add(Store *store, const Record *record, Err *err);
bool store_commit(Store *store, Err *err);

// What is in a store.
typedef struct StoreCount {
    uint64_t run_count;         // of the whole study
    uint64_t rows;              // runs that are over
    uint64_t fates[FATE_COUNT]; // of them
    double wall_s;              // all their processes took
} StoreCount;

// Reads every row, and fails with ERR_FILE at one that is not what was once written; so do
// store_reasons, store_values and store_spread when first called.
bool store_count(Store *store, StoreCount *count, Err *err);

// The columns of a store, and a value of its key; NULL where it has none of that name.
const Layout *store_layout(const Store *store);
const char *store_key(const Store *store, const char *name);

// The number of a column by name, settings first; the number of all columns where there is none.
size_t store_column(const Layout *layout, const char *name);
const Column *store_column_at(const Layout *layout, size_t column);

// Why runs came to an end other than FATE_OK: the most frequent reasons first.
typedef struct StoreReason {
    Fate fate;
    char reason[RECORD_REASON_SIZE];
    uint64_t count;
    uint64_t example; // the first run of them
} StoreReason;

bool store_reasons(Store *store, size_t most, StoreReason *reasons, size_t *count, Err *err);

// The values of a column that occur, in ascending order, at most so many; `count` is that of the
// list, and one more than `most` where there are more.
bool store_values(Store *store, size_t column, size_t most, Cell *values, size_t *count, Err *err);

// The distribution of a column of numbers over the runs that went well and have a number there.
// Each is a value that occurs: that at rank ceil(share * count).
typedef struct StoreSpread {
    uint64_t count;
    double least; // NAN where there is none, as all that follow
    double low;   // 5 %
    double median;
    double high; // 95 %
    double most;
} StoreSpread;

bool store_spread(Store *store, size_t column, StoreSpread *spread, Err *err);

// Forgets the rows of failed runs and those that are damaged, so that they are made again, and in a
// study with a truth those of runs that have missed theirs. `forgotten` is their number.
bool store_forget_failed(Store *store, uint64_t *forgotten, Err *err);

// Hands over the rows by rising number of run. A taker that fails ends it with its error; however
// long it takes, it holds up no process that works on the store. Fails with ERR_FILE at a row that
// is not what was once written.
typedef bool (*StoreTaker)(const Layout *layout, const Record *record, void *context, Err *err);
bool store_each(Store *store, StoreTaker take, void *context, Err *err);

// Merges shards of one study into one store, made new or added to; runs that are there already are
// left alone, a run that two of them hold with different results is an error, as is a source that
// is of another study or at work in another process. A run that was cut off in one of them (ended,
// timed out, no memory) is taken from another that has its result. All or nothing. Memory does not
// grow with the number of runs. `added` is the number of rows that are new to the target.
bool store_merge(const char *target, const char *const *sources, size_t source_count,
                 uint64_t *added, Err *err);
