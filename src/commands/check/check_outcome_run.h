// Makes the runs whose outcome a case expects.
#pragma once

#include "commands/check/check_list.h"
#include "commands/check/check_progress.h"

typedef struct OutcomeWork {
    const CheckItem *item;
    size_t jobs;         // runs at a time
    double time_limit_s; // of one run
    CheckProgress *progress;
} OutcomeWork;

// Makes and judges all runs that the item's case expects an outcome of, each in a child process:
// *outcomes is then theirs, owned by the caller, and *count how many there are; NULL and 0 where
// the case expects none. Fails with ERR_CASE where an outcome names a scheme that the case does not
// have, and with ERR_SOLVER where the system has no process left.
bool check_outcome_run(const OutcomeWork *work, CheckOutcome **outcomes, size_t *count, Err *err);
