// A line on standard error that says how far a long run has come, and is gone at its end.
#pragma once

#include "run/run.h"

typedef struct Progress {
    const char *backend; // of the run that is watched
    bool is_quiet;
    bool is_terminal;
    bool is_shown;      // whether a line stands on the terminal
    double last_line_s; // wall time of the last line, s
} Progress;

// Watches one run. The progress must outlive the run.
RunWatch progress_watch(Progress *progress, const char *backend, bool is_quiet);

// Takes the line away again.
void progress_end(Progress *progress);
