// How far a comparison has come: a line on standard error, as of a long run, gone at its end.
#pragma once

#include "cli/status_line.h"
#include "measure/ladder.h"

typedef struct CompareProgress {
    const Ladder *ladder;
    size_t jobs; // error runs at a time
    bool is_announced;
    StatusLine line;
} CompareProgress;

CompareProgress compare_progress_start(const Ladder *ladder, size_t jobs, bool is_quiet);

// Says what is being done, if it is time for a line. Once the pace of every scheme is known, by its
// coarsest step, long work (long_work.h) is announced, with what would take less.
void compare_progress_show(CompareProgress *progress, const char *doing);

// Takes the line away again.
void compare_progress_end(CompareProgress *progress);
