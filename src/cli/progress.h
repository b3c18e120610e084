// A line on standard error that says how far a long run has come, and is gone at its end.
#pragma once

#include "cli/status_line.h"
#include "compare/chosen_run.h"

typedef struct Progress {
    const char *backend; // of the run that is watched
    char doing[64];      // which of its trials; empty where there are none
    StatusLine line;
    bool is_warned;   // of a run that takes long
    double started_s; // by the clock
} Progress;

// Watches one run, a quiet one too: that it takes long (long_work.h) is said once even then, and in
// a log. The progress must outlive the run.
RunWatch progress_watch(Progress *progress, const char *backend, bool is_quiet);

// Watches one run whose step may be chosen by trials.
ChosenWatch progress_watch_trials(Progress *progress, const char *backend, bool is_quiet);

// Takes the line away again.
void progress_end(Progress *progress);
