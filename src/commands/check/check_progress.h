// How far a check has come: a line on standard error, gone at its end.
#pragma once

#include "cli/status_line.h"
#include "commands/check/check_work.h"

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
