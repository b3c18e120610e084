// How far has a study come, and how long will the rest take?
#include "cli/study_progress.h"

#include "base/text.h"

#include <inttypes.h>

static void append_left(Text *words, double left_s)
{
    const double minute = 60.0;
    const double hour = 3600.0;
    // two digits, as many as a guess has
    if (left_s < 2.0 * minute) {
        text_append(words, ", some %.0f s left", left_s);
    } else if (left_s < 2.0 * hour) {
        text_append(words, ", some %.0f min left", left_s / minute);
    } else {
        text_append(words, ", some %.1f h left", left_s / hour);
    }
}

void study_progress_show(StatusLine *line, const SweepState *state)
{
    if (!status_line_is_due(line, state->wall_s)) {
        return;
    }
    Text words;
    text_init(&words);
    text_append(&words, "%" PRIu64 " of %" PRIu64 " runs", state->done, state->total);
    if (state->failed > 0) {
        text_append(&words, ", %" PRIu64 " failed", state->failed);
    }
    if (state->made > 0) {
        const double rate = (double)state->made / state->wall_s;
        text_append(&words, ", %.3g runs/s", rate);
        append_left(&words, (double)(state->total - state->done) / rate);
    }
    status_line_show(line, words.data);
    text_finish(&words);
}
