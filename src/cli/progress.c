// How far has a long run come?
#include "cli/progress.h"

#include "cli/long_work.h"

#include <stdio.h>

static const double WARN_AFTER = 5.0; // s: by then a run has shown its pace
static const double WARN_OF = 60.0;   // s, of the whole run

// Who sees no line of progress is told once of a run that goes on for long.
static void warn_once(Progress *progress, double share, double wall_s)
{
    const bool has_line = !progress->line.is_quiet && progress->line.is_terminal;
    if (has_line || progress->is_warned || wall_s < WARN_AFTER || !(wall_s > WARN_OF * share)) {
        return;
    }
    char words[32] = "more than a day";
    if (share > 0.0) {
        long_work_words(wall_s / share, words, sizeof words);
    }
    progress->is_warned = true;
    fprintf(stderr, "jointplay: warning: %s takes about %s at its present pace\n",
            progress->backend, words);
}

static void show(double share, double wall_s, void *context)
{
    Progress *progress = context;
    warn_once(progress, share, wall_s);
    if (status_line_is_due(&progress->line, wall_s)) {
        char words[LINKAGE_NAME_SIZE + sizeof progress->doing + 64];
        snprintf(words, sizeof words,
                 progress->line.is_terminal ? "%s%s: %.0f %%, %.1f s" : "%s%s: %.0f %%, %.0f s",
                 progress->backend, progress->doing, 100.0 * share, wall_s);
        status_line_show(&progress->line, words);
    }
}

RunWatch progress_watch(Progress *progress, const char *backend, bool is_quiet)
{
    *progress = (Progress){.backend = backend, .line = status_line_start(is_quiet)};
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
