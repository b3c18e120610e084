// How far has a comparison come, and how long will the rest take?
#include "commands/compare/compare_progress.h"

#include "base/text.h"

CompareProgress compare_progress_start(const Ladder *ladder, bool is_quiet)
{
    return (CompareProgress){.ladder = ladder, .line = status_line_start(is_quiet)};
}

void compare_progress_show(CompareProgress *progress, const char *doing)
{
    const double wall_s = status_line_time(&progress->line);
    if (!status_line_is_due(&progress->line, wall_s)) {
        return;
    }
    Text words;
    text_init(&words);
    text_append(&words, "%s: %zu of %zu runs, %.0f s", doing, ladder_run_done(progress->ladder),
                ladder_run_total(progress->ladder), wall_s);
    const double left_s = ladder_time_left(progress->ladder);
    if (left_s > 0.0) {
        text_append(&words, ", some %.0f s left", left_s);
    }
    status_line_show(&progress->line, words.data);
    text_finish(&words);
}

void compare_progress_end(CompareProgress *progress)
{
    status_line_end(&progress->line);
}
