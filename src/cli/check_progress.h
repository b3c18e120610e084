// How far a check has come: a line on standard error, gone at its end.
#pragma once

#include "cli/status_line.h"

#include <stddef.h>

typedef struct CheckProgress {
    const char *doing; // lives as long as this
    StatusLine line;
    double started_s; // by the clock
} CheckProgress;

CheckProgress check_progress_start(const char *doing, bool is_quiet);

// Says how much is done, if it is time for a line. The context is a CheckProgress.
void check_progress_show(size_t done, size_t total, void *context);

void check_progress_end(CheckProgress *progress);
