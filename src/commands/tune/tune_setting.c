// How is a setting given on?
#include "commands/tune/tune_setting.h"

#include "base/shell.h"
#include "casefile/input.h"
#include "write/number.h"
#include "write/units.h"

#include <stdio.h>
#include <string.h>

void tune_setting_keys(const TuneReport *report, const TuneTrial *trial, const char *separator,
                       Text *text)
{
    const Scheme *scheme = &report->tune->schemes[trial->scheme].scheme;
    if (!scheme_has_step(scheme)) {
        text_append(text, "run.step=auto%srun.tolerance=", separator);
        text_append(text, "%s", number_shortest(trial->value).text);
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
    const char *path = report->scenario->path;
    shell_append_path(text, strcmp(path, INPUT_STDIN) == 0 ? "-" : path);
    for (size_t i = 0; i < report->override_count; i++) {
        if (!tune_setting_replaces(report->overrides[i])) {
            text_append(text, "%s--set ", separator);
            shell_append_word(text, report->overrides[i]);
        }
    }
    // the reference goes along, for the error is against it
    const bool is_ideal = !scenario_has_clearance(report->scenario);
    text_append(text, "%s--set run.backends=%s", separator,
                is_ideal && report->scenario->has_fourbar ? "'[analytic, reference, ode]'"
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
