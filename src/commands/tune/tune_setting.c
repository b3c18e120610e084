// How is a setting written down?
#include "commands/tune/tune_setting.h"

#include "base/shell.h"
#include "casefile/input.h"
#include "write/number.h"
#include "write/units.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

// The collider, where it is another than the case's.
static void write_collider(const TuneReport *report, const Scheme *scheme, const char *separator,
                           Text *text)
{
    if (scheme->collider != report->scenario->ode.collider) {
        text_append(text, "%sode.collider=%s", separator, OPTIONS_ODE_COLLIDERS[scheme->collider]);
    }
}

void tune_setting_keys(const TuneReport *report, const TuneTrial *trial, const char *separator,
                       Text *text)
{
    const Scheme *scheme = &report->tune->schemes[trial->scheme].scheme;
    if (!scheme_has_step(scheme)) {
        text_append(text, "run.step=auto%srun.tolerance=", separator);
        text_append(text, "%s", number_shortest(trial->value).text);
        write_collider(report, scheme, separator, text);
        return;
    }
    text_append(text, "run.step=");
    text_append(text, "%s", number_shortest(trial->value).text);
    text_append(text, " s%sode.solver=%s%sode.stepping=%s", separator,
                OPTIONS_ODE_SOLVERS[scheme->solver], separator,
                OPTIONS_ODE_STEPPINGS[scheme->stepping]);
    if (scenario_has_clearance(report->scenario)) {
        text_append(text, "%sode.map=%s", separator, OPTIONS_ODE_MAPS[scheme->map]);
    }
    write_collider(report, scheme, separator, text);
}

bool tune_setting_replaces(const char *override)
{
    static const char *const KEYS[] = {"run.step",   "run.tolerance", "run.backends",
                                       "ode.solver", "ode.stepping",  "ode.map"};
    const size_t length = strcspn(override, "=");
    for (size_t i = 0; i < sizeof KEYS / sizeof KEYS[0]; i++) {
        if (strlen(KEYS[i]) == length && strncmp(KEYS[i], override, length) == 0) {
            return true;
        }
    }
    return false;
}

void tune_setting_command(const TuneReport *report, const TuneTrial *trial, const char *separator,
                          Text *text)
{
    text_append(text, "jointplay run ");
    const char *path = scenario_path(report->scenario);
    shell_append_path(text, strcmp(path, INPUT_STDIN) == 0 ? "-" : path);
    for (size_t i = 0; i < report->override_count; i++) {
        if (!tune_setting_replaces(report->overrides[i])) {
            text_append(text, "%s--set ", separator);
            shell_append_word(text, report->overrides[i]);
        }
    }
    // with the reference, which the error is against
    const bool is_ideal = !scenario_has_clearance(report->scenario);
    text_append(text, "%s--set run.backends=%s", separator,
                is_ideal && scenario_has_closed_form(report->scenario)
                    ? "'[analytic, reference, ode]'"
                    : "'[reference, ode]'");
    // the program's own words, which hold no quote
    char between[TUNE_SEPARATOR_SIZE + 16];
    snprintf(between, sizeof between, "'%s--set '", separator);
    text_append(text, "%s--set '", separator);
    tune_setting_keys(report, trial, between, text);
    text_append(text, "'");
}

void tune_setting_words(const TuneReport *report, const TuneTrial *trial, Text *text)
{
    const Scheme *scheme = &report->tune->schemes[trial->scheme].scheme;
    if (scheme_has_step(scheme)) {
        text_append(text, "%s, step %.4g us", scheme->name, trial->value * UNITS_US);
    } else {
        text_append(text, "%s, step chosen for a tolerance of %.3g", scheme->name, trial->value);
    }
}

static bool is_timed(const Tune *tune, const TuneTrial *trial)
{
    return trial == tune_best(tune, (int)trial->scheme) &&
           isfinite(tune->schemes[trial->scheme].processor_median_s);
}

double tune_setting_time(const Tune *tune, const TuneTrial *trial)
{
    return is_timed(tune, trial) ? tune->schemes[trial->scheme].processor_median_s
                                 : trial->run.processor_s;
}

static void write_cost(const Tune *tune, const TuneTrial *trial, Text *text)
{
    const TuneScheme *scheme = &tune->schemes[trial->scheme];
    text_append(text, "%zu world steps, %.4g ms of the processor", trial->run.steps,
                tune_setting_time(tune, trial) * UNITS_MS);
    if (is_timed(tune, trial)) {
        text_append(text, ", %.4g ms by the clock (medians of %zu runs taken in turn)",
                    scheme->wall_median_s * UNITS_MS, scheme->timed);
    } else {
        text_append(text, " (one run)");
    }
}

void tune_setting_write(const TuneReport *report, const TuneTrial *trial, Text *text)
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
