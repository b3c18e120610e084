// What is the best that can be had at a step that cannot be changed?
#include "commands/tune/tune_report.h"

#include "commands/tune/tune_setting.h"
#include "write/joint_units.h"
#include "write/number.h"
#include "write/section.h"
#include "write/units.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

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

static void write_longest(const TuneReport *report, Text *text)
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

static void scheme_row(const Tune *tune, const TuneTrial *trial, Table *table)
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
static void write_reasons(const Tune *tune, Text *text)
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

static void write_schemes(const Tune *tune, const Style *style, Text *text)
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
                scheme_row(tune, trial, table);
            }
        }
    }
    section_end(table, text);
    write_reasons(tune, text);
}

void tune_held_text_answer(const TuneReport *report, const Style *style, Text *text)
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
        write_longest(report, text);
    }
    write_schemes(tune, style, text);
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
