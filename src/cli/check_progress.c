// How far has a check come?
#include "cli/check_progress.h"

#include "base/clock.h"

#include <stdio.h>

enum { LINE_SIZE = 512 };

CheckProgress check_progress_start(const char *doing, bool is_quiet)
{
    return (CheckProgress){
        .doing = doing, .line = status_line_start(is_quiet), .started_s = clock_now_s()};
}

void check_progress_show(size_t done, size_t total, void *context)
{
    CheckProgress *progress = context;
    const double wall_s = clock_now_s() - progress->started_s;
    if (!status_line_is_due(&progress->line, wall_s)) {
        return;
    }
    char words[LINE_SIZE];
    snprintf(words, sizeof words, "%.400s: %zu of %zu starts, %.0f s", progress->doing, done, total,
             wall_s);
    status_line_show(&progress->line, words);
}

void check_progress_end(CheckProgress *progress)
{
    status_line_end(&progress->line);
}
