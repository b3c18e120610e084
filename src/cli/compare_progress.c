// How far has a comparison come, and how long will the rest take?
#include "cli/compare_progress.h"

#include "cli/output.h"

#include <stdio.h>
#include <time.h>

static const double FIRST_LINE = 2.0;     // s: who waits shorter than that needs no line
static const double TERMINAL_PAUSE = 0.2; // s, between two lines on a terminal
static const double LOG_PAUSE = 10.0;     // s, between two lines of a log

static double now_s(void)
{
    struct timespec time;
    clock_gettime(CLOCK_MONOTONIC, &time);
    return (double)time.tv_sec + 1e-9 * (double)time.tv_nsec;
}

CompareProgress compare_progress_start(const Ladder *ladder, bool is_quiet)
{
    return (CompareProgress){
        .ladder = ladder,
        .is_quiet = is_quiet,
        .is_terminal = output_is_terminal(stderr),
        .started_s = now_s(),
    };
}

void compare_progress_show(CompareProgress *progress, const char *doing)
{
    const double wall_s = now_s() - progress->started_s;
    const double pause = progress->is_terminal ? TERMINAL_PAUSE : LOG_PAUSE;
    if (progress->is_quiet || wall_s < FIRST_LINE || wall_s - progress->last_line_s < pause) {
        return;
    }
    progress->last_line_s = wall_s;
    progress->is_shown = progress->is_terminal;
    fprintf(stderr, "%s%s: %zu of %zu runs, %.0f s", progress->is_terminal ? "\r" : "", doing,
            ladder_run_done(progress->ladder), ladder_run_total(progress->ladder), wall_s);
    const double left_s = ladder_time_left(progress->ladder);
    if (left_s > 0.0) {
        fprintf(stderr, ", some %.0f s left", left_s);
    }
    fputs(progress->is_terminal ? "\x1b[K" : "\n", stderr);
    fflush(stderr);
}

void compare_progress_end(CompareProgress *progress)
{
    if (progress->is_shown) {
        fputs("\r\x1b[K", stderr);
        fflush(stderr);
        progress->is_shown = false;
    }
}
