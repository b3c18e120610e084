// How far has a long run come?
#include "cli/progress.h"

#include "cli/output.h"

#include <stdio.h>

static const double FIRST_LINE = 2.0;     // s: who waits shorter than that needs no line
static const double TERMINAL_PAUSE = 0.2; // s, between two lines on a terminal
static const double LOG_PAUSE = 10.0;     // s, between two lines of a log

static void show(double share, double wall_s, void *context)
{
    Progress *progress = context;
    const double pause = progress->is_terminal ? TERMINAL_PAUSE : LOG_PAUSE;
    if (wall_s < FIRST_LINE || wall_s - progress->last_line_s < pause) {
        return;
    }
    progress->last_line_s = wall_s;
    if (progress->is_terminal) {
        fprintf(stderr, "\r%s: %.0f %%, %.1f s\x1b[K", progress->backend, 100.0 * share, wall_s);
        fflush(stderr);
        progress->is_shown = true;
    } else {
        fprintf(stderr, "%s: %.0f %%, %.0f s\n", progress->backend, 100.0 * share, wall_s);
    }
}

RunWatch progress_watch(Progress *progress, const char *backend, bool is_quiet)
{
    *progress = (Progress){
        .backend = backend,
        .is_quiet = is_quiet,
        .is_terminal = output_is_terminal(stderr),
    };
    return (RunWatch){.progress = is_quiet ? NULL : show, .context = progress};
}

void progress_end(Progress *progress)
{
    if (progress->is_shown) {
        fputs("\r\x1b[K", stderr);
        fflush(stderr);
        progress->is_shown = false;
    }
}
