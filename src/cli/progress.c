// How far has a long run come?
#include "cli/progress.h"

#include "base/clock.h"
#include "cli/long_work.h"
#include "cli/output.h"

#include <math.h>
#include <stdio.h>

static const double WARN_AFTER = 5.0;  // s: by then a run has shown its pace
static const double WARN_QUIET = 15.0; // s: who sees no progress waits no longer without a word

// Who sees no line of progress is told once of a run that goes on for long: of this one at its
// pace, or of one that has had several parts, each of them short.
static void warn_once(Progress *progress, double share, double wall_s)
{
    const bool is_quiet = progress->line.is_quiet;
    const bool has_line = !is_quiet && progress->line.is_terminal;
    const double limit_s = long_work_limit(is_quiet);
    const double in_all_s = clock_now_s() - progress->started_s;
    if (has_line || progress->is_warned || fmax(wall_s, in_all_s) < WARN_AFTER) {
        return;
    }
    if (wall_s > limit_s * share) {
        char what[LINKAGE_NAME_SIZE + 32];
        snprintf(what, sizeof what, "%s, at its present pace,", progress->backend);
        // a share of 0 is no pace yet
        progress->is_warned = share > 0.0 && long_work_warn(what, wall_s / share, is_quiet);
    }
    // a log has lines of a run that is long itself, none of many short ones
    const bool has_lines = !is_quiet && wall_s >= WARN_QUIET;
    if (!progress->is_warned && !has_lines && fmax(wall_s, in_all_s) > WARN_QUIET) {
        progress->is_warned = true;
        output_say("jointplay: warning: %s%s goes on for longer than %.0f s\n", progress->backend,
                   progress->doing, WARN_QUIET);
    }
}

static void show(double share, double wall_s, void *context)
{
    Progress *progress = context;
    warn_once(progress, share, wall_s);
    if (!progress->line.is_quiet && status_line_is_due(&progress->line, wall_s)) {
        char words[LINKAGE_NAME_SIZE + sizeof progress->doing + 64];
        snprintf(words, sizeof words,
                 progress->line.is_terminal ? "%s%s: %.0f %%, %.1f s" : "%s%s: %.0f %%, %.0f s",
                 progress->backend, progress->doing, 100.0 * share, wall_s);
        status_line_show(&progress->line, words);
    }
}

RunWatch progress_watch(Progress *progress, const char *backend, bool is_quiet)
{
    *progress = (Progress){
        .backend = backend, .line = status_line_start(is_quiet), .started_s = clock_now_s()};
    return (RunWatch){.progress = show, .context = progress};
}

static void begin_trial(size_t trial, double step_s, void *context)
{
    Progress *progress = context;
    if (trial == 0) {
        snprintf(progress->doing, sizeof progress->doing, ", the reference first");
    } else {
        snprintf(progress->doing, sizeof progress->doing, ", trial %zu, step %.3g us", trial,
                 1e6 * step_s);
    }
}

ChosenWatch progress_watch_trials(Progress *progress, const char *backend, bool is_quiet)
{
    return (ChosenWatch){progress_watch(progress, backend, is_quiet), begin_trial};
}

void progress_end(Progress *progress)
{
    status_line_end(&progress->line);
}
