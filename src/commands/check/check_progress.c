// How far has a check come, and how long will the rest take?
#include "commands/check/check_progress.h"

#include "base/text.h"

#include <math.h>

CheckProgress check_progress_start(const char *doing, bool is_quiet)
{
    return (CheckProgress){.doing = doing, .line = status_line_start(is_quiet)};
}

void check_progress_show(CheckProgress *progress, const CheckWorkState *state)
{
    const double wall_s = status_line_time(&progress->line);
    // what is left is that of this case alone
    const bool is_last = progress->case_number >= progress->case_count;
    const double left_s = is_last && state->left_s > 0.0 ? state->left_s : INFINITY;
    if (!status_line_is_due(&progress->line, wall_s, left_s)) {
        return;
    }
    Text words;
    text_init(&words);
    if (progress->case_count > 1) {
        text_append(&words, "case %zu of %zu, ", progress->case_number, progress->case_count);
    }
    text_append(&words, "%s: ", progress->doing);
    if (state->total == 0) {
        text_append(&words, "making and certifying the reference");
    } else {
        text_append(&words, "%zu of %zu starts", state->done, state->total);
    }
    text_append(&words, ", %.0f s", wall_s);
    status_line_append_left(&words, state->left_s);
    status_line_show(&progress->line, words.data);
    text_finish(&words);
}

void check_progress_end(CheckProgress *progress)
{
    status_line_end(&progress->line);
}
