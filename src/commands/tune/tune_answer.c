// How is one setting of a search put before people?
#include "commands/tune/tune_answer.h"

#include "commands/tune/tune_setting.h"
#include "write/units.h"

#include <math.h>
#include <string.h>

static bool is_timed(const Tune *tune, const TuneTrial *trial)
{
    return trial == tune_best(tune, (int)trial->scheme) &&
           isfinite(tune->schemes[trial->scheme].processor_median_s);
}

double tune_answer_time(const Tune *tune, const TuneTrial *trial)
{
    return is_timed(tune, trial) ? tune->schemes[trial->scheme].processor_median_s
                                 : trial->run.processor_s;
}

static void write_cost(const Tune *tune, const TuneTrial *trial, Text *text)
{
    const TuneScheme *scheme = &tune->schemes[trial->scheme];
    text_append(text, "%zu world steps, %.4g ms of the processor", trial->run.steps,
                tune_answer_time(tune, trial) * UNITS_MS);
    if (is_timed(tune, trial)) {
        text_append(text, ", %.4g ms by the clock (medians of %zu runs taken in turn)",
                    scheme->wall_median_s * UNITS_MS, scheme->timed);
    } else {
        text_append(text, " (one run)");
    }
}

void tune_answer_setting(const TuneReport *report, const TuneTrial *trial, Text *text)
{
    text_append(text, "  setting     ");
    tune_setting_words(report, trial, text);
    text_append(text, "\n  error       %.3g\n  cost        ", trial->error);
    write_cost(report->tune, trial, text);
    text_append(text, "\n  in a case   ");
    tune_setting_keys(report, trial, "\n              ", text);
    // lines of their own, a setting each: so far in that no line is broken, which may be in a name
    text_append(text, "\n  run it\n    ");
    tune_setting_command(report, trial, " \\\n      ", text);
    text_append(text, "\n");
}
