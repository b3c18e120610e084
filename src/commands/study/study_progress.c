// How far has a study come, and how long will the rest take?
#include "commands/study/study_progress.h"

#include "base/text.h"

#include <inttypes.h>

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
        status_line_append_left(&words, (double)(state->total - state->done) / rate);
    }
    status_line_show(line, words.data);
    text_finish(&words);
}
