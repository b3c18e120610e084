// What is the cheapest setting, how is it used, and what was tried?
#include "commands/tune/tune_reference.h"
#include "commands/tune/tune_setting.h"

#include "commands/tune/tune_export.h"
#include "write/section.h"
#include "write/units.h"

#include <math.h>
#include <string.h>

static void write_asked(const Tune *tune, Text *text)
{
    if (tune->held_s > 0.0) {
        text_append(text, "  asked for   the least error at a step of %.4g us",
                    tune->held_s * UNITS_US);
        if (isfinite(tune->target)) {
            text_append(text, ", %.3g at most", tune->target);
        }
        text_append(text, "\n");
        return;
    }
    text_append(text, "  asked for   error at most %.3g", tune->target);
    if (tune->limit.steps > 0) {
        text_append(text, ", in at most %zu world steps", tune->limit.steps);
    } else if (tune->limit.time_s > 0.0) {
        text_append(text, ", in at most %.4g ms", tune->limit.time_s * UNITS_MS);
    }
    text_append(text, "; the least %s\n", tune->cost == TUNE_STEPS ? "world steps" : "time");
}

static void write_head(const TuneReport *report, const Style *style, Text *text)
{
    const Scenario *scenario = report->scenario;
    const Tune *tune = report->tune;
    section_title(scenario->title, scenario_path(scenario), style, text);
    write_asked(tune, text);
    text_append(text, "  truth       %s, to %.2g\n", tune->truth.backend, tune->truth.uncertainty);
    if (tune->truth.is_limited) {
        text_append(text,
                    "  horizon     %.4g ms of %.4g ms: errors are those up to it, costs those of "
                    "the whole run\n",
                    tune->truth.horizon_s * UNITS_MS, scenario_duration(scenario) * UNITS_MS);
    }
}

// What there is to say where nothing meets what was asked for.
static void write_unmet(const TuneReport *report, Text *text)
{
    const Tune *tune = report->tune;
    const TuneTrial *best = tune_best(tune, tune->winner);
    if (best == NULL) {
        text_append(text,
                    "  none: no setting that was tried has an error of %.3g or less; the "
                    "table below says why each scheme ended\n",
                    tune->target);
    } else {
        text_append(text, "  none within the cost. The cheapest that meets the error:\n");
        tune_setting_write(report, best, text);
    }
    if (tune->within == TUNE_NONE) {
        text_append(text, tune_report_has_limit(report)
                              ? "\n  Nothing at all runs within the cost.\n"
                              : "\n  No run has a meaningful error.\n");
        return;
    }
    text_append(text, "\n  The least error%s:\n",
                tune_report_has_limit(report) ? " within the cost" : " of all that was tried");
    tune_setting_write(report, &tune->trials[tune->within], text);
}

static void write_answer(const TuneReport *report, const Style *style, Text *text)
{
    text_append(text, "\n%sCheapest setting%s\n\n", style->heading, style->end);
    if (tune_report_is_met(report)) {
        tune_setting_write(report, tune_best(report->tune, report->tune->winner), text);
    } else {
        write_unmet(report, text);
    }
}

static const char *outcome_words(const Tune *tune, const TuneScheme *scheme)
{
    switch (scheme->outcome) {
    case TUNE_MEETS:
        return "meets it, and so does the next finer one";
    case TUNE_COSTLIER:
        if (tune->cost == TUNE_LENGTH) {
            return "shorter ones were not tried";
        }
        return scheme->trials > 0 ? "finer ones cost more than the best"
                                  : "costs more than the best";
    case TUNE_STALLED:
        return "ten times finer is hardly better";
    case TUNE_TOO_LONG:
        return "finer ones take longer than was allowed";
    default:
        return "";
    }
}

static void value_cell(Table *table, const TuneScheme *scheme, double value)
{
    if (scheme_has_step(&scheme->scheme)) {
        table_cell(table, "%.4g us", value * UNITS_US);
    } else {
        table_cell(table, "tol. %.3g", value);
    }
}

static void scheme_row(const TuneReport *report, int number, Table *table)
{
    const Tune *tune = report->tune;
    const TuneScheme *scheme = &tune->schemes[number];
    const TuneTrial *best = tune_best(tune, number);
    const TuneTrial *shown =
        best != NULL || scheme->least == TUNE_NONE ? best : &tune->trials[scheme->least];
    table_cell(table, "%s", scheme->scheme.name);
    table_cell(table, "%zu", scheme->trials);
    if (shown == NULL) {
        for (int i = 0; i < 4; i++) {
            table_cell(table, "-");
        }
    } else {
        value_cell(table, scheme, shown->value);
        table_cell(table, "%.2e", shown->error);
        table_cell(table, "%zu", shown->run.steps);
        table_cell(table, "%.4g", tune_setting_time(tune, shown) * UNITS_MS);
    }
    table_cell(table, "%s%s",
               number != tune->winner ? ""
               : tune->held_s > 0.0   ? "longest step; "
                                      : "cheapest; ",
               outcome_words(tune, scheme));
}

static void write_schemes(const TuneReport *report, const Style *style, Text *text)
{
    static const SectionHead HEADS[] = {
        {"scheme", "", TABLE_LEFT},
        {"runs", "", TABLE_RIGHT | TABLE_DETAIL},
        {"setting", "", TABLE_RIGHT},
        {"error", "1", TABLE_RIGHT},
        {"world steps", "", TABLE_RIGHT | TABLE_DETAIL},
        {"CPU", "ms", TABLE_RIGHT},
        {"how it ended", "", TABLE_WRAP},
    };
    const char *heading = report->tune->held_s > 0.0 ? "Schemes at shorter steps" : "Schemes";
    Table *table = section_begin(heading, 7, HEADS, style, text);
    for (int i = 0; i < (int)report->tune->scheme_count; i++) {
        scheme_row(report, i, table);
    }
    section_end(table, text);
}

// The trial of a scheme that comes next from coarse to fine, or NULL.
static const TuneTrial *next_trial(const Tune *tune, size_t scheme, const TuneTrial *last)
{
    const TuneTrial *next = NULL;
    for (size_t i = 0; i < tune->trial_count; i++) {
        const TuneTrial *trial = &tune->trials[i];
        if (trial->scheme == scheme && (last == NULL || trial->index > last->index) &&
            (next == NULL || trial->index < next->index)) {
            next = trial;
        }
    }
    return next;
}

static void trial_row(const Tune *tune, const TuneTrial *trial, bool is_first, Table *table)
{
    const TuneScheme *scheme = &tune->schemes[trial->scheme];
    table_cell(table, "%s", is_first ? scheme->scheme.name : "");
    value_cell(table, scheme, trial->value);
    table_cell(table, "%.2e", trial->error);
    table_cell(table, "%zu", trial->run.steps);
    table_cell(table, "%.4g", trial->run.processor_s * UNITS_MS);
    table_cell(table, "%s", trial->meets ? "meets it" : "");
}

// Runs that failed one after another, in one row: the coarsest, and how many more there were.
static void failed_row(const Tune *tune, const TuneTrial *trial, size_t count, bool is_first,
                       Table *table)
{
    const TuneScheme *scheme = &tune->schemes[trial->scheme];
    table_cell(table, "%s", is_first ? scheme->scheme.name : "");
    value_cell(table, scheme, trial->value);
    for (int i = 0; i < 3; i++) {
        table_cell(table, "-");
    }
    if (count > 1) {
        table_cell(table, "failed, like the %zu before it", count - 1);
    } else {
        table_cell(table, "failed");
    }
}

static void scheme_trials(const Tune *tune, size_t scheme, Table *table)
{
    bool is_first = true;
    size_t failed = 0;
    const TuneTrial *trial = next_trial(tune, scheme, NULL);
    while (trial != NULL) {
        const TuneTrial *next = next_trial(tune, scheme, trial);
        failed = isfinite(trial->error) ? 0 : failed + 1;
        if (failed == 0) {
            trial_row(tune, trial, is_first, table);
            is_first = false;
        } else if (next == NULL || isfinite(next->error)) {
            failed_row(tune, trial, failed, is_first, table);
            is_first = false;
        }
        trial = next;
    }
}

// Why the finest of the runs that failed did.
static void write_failure(const Tune *tune, size_t scheme, Text *text)
{
    const TuneTrial *last = NULL;
    for (const TuneTrial *trial = next_trial(tune, scheme, NULL); trial != NULL;
         trial = next_trial(tune, scheme, trial)) {
        last = isfinite(trial->error) ? last : trial;
    }
    if (last != NULL) {
        text_append(text, "  %s: %s\n", tune->schemes[scheme].scheme.name, last->reason);
    }
}

static void write_trials(const TuneReport *report, const Style *style, Text *text)
{
    static const SectionHead HEADS[] = {
        {"scheme", "", TABLE_LEFT},       {"setting", "", TABLE_RIGHT}, {"error", "1", TABLE_RIGHT},
        {"world steps", "", TABLE_RIGHT}, {"CPU", "ms", TABLE_RIGHT},   {"", "", TABLE_LEFT},
    };
    const Tune *tune = report->tune;
    Table *table = section_begin("What was tried", 6, HEADS, style, text);
    for (size_t i = 0; i < tune->scheme_count; i++) {
        scheme_trials(tune, i, table);
    }
    section_end(table, text);
    text_append(text,
                "  Settings are of the R10 series, ten a decade. Those left out are too coarse "
                "for any order that the scheme could have. Wall times here are of single "
                "runs, several at a time.\n\n");
    for (size_t i = 0; i < tune->scheme_count; i++) {
        write_failure(tune, i, text);
    }
}

void tune_text_write(const void *target, const Style *style, Text *text)
{
    const TuneReport *report = target;
    const bool is_held = report->tune->held_s > 0.0;
    write_head(report, style, text);
    if (is_held) {
        tune_held_text_answer(report, style, text);
    } else {
        write_answer(report, style, text);
    }
    // at a step that is held more is searched only where nothing meets the error there
    const bool is_searched = !is_held || !tune_is_met_held(report->tune);
    if (is_searched) {
        write_schemes(report, style, text);
    }
    tune_reference_write(report, style, text);
    tune_export_write(report, style, text);
    if (is_searched) {
        write_trials(report, style, text);
    }
}
