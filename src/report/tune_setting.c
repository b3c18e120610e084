// How is a setting given on?
#include "report/tune_setting.h"

#include "casefile/input.h"
#include "report/number.h"
#include "report/units.h"

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

// A word as a shell takes it: bare where nothing in it means anything to it.
static void append_quoted(const char *word, Text *text)
{
    static const char PLAIN[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789"
                                "./_-=+,:%@";
    if (word[0] != '\0' && strspn(word, PLAIN) == strlen(word)) {
        text_append(text, "%s", word);
        return;
    }
    text_append(text, "'");
    for (; *word != '\0'; word++) {
        text_append(text, *word == '\'' ? "'\\''" : "%c", *word);
    }
    text_append(text, "'");
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

void tune_setting_command(const TuneReport *report, const TuneTrial *trial, Text *text)
{
    text_append(text, "jointplay run ");
    const char *path = report->scenario->path;
    append_quoted(strcmp(path, INPUT_STDIN) == 0 ? "-" : path, text);
    for (size_t i = 0; i < report->override_count; i++) {
        if (!tune_setting_replaces(report->overrides[i])) {
            text_append(text, " --set ");
            append_quoted(report->overrides[i], text);
        }
    }
    // the reference goes along, for the error is against it
    const bool is_ideal = !scenario_has_clearance(report->scenario);
    text_append(text, " --set run.backends=%s --set '",
                is_ideal && report->scenario->has_fourbar ? "'[analytic, reference, ode]'"
                                                          : "'[reference, ode]'");
    tune_setting_keys(report, trial, "' --set '", text);
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
