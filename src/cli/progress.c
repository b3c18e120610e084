// How far has a long run come?
#include "cli/progress.h"

#include <stdio.h>

static void show(double share, double wall_s, void *context)
{
    Progress *progress = context;
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
    return (RunWatch){.progress = is_quiet ? NULL : show, .context = progress};
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
