// The runs of a check, each start in a child process.
#pragma once

#include "cli/status_line.h"
#include "commands/check/check_measure.h"

// One start of one case, and what came of it.
typedef struct CheckWork {
    const Scenario *scenario; // from its own start
    CheckPlan plan;
    CheckStart start;
    CheckMeasure *measure; // owned by the caller
    bool is_over;          // measured, or failed; what is over at the beginning is not done again
    double wall_s;         // that its process took
} CheckWork;

typedef struct CheckWorkState {
    size_t done;
    size_t total;
    double left_s; // estimate of the time that the rest takes; 0 where there is none yet
} CheckWorkState;

typedef struct CheckWorkers {
    size_t jobs;         // at a time
    double time_limit_s; // of one work
    // a few times a second; false: stop
    bool (*wait)(const CheckWorkState *state, void *context);
    // as soon as a work is measured; may be NULL
    bool (*keep)(const CheckWork *work, void *context, Err *err);
    void *context;
} CheckWorkers;

// Does all of it, the own start of each case first. A process that dies or hangs leaves a measure
// that is not complete and says so. Where it was stopped, works are left that are not over. Fails
// with ERR_SOLVER where the system has no process left, or as `keep` does.
bool check_work_do(const CheckWorkers *workers, CheckWork *works, size_t count, Err *err);

// How far a check has come: a line on standard error, gone at its end.

typedef struct CheckProgress {
    const char *doing;  // lives as long as this
    size_t case_number; // of the one at work, from 1; 0: all at once
    size_t case_count;
    StatusLine line;
} CheckProgress;

CheckProgress check_progress_start(const char *doing, bool is_quiet);

// Says how much is done and how long the rest will take, if it is time for a line. Without a
// total it says that the reference is computed.
void check_progress_show(CheckProgress *progress, const CheckWorkState *state);

void check_progress_end(CheckProgress *progress);
