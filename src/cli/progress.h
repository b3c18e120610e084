// A line on standard error that says how far a long run has come, and is gone at its end.
#pragma once

#include "cli/status_line.h"
#include "measure/chosen_run.h"

typedef struct Progress {
    const char *backend; // of the run that is watched
    char doing[64];      // which of its trials; empty where there are none
    StatusLine line;
    bool is_warned;    // that the run takes long
    bool is_reported;  // that the work as a whole takes long
    bool is_announced; // that a run of ODE will take long
    double before_s;   // wall time of the runs before this one
    double run_wall_s; // of this one so far
    // A run with a chosen step is made of trials, each with shares from 0 on.
    double share;       // of the trial under way
    double part_from_s; // of the run, where that trial began
} Progress;

// Starts to watch work that is made of one run after another. It must outlive them all.
void progress_begin(Progress *progress, bool is_quiet);

// Watches the runs that follow. Long work (long_work.h) is warned of once even where quiet, and in
// a log. Times of several runs add up.
RunWatch progress_watch(Progress *progress, const char *backend);

// Watches one run whose step may be chosen by trials.
ChosenWatch progress_watch_trials(Progress *progress, const char *backend);

// Takes the line away again, which the next run may bring back.
void progress_end(Progress *progress);
