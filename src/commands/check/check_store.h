// Where a baseline in the making keeps the starts that are measured, so that one that was stopped
// at any moment goes on where it stood: <baseline>.partial, beside the baseline, until that is
// written.
#pragma once

#include "commands/check/check_list.h"
#include "commands/check/check_work.h"
#include "write/journal.h"

typedef struct CheckStore {
    Journal journal;
} CheckStore;

// Opens the file of an item, or makes it. One that is of another state of the case or the program,
// or has a damaged first line, is begun anew. ERR_FILE.
bool check_store_open(CheckStore *store, const CheckItem *item, Err *err);

// The plan, if it was kept; and keeping it. The reason is empty where the plan has a truth.
bool check_store_take_plan(const CheckStore *store, CheckPlan *plan, char *no_truth, size_t size);
bool check_store_keep_plan(CheckStore *store, const CheckPlan *plan, const char *no_truth,
                           Err *err);

// Takes those of the works that were kept: they are then over.
void check_store_take(CheckStore *store, CheckWork *works, size_t count);
bool check_store_keep(CheckStore *store, const CheckWork *work, Err *err);

// The number of starts that the file holds now.
size_t check_store_count(const CheckStore *store);

// Closes the file, and removes it where it is not needed any more. Accepts a zeroed store.
void check_store_close(CheckStore *store, bool is_needed);
