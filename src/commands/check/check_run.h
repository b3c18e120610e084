// Runs the cases of a check, or of new baselines, and judges them.
#pragma once

#include "commands/check/check_list.h"
#include "commands/check/check_report.h"
#include "commands/check/check_work.h"

typedef struct CheckRun {
    CheckReport report;
    CheckCase *cases; // owned, as the rows in them
} CheckRun;

// Runs all items and judges them. A run that fails is an error of its case. Fails with ERR_SOLVER
// where the system has no process left.
bool check_run_execute(const CheckOptions *options, CheckItem *items, size_t count, CheckRun *run,
                       Err *err);

// Measures each item and writes its baseline; the rows tell what moved against the old one. An item
// of which a run fails keeps its old baseline and is an error of its case.
void check_run_bless(const CheckOptions *options, CheckItem *items, size_t count, CheckRun *run);

void check_run_finish(CheckRun *run);

// Makes the runs whose outcome a case expects.

typedef struct OutcomeWork {
    const CheckItem *item;
    size_t jobs;         // runs at a time
    double time_limit_s; // of one run
    CheckProgress *progress;
} OutcomeWork;
