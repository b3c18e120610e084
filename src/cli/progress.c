// Shows how far a long run has come.
#include "cli/progress.h"

#include "cli/long_work.h"
#include "cli/output.h"

#include <math.h>
#include <stdio.h>

static const double WARN_AFTER = 5.0; // s: by then the pace of a run is known
static const double PACE_AFTER = 3.0; // s: by then it may be shown
// s: the longest wait without a message where no progress is shown
static const double WARN_QUIET = 15.0;
static const double WARN_ANYWAY = 30.0; // s: likewise, of runs each of which is over soon

// How long the run under way, or the trial of it, has gone on, s.
static double part_time(const Progress *progress)
{
    return progress->run_wall_s - progress->part_from_s;
}

// How long it will still go on at its pace, s; at a share of 0 that is unknown, and INFINITY.
static double part_left(const Progress *progress, double share)
{
    return share > 0.0 ? part_time(progress) * (1.0 - share) / share : INFINITY;
}

// Where no progress is shown, warns once of a run that takes long at its pace.
static void warn_of_run(Progress *progress, double share)
{
    const bool is_quiet = progress->line.is_quiet;
    const double wall_s = part_time(progress);
    if (progress->is_warned || wall_s < WARN_AFTER || !(share > 0.0) ||
        part_left(progress, share) < STATUS_LINE_SOON ||
        !(wall_s > long_work_limit(is_quiet) * share)) {
        return;
    }
    char what[LINKAGE_NAME_SIZE + sizeof progress->doing + 32];
    snprintf(what, sizeof what, "%s%s, at its present pace,", progress->backend, progress->doing);
    progress->is_warned = long_work_warn(what, wall_s / share, is_quiet);
}

// How long the work has gone on, by the reported times and by the clock between them.
static double all_time(const Progress *progress)
{
    return fmax(progress->before_s + progress->run_wall_s, status_line_time(&progress->line));
}

// Likewise of work that goes on for long in a run without a pace, or in many short ones: the one
// under way may be the last.
static void warn_of_all(Progress *progress, double share)
{
    const double all_s = all_time(progress);
    const bool may_end = part_left(progress, share) < STATUS_LINE_SOON;
    if (progress->line.is_quiet && !progress->is_warned && !progress->is_reported &&
        all_s > (may_end ? WARN_ANYWAY : WARN_QUIET)) {
        progress->is_reported = true;
        output_say("jointplay: warning: %s%s goes on for longer than %.0f s%s\n", progress->backend,
                   progress->doing, WARN_QUIET,
                   progress->before_s > 0.0 ? ", with the runs before it" : "");
    }
}

static void show(double share, double wall_s, void *context)
{
    Progress *progress = context;
    // a time that decreases is that of another run
    if (wall_s < progress->run_wall_s) {
        progress->before_s += progress->run_wall_s;
        progress->part_from_s = 0.0;
    } else if (share < progress->share) {
        // the pace is that of the trial that begins, not of all
        progress->part_from_s = progress->run_wall_s;
    }
    progress->share = share;
    progress->run_wall_s = wall_s;
    StatusLine *line = &progress->line;
    if (line->is_quiet || !line->is_terminal) {
        warn_of_run(progress, share);
        warn_of_all(progress, share);
    }
    if (!line->is_quiet && status_line_is_due(line, all_time(progress), INFINITY)) {
        Text words;
        text_init(&words);
        text_append(&words, line->is_terminal ? "%s%s: %.0f %%, %.1f s" : "%s%s: %.0f %%, %.0f s",
                    progress->backend, progress->doing, 100.0 * share, wall_s);
        if (part_time(progress) > PACE_AFTER) {
            status_line_append_left(&words, part_left(progress, share));
        }
        status_line_show(line, words.data);
        text_finish(&words);
    }
}

void progress_begin(Progress *progress, bool is_quiet)
{
    *progress = (Progress){.backend = "", .line = status_line_start(is_quiet)};
}

RunWatch progress_watch(Progress *progress, const char *backend)
{
    progress->backend = backend;
    progress->doing[0] = '\0';
    progress->is_reported = progress->is_reported || progress->is_warned;
    progress->is_warned = false;
    progress->before_s += progress->run_wall_s;
    progress->run_wall_s = 0.0;
    progress->part_from_s = 0.0;
    progress->share = 0.0;
    return (RunWatch){.progress = show, .context = progress};
}

static void begin_trial(size_t trial, double step_s, void *context)
{
    Progress *progress = context;
    progress->share = 1.0; // whatever comes next begins anew
    if (trial == 0) {
        snprintf(progress->doing, sizeof progress->doing, ", the reference first");
    } else {
        snprintf(progress->doing, sizeof progress->doing, ", trial %zu, step %.3g us", trial,
                 1e6 * step_s);
    }
}

ChosenWatch progress_watch_trials(Progress *progress, const char *backend)
{
    return (ChosenWatch){.run = progress_watch(progress, backend), .begin = begin_trial};
}

void progress_end(Progress *progress)
{
    status_line_end(&progress->line);
}
