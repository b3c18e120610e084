// How far a comparison has come: a line on standard error, as of a long run, gone at its end.
#pragma once

#include "cli/status_line.h"
#include "measure/ladder.h"

typedef struct CompareProgress {
    const Ladder *ladder;
    StatusLine line;
} CompareProgress;

CompareProgress compare_progress_start(const Ladder *ladder, bool is_quiet);

// Says what is being done, if it is time for a line.
void compare_progress_show(CompareProgress *progress, const char *doing);

// Takes the line away again.
void compare_progress_end(CompareProgress *progress);
