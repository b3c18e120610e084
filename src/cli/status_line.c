// Shows a line of progress when one is due.
#include "cli/status_line.h"

#include "base/clock.h"
#include "base/printable.h"
#include "cli/output.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

const double STATUS_LINE_SOON = 5.0; // s

static const double FIRST_LINE = 2.0;     // s: no line before that
static const double TERMINAL_PAUSE = 0.2; // s, between two lines on a terminal
static const double LOG_PAUSE = 10.0;     // s, between two lines of a log
static const double QUIET_LINE = 15.0;    // s: one warning of long work where quiet

StatusLine status_line_start(bool is_quiet)
{
    return (StatusLine){.is_quiet = is_quiet,
                        .is_terminal = output_is_terminal(stderr),
                        .started_s = clock_now_s()};
}

double status_line_time(const StatusLine *line)
{
    return clock_now_s() - line->started_s;
}

bool status_line_is_due(StatusLine *line, double wall_s, double left_s)
{
    const double pause = line->is_terminal ? TERMINAL_PAUSE : LOG_PAUSE;
    if (line->is_quiet) {
        const bool is_due = wall_s >= QUIET_LINE && left_s >= STATUS_LINE_SOON && !line->is_warned;
        line->is_warned = line->is_warned || is_due;
        return is_due;
    }
    if (wall_s < FIRST_LINE || wall_s - line->last_line_s < pause) {
        return false;
    }
    line->last_line_s = wall_s;
    return true;
}

void status_line_append_time(Text *words, double time_s)
{
    const double minute = 60.0;
    const double hour = 3600.0;
    // two digits: it is an estimate
    if (time_s < 2.0 * minute) {
        text_append(words, "%.0f s", ceil(time_s));
    } else if (time_s < 2.0 * hour) {
        text_append(words, "%.0f min", time_s / minute);
    } else {
        text_append(words, "%.1f h", time_s / hour);
    }
}

void status_line_append_left(Text *words, double left_s)
{
    if (left_s >= 0.5 && isfinite(left_s)) {
        text_append(words, ", some ");
        status_line_append_time(words, left_s);
        text_append(words, " left");
    }
}

void status_line_show(StatusLine *line, const char *words)
{
    if (line->is_quiet) {
        output_say("jointplay: warning: long work: %s\n", words);
        return;
    }
    char *shown = printable_copy(words, false);
    fprintf(stderr, line->is_terminal ? "\r%s\x1b[K" : "%s\n", shown);
    free(shown);
    fflush(stderr);
    line->is_shown = line->is_terminal;
}

void status_line_end(StatusLine *line)
{
    if (line->is_shown) {
        fputs("\r\x1b[K", stderr);
        fflush(stderr);
        line->is_shown = false;
    }
}
