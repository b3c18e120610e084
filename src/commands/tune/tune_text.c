// Writes the text of a search: the cheapest setting, its use, and what was tried.
#include "commands/tune/tune.h"
#include "commands/tune/tune_export.h"
#include "commands/tune/tune_files.h"
#include "commands/tune/tune_search.h"
#include "write/measured_fields.h"
#include "write/number.h"
#include "write/settled.h"
#include "write/table.h"
#include "write/units.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

// The best that can be had at a step that cannot be changed.

enum { HEADING_SIZE = 64 };

static const char *heading_at(const Tune *tune, const char *words, char heading[HEADING_SIZE])
{
    snprintf(heading, HEADING_SIZE, "%s at %.4g us", words, tune->held_s * UNITS_US);
    return heading;
}

// That nothing at the step is good enough, and how near it comes.
static void append_lack(const Tune *tune, Text *text)
{
    text_append(text, "nothing at %.4g us ", tune->held_s * UNITS_US);
    if (tune->held == TUNE_NONE) {
        text_append(text, "has a meaningful error");
        return;
    }
    const TuneTrial *held = &tune->trials[tune->held];
    text_append(text, "meets an error of %.3g; the least there is %.3g, of %s", tune->target,
                held->error, tune->schemes[held->scheme].scheme.name);
}

// What the longest step is the longest of.
static void append_longest(const Tune *tune, Text *text)
{
    text_append(text, "the longest step that ");
    if (isfinite(tune->target)) {
        text_append(text, "meets %.3g", tune->target);
    } else {
        text_append(text, "has one");
    }
}

static void tune_text_write_longest(const TuneReport *report, Text *text)
{
    const Tune *tune = report->tune;
    const TuneTrial *longest = tune_best(tune, tune->winner);
    Text words;
    text_init(&words);
    append_lack(tune, &words);
    text_append(text, "\n  N%s.", words.data + 1);
    text_finish(&words);
    if (longest == NULL) {
        text_append(text, " Nor does any shorter step that was tried.\n");
        return;
    }
    text_init(&words);
    append_longest(tune, &words);
    text_append(text, " T%s:\n\n", words.data + 1);
    text_finish(&words);
    tune_setting_write(report, longest, text);
}

static void tune_held_text_scheme_row(const Tune *tune, const TuneTrial *trial, Table *table)
{
    table_cell(table, "%s", tune->schemes[trial->scheme].scheme.name);
    section_finite(table, "%.2e", trial->error);
    table_cell(table, "%zu", trial->run.steps);
    table_cell(table, "%.4g", tune_setting_time(tune, trial) * UNITS_MS);
    const bool is_best = tune->held != TUNE_NONE && trial == &tune->trials[tune->held];
    table_cell(table, "%s",
               is_best                                  ? "the least"
               : !isfinite(trial->error)                ? "failed"
               : isfinite(tune->target) && trial->meets ? "meets it"
                                                        : "");
}

// Why the runs at the step that failed did, each reason once.
static void tune_text_write_reasons(const Tune *tune, Text *text)
{
    for (size_t i = 0; i < tune->trial_count; i++) {
        const TuneTrial *trial = &tune->trials[i];
        bool is_said = trial->value != tune->held_s || trial->reason[0] == '\0';
        for (size_t k = 0; k < i && !is_said; k++) {
            is_said = strcmp(trial->reason, tune->trials[k].reason) == 0;
        }
        if (!is_said) {
            text_append(text, "  %s: %s\n", tune->schemes[trial->scheme].scheme.name,
                        trial->reason);
        }
    }
}

static void tune_held_text_write_schemes(const Tune *tune, const Style *style, Text *text)
{
    static const SectionHead HEADS[] = {
        {"scheme", "", TABLE_LEFT},
        {"error", "1", TABLE_RIGHT},
        {"world steps", "", TABLE_RIGHT | TABLE_DETAIL},
        {"CPU", "ms", TABLE_RIGHT | TABLE_DETAIL},
        {"", "", TABLE_LEFT},
    };
    char heading[HEADING_SIZE];
    Table *table = section_begin(heading_at(tune, "Schemes", heading), 5, HEADS, style, text);
    for (size_t scheme = 0; scheme < tune->scheme_count; scheme++) {
        for (size_t i = 0; i < tune->trial_count; i++) {
            const TuneTrial *trial = &tune->trials[i];
            if (trial->scheme == scheme && trial->value == tune->held_s) {
                tune_held_text_scheme_row(tune, trial, table);
            }
        }
    }
    section_end(table, text);
    tune_text_write_reasons(tune, text);
}

// Appends the best setting at the step, whether it meets the error, the longest step that does
// where it does not, and every scheme at the step.
static void tune_held_text_answer(const TuneReport *report, const Style *style, Text *text)
{
    const Tune *tune = report->tune;
    char heading[HEADING_SIZE];
    text_append(text, "\n%s%s%s\n\n", style->heading, heading_at(tune, "Best setting", heading),
                style->end);
    if (tune->held != TUNE_NONE) {
        tune_setting_write(report, &tune->trials[tune->held], text);
    } else {
        text_append(text, "  none\n");
    }
    if (!tune_is_met_held(tune)) {
        tune_text_write_longest(report, text);
    }
    tune_held_text_write_schemes(tune, style, text);
}

void tune_held_text_source(const TuneReport *report, const TuneLinear *linear, Text *text)
{
    const JointUnits *units =
        joint_units(&report->scenario->linkage.joints[report->tune->contact.joint]);
    switch (linear->source) {
    case TUNE_LINEAR_SECANT:
        text_append(text, "law at %.3g %s", linear->depth * units_per_si(units->length),
                    units->length);
        break;
    case TUNE_LINEAR_MEDIAN:
        text_append(text, "median impact");
        break;
    default:
        text_append(text, "hardest impact");
        break;
    }
}

static void constants_row(const TuneReport *report, int number, Table *table)
{
    const Tune *tune = report->tune;
    const TuneLinear *linear = &tune->linears[number];
    Text source;
    text_init(&source);
    tune_held_text_source(report, linear, &source);
    table_cell(table, "%s", source.data);
    text_finish(&source);
    section_finite(table, "%.4g", linear->is_row ? NAN : linear->stiffness);
    section_finite(table, "%.4g", linear->is_row ? NAN : linear->damping);
    table_cell(table, "%.4g", linear->row.erp);
    table_cell(table, "%.4g", linear->row.cfm);
    section_finite(table, "%.2e", linear->error);
    table_cell(table, "%s",
               number == tune->linear ? "best kp, kd"
               : number == tune->row  ? "best row"
                                      : "");
}

// Why those that failed did, each reason once.
static void write_failures(const TuneReport *report, Text *text)
{
    const Tune *tune = report->tune;
    for (size_t i = 0; i < tune->linear_count; i++) {
        const char *reason = tune->linears[i].reason;
        bool is_said = reason[0] == '\0';
        for (size_t k = 0; k < i && !is_said; k++) {
            is_said = strcmp(reason, tune->linears[k].reason) == 0;
        }
        if (!is_said) {
            text_append(text, "  ");
            tune_held_text_source(report, &tune->linears[i], text);
            text_append(text, "%s: %s\n", tune->linears[i].is_row ? ", ERP and CFM" : "", reason);
        }
    }
}

void tune_held_text_constants(const TuneReport *report, const Style *style, Text *text)
{
    const Tune *tune = report->tune;
    const JointUnits *units = joint_units(&report->scenario->linkage.joints[tune->contact.joint]);
    const SectionHead heads[] = {
        {"best for", "", TABLE_LEFT},
        {"kp", units->stiffness, TABLE_RIGHT},
        {"kd", units->damping, TABLE_RIGHT},
        {"ERP", "1", TABLE_RIGHT},
        {"CFM", units->cfm, TABLE_RIGHT},
        {"error", "1", TABLE_RIGHT},
        {"", "", TABLE_LEFT},
    };
    char heading[HEADING_SIZE];
    Table *table =
        section_begin(heading_at(tune, "Contacts with constants", heading), 7, heads, style, text);
    for (int i = 0; i < (int)tune->linear_count; i++) {
        constants_row(report, i, table);
    }
    section_end(table, text);
    write_failures(report, text);
}

void tune_held_text_row(const Tune *tune, Text *text)
{
    if (tune->row == TUNE_NONE) {
        text_append(text, "  No ERP and CFM that are the same at every depth ran to the end.\n");
        return;
    }
    const TuneLinear *row = &tune->linears[tune->row];
    text_append(
        text, "  One ERP and one CFM for every depth: soft_erp = %s, soft_cfm = %s: error %.3g.\n",
        number_shortest(row->row.erp).text, number_shortest(row->row.cfm).text, row->error);
}

bool tune_held_text_unmet(const TuneReport *report, Err *err)
{
    const Tune *tune = report->tune;
    const TuneTrial *longest = tune_best(tune, tune->winner);
    Text words;
    text_init(&words);
    append_lack(tune, &words);
    text_append(&words, "; ");
    if (longest == NULL) {
        text_append(&words, "nor does any shorter step that was tried");
    } else {
        append_longest(tune, &words);
        text_append(&words, ": ");
        tune_setting_words(report, longest, &words);
    }
    err_set_lines(err, ERR_DIFFERS, words.data);
    text_finish(&words);
    return false;
}

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
    if (tune->of != TOLERANCE_OF_MOTION) {
        text_append(text, " of %s", OPTIONS_TOLERANCES_OF[tune->of]);
    }
    if (tune->limit.steps > 0) {
        text_append(text, ", in at most %zu world steps", tune->limit.steps);
    } else if (tune->limit.time_s > 0.0) {
        text_append(text, ", in at most %.4g ms", tune->limit.time_s * UNITS_MS);
    }
    text_append(text, "; the least %s\n", tune->cost == TUNE_STEPS ? "world steps" : "time");
}

static void tune_text_write_head(const TuneReport *report, const Style *style, Text *text)
{
    const Scenario *scenario = report->scenario;
    const Tune *tune = report->tune;
    section_title(scenario->title, scenario_path(scenario), style, text);
    settled_text(scenario, text);
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
        return scheme->is_by_order ? "meets it, on an even fall of errors"
                                   : "meets it, and so does the next finer one";
    case TUNE_COSTLIER:
        if (tune->cost == TUNE_LENGTH) {
            return "shorter ones were not tried";
        }
        return scheme->trials == 0   ? "costs more than the best"
               : scheme->is_by_order ? "finer ones cost more, by the order of its errors"
                                     : "finer ones cost more than the best";
    case TUNE_STALLED:
        return "ten times finer is hardly better";
    case TUNE_TOO_LONG:
        return scheme->is_by_order ? "finer ones take too long, by the order of its errors"
                                   : "finer ones take longer than was allowed";
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

static void tune_text_scheme_row(const TuneReport *report, int number, Table *table)
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

static void tune_text_write_schemes(const TuneReport *report, const Style *style, Text *text)
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
        tune_text_scheme_row(report, i, table);
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
    tune_text_write_head(report, style, text);
    if (is_held) {
        tune_held_text_answer(report, style, text);
    } else {
        write_answer(report, style, text);
    }
    // at a step that is held more is searched only where nothing meets the error there
    const bool is_searched = !is_held || !tune_is_met_held(report->tune);
    if (is_searched) {
        tune_text_write_schemes(report, style, text);
    }
    tune_reference_write(report, style, text);
    tune_export_write(report, style, text);
    if (is_searched) {
        write_trials(report, style, text);
    }
}

// The first screen: the setting, what it takes, and the schemes beside it, a row each.

enum { SCREEN_SCHEMES = 6 };

// The trial that answers the question, or NULL.
static const TuneTrial *tune_screen_best(const Tune *tune)
{
    if (tune->held_s > 0.0) {
        return tune->held != TUNE_NONE ? &tune->trials[tune->held] : NULL;
    }
    return tune_best(tune, tune->winner);
}

static void tune_screen_answer(const TuneReport *report, Text *text)
{
    const Tune *tune = report->tune;
    const TuneTrial *best = tune_screen_best(tune);
    const bool is_met = tune->held_s > 0.0 ? tune_is_met_held(tune) : tune_report_is_met(report);
    Text words;
    text_init(&words);
    text_append(&words, "  ");
    if (!is_met) {
        text_append(&words, "NOTHING that was tried meets an error of %.3g%s. ", tune->target,
                    best != NULL ? "; the nearest:" : "");
    }
    if (best == NULL && tune->within != TUNE_NONE) {
        text_append(&words, "The least error, %.3g: ", tune->trials[tune->within].error);
        tune_setting_words(report, &tune->trials[tune->within], &words);
        text_append(&words, ".");
    }
    if (best != NULL) {
        tune_setting_words(report, best, &words);
        text_append(&words, ": error %.3g, %zu world steps, %.4g ms of the processor.", best->error,
                    best->run.steps, tune_setting_time(tune, best) * UNITS_MS);
    }
    screen_line(&words, text);
    if (best != NULL) {
        text_init(&words);
        text_append(&words, "  In a case: ");
        tune_setting_keys(report, best, ", ", &words);
        screen_line(&words, text);
    }
}

static void tune_screen_schemes(const TuneReport *report, Text *text)
{
    const Tune *tune = report->tune;
    enum { COLUMNS = 5 };
    static const SectionHead HEADS[COLUMNS] = {
        {"scheme", "", TABLE_LEFT | TABLE_KEY},
        {"setting", "", TABLE_RIGHT},
        {"error", "1", TABLE_RIGHT},
        {"CPU", "ms", TABLE_RIGHT},
        {"", "", TABLE_LEFT},
    };
    Table *table = table_headed(COLUMNS, HEADS);
    for (size_t i = 0; i < tune->scheme_count && i < SCREEN_SCHEMES; i++) {
        const TuneScheme *scheme = &tune->schemes[i];
        const TuneTrial *best = tune_best(tune, (int)i);
        const TuneTrial *shown =
            best != NULL || scheme->least == TUNE_NONE ? best : &tune->trials[scheme->least];
        table_cell(table, "%s", scheme->scheme.name);
        if (shown != NULL) {
            value_cell(table, scheme, shown->value);
            section_finite(table, "%.2g", shown->error);
            section_finite(table, "%.4g", tune_setting_time(tune, shown) * UNITS_MS);
        } else {
            for (size_t k = 1; k + 1 < COLUMNS; k++) {
                table_cell(table, "-");
            }
        }
        table_cell(table, "%s", best != NULL ? "meets it" : shown != NULL ? "misses it" : "failed");
    }
    table_write(table, text);
    table_destroy(table);
}

void tune_screen_write(const void *target, const Style *style, Text *text)
{
    const TuneReport *report = target;
    const Tune *tune = report->tune;
    section_title(report->scenario->title, scenario_path(report->scenario), style, text);
    write_asked(tune, text);
    text_append(text, "\n");
    tune_screen_answer(report, text);
    if (!(tune->held_s > 0.0) || !tune_is_met_held(tune)) {
        tune_screen_schemes(report, text);
    }
    tune_files_write(report, text);
    if (tune->reference.tolerance > 0.0) {
        text_append(text,
                    "  The reference alone, in place of ODE: reference.tolerance=%.3g, error %.3g, "
                    "%.4g ms.\n",
                    tune->reference.tolerance, tune->reference.error,
                    tune->reference.processor_median_s * UNITS_MS);
    }
    screen_truth(&tune->truth, text);
    settled_lines(report->scenario, text);
    text_append(text, "  --full: all settings tried%s\n",
                tune_export_is_writable(report) ? "; --code FILE.c writes the setting as a program"
                                                : "");
}
