// How far has a comparison come, and how long will the rest take?
#include "commands/compare/compare_progress.h"

#include "base/text.h"
#include "cli/long_work.h"
#include "cli/output.h"

#include <math.h>

static const double US = 1e6; // us in a second

CompareProgress compare_progress_start(const Ladder *ladder, size_t jobs, bool is_quiet)
{
    return (CompareProgress){.ladder = ladder, .jobs = jobs, .line = status_line_start(is_quiet)};
}

// How many of the steps, from the coarsest on, take no longer than what is not announced.
static size_t count_quick_steps(const CompareProgress *progress, double limit_s)
{
    size_t count = 0;
    while (count < progress->ladder->step_count &&
           ladder_time_of_steps(progress->ladder, count + 1, progress->jobs) <= limit_s) {
        count++;
    }
    return count;
}

static void append_way_out(const CompareProgress *progress, double limit_s, Text *words)
{
    const Ladder *ladder = progress->ladder;
    const size_t count = count_quick_steps(progress, limit_s);
    if (count == 0) {
        text_append(words, "; fewer --schemes or longer --steps take less");
        return;
    }
    text_append(words, "; --steps '");
    for (size_t i = 0; i < count; i++) {
        text_append(words, "%s%.4g us", i > 0 ? ", " : "", US * ladder->steps[i]);
    }
    char time[LONG_WORK_TIME_SIZE];
    long_work_time(ladder_time_of_steps(ladder, count, progress->jobs), time);
    text_append(words, "' %s about %s, fewer --schemes less as well", count > 1 ? "take" : "takes",
                time);
}

static void announce(CompareProgress *progress, double left_s)
{
    const Ladder *ladder = progress->ladder;
    const double limit_s = long_work_limit(progress->line.is_quiet);
    if (progress->is_announced || !ladder_has_pace(ladder)) {
        return;
    }
    progress->is_announced = true;
    if (left_s <= limit_s) {
        return;
    }
    char time[LONG_WORK_TIME_SIZE];
    long_work_time(left_s, time);
    Text words;
    text_init(&words);
    text_append(&words, "the %zu runs left take about %s",
                ladder_run_total(ladder) - ladder_run_done(ladder), time);
    append_way_out(progress, limit_s, &words);
    status_line_end(&progress->line);
    output_say("jointplay: warning: %s\n", words.data);
    progress->line.is_warned = true;
    text_finish(&words);
}

void compare_progress_show(CompareProgress *progress, const char *doing)
{
    const double wall_s = status_line_time(&progress->line);
    const double left_s = ladder_time_left(progress->ladder, progress->jobs);
    announce(progress, left_s);
    if (!status_line_is_due(&progress->line, wall_s, left_s > 0.0 ? left_s : INFINITY)) {
        return;
    }
    Text words;
    text_init(&words);
    text_append(&words, "%s: %zu of %zu runs, %.0f s", doing, ladder_run_done(progress->ladder),
                ladder_run_total(progress->ladder), wall_s);
    status_line_append_left(&words, left_s);
    status_line_show(&progress->line, words.data);
    text_finish(&words);
}

void compare_progress_end(CompareProgress *progress)
{
    status_line_end(&progress->line);
}
