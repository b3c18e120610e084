// Which numbers of which case have moved, and how near are the others to their bands?
#include "commands/check/check_report.h"

#include "write/section.h"
#include "write/units.h"

#include <math.h>
#include <string.h>

enum {
    WORST_WITHIN = 5, // rows of a case in which nothing is out
    WORST_OUT = 20,   // rows that are out: twenty show what happened
};

// Rows that are out, and of those within the worst that moved at all.
static size_t rows_to_show(const CheckCase *item, bool is_all)
{
    const size_t out = check_report_count(item).out;
    size_t shown = out > WORST_OUT ? WORST_OUT : out;
    while (shown < WORST_WITHIN && shown < item->row_count && item->rows[shown].severity > 0.0) {
        shown++;
    }
    return is_all ? item->row_count : shown;
}

static void write_rows(const CheckCase *item, size_t count, const Style *style, Text *text)
{
    if (count == 0) {
        section_heading(item->path, style, text);
        text_append(text, "\n");
        return;
    }
    static const SectionHead HEADS[] = {
        {"metric", "", TABLE_LEFT},
        {"baseline", "", TABLE_RIGHT | TABLE_MINOR},
        {"now", "", TABLE_RIGHT},
        {"difference", "", TABLE_RIGHT | TABLE_DETAIL},
        {"band", "", TABLE_RIGHT | TABLE_DETAIL},
        {"bands off", "", TABLE_RIGHT},
        {"why the band", "", TABLE_LEFT | TABLE_DETAIL},
    };
    Table *table = section_begin(item->path, 7, HEADS, style, text);
    for (size_t i = 0; i < count; i++) {
        const CheckRow *row = &item->rows[i];
        const CheckCells cells = check_report_cells(row);
        table_cell(table, "%s", row->name);
        table_cell(table, "%s", cells.was);
        table_cell(table, "%s", cells.now);
        table_cell(table, "%s", cells.difference);
        table_cell(table, "%s", cells.band);
        // what has no count of bands says what it is
        const bool is_counted =
            row->verdict == CHECK_WITHIN || (row->verdict == CHECK_OUT && isfinite(row->severity));
        table_cell(table, "%s", is_counted ? cells.severity : CHECK_VERDICT_WORDS[row->verdict]);
        table_cell(table, "%s",
                   row->verdict == CHECK_SETTING ? "" : BASELINE_BAND_WORDS[row->band_kind]);
    }
    section_end(table, text);
}

// The limits of the case itself, each with what its backends say: all of them, for whoever wrote
// them wants to see each.
static void write_limits(const CheckCase *item, const Style *style, Text *text)
{
    if (item->limit_count == 0) {
        return;
    }
    section_heading(item->path, style, text);
    const Expectation *written = NULL;
    for (size_t i = 0; i < item->limit_count; i++) {
        const CheckLimit *limit = &item->limits[i];
        const Expectation *expectation = limit->expectation;
        const CheckLimitCells cells = check_report_limit_cells(limit);
        const bool is_out = limit->verdict != CHECK_WITHIN;
        if (expectation != written) {
            text_append(text, "\n  %s: %s\n", expectation->path, expectation->words);
            written = expectation;
        }
        const int backend = (int)(strlen(limit->name) - strlen(expectation->path));
        text_append(text, "    %s%-10.*s %s%s%s%s\n", is_out ? style->failure : "",
                    backend > 0 ? backend - 1 : 0, limit->name,
                    limit->verdict == CHECK_GONE ? "not measured" : cells.value,
                    limit->verdict == CHECK_OUT ? ", outside by " : "",
                    limit->verdict == CHECK_OUT ? cells.off : "", is_out ? style->end : "");
    }
    text_append(text, "\n");
    const CheckCounts counts = check_report_count(item);
    text_append(text, "  %s%zu of %zu limits kept%s\n", counts.limits_out > 0 ? style->failure : "",
                counts.limits_within, item->limit_count, counts.limits_out > 0 ? style->end : "");
}

// How each run whose end the case expects did end.
static void write_outcomes(const CheckCase *item, const Style *style, Text *text)
{
    static const SectionHead HEADS[] = {
        {"run", "", TABLE_LEFT},
        {"outcome", "", TABLE_LEFT},
        {"error", "1", TABLE_RIGHT},
        {"reference +-", "1", TABLE_RIGHT | TABLE_DETAIL},
        {"up to", "%", TABLE_RIGHT | TABLE_MINOR},
        {"steps", "", TABLE_RIGHT},
        {"time", "ms", TABLE_RIGHT},
    };
    if (item->outcome_count == 0) {
        return;
    }
    Table *table = section_begin(item->path, 7, HEADS, style, text);
    for (size_t i = 0; i < item->outcome_count; i++) {
        const CheckOutcome *outcome = &item->outcomes[i];
        const OutcomeRun *run = &outcome->run;
        table_cell(table, "%s", outcome->name);
        table_cell(table, "%s", check_outcome_kind(outcome));
        section_finite(table, "%.2g", run->has_error ? run->error : NAN);
        section_finite(table, "%.2g", outcome->uncertainty);
        section_finite(table, "%.3g", run->has_error ? outcome->share * UNITS_PERCENT : NAN);
        table_cell(table, "%zu", run->steps);
        table_cell(table, "%.0f", run->wall_s * UNITS_MS);
    }
    section_end(table, text);
    for (size_t i = 0; i < item->outcome_count; i++) {
        const CheckOutcome *outcome = &item->outcomes[i];
        char words[CHECK_OUTCOME_TEXT_SIZE];
        if (!outcome->is_as_expected) {
            check_outcome_words(outcome, words);
            text_append(text, "  %s%s: %s%s\n", style->failure, outcome->name, words, style->end);
        }
    }
}

static void write_counts(const CheckCase *item, const Style *style, Text *text)
{
    const CheckCounts counts = check_report_count(item);
    text_append(text, "%s%zu within, %zu out%s", counts.out > 0 ? style->failure : "",
                counts.within, counts.out, counts.out > 0 ? style->end : "");
    if (counts.left_out > 0) {
        text_append(text, ", %zu left out", counts.left_out);
    }
}

static void write_case(const CheckReport *report, const CheckCase *item, bool is_all,
                       const Style *style, Text *text)
{
    if (item->err.kind != ERR_NONE) {
        section_heading(item->path, style, text);
        text_append(text, "\n  %s%s: %s%s\n", style->failure,
                    report->is_blessed ? "no new baseline" : "not checked", item->err.text,
                    style->end);
        return;
    }
    write_outcomes(item, style, text);
    write_limits(item, style, text);
    if (item->baseline[0] == '\0') {
        text_append(text, "%s%s%s", item->note[0] != '\0' ? "  " : "", item->note,
                    item->note[0] != '\0' ? "\n" : "");
        return;
    }
    const size_t shown = rows_to_show(item, is_all);
    write_rows(item, shown, style, text);
    text_append(text, "  ");
    if (report->is_blessed) {
        check_report_change(item, text);
    } else {
        write_counts(item, style, text);
    }
    if (shown < item->row_count) {
        text_append(text, "; %zu more rows with --all", item->row_count - shown);
    }
    text_append(text, "%s%s\n", item->note[0] != '\0' ? "\n  " : "", item->note);
}

static size_t lacking_baselines(const CheckReport *report)
{
    size_t count = 0;
    for (size_t i = 0; i < report->case_count; i++) {
        count += report->cases[i].lacks_baseline ? 1 : 0;
    }
    return count;
}

void check_text_write(const void *target, const Style *style, Text *text)
{
    const CheckReport *report = target;
    for (size_t i = 0; i < report->case_count; i++) {
        write_case(report, &report->cases[i], report->is_all, style, text);
    }
    const size_t errors = check_report_errors(report);
    const size_t differing = check_report_differing(report);
    text_append(text, "\n%zu %s: ", report->case_count, report->case_count == 1 ? "case" : "cases");
    if (report->is_blessed) {
        const size_t unreadable = check_report_changes(report, CHECK_CHANGE_UNREADABLE);
        text_append(text, "%zu new, %zu replaced, %zu unchanged",
                    check_report_changes(report, CHECK_CHANGE_NEW) + unreadable,
                    check_report_changes(report, CHECK_CHANGE_REPLACED),
                    check_report_changes(report, CHECK_CHANGE_NONE));
    } else {
        text_append(text, "%zu within, %zu out", report->case_count - errors - differing,
                    differing);
    }
    if (errors > 0) {
        text_append(text, ", %zu %s", errors, report->is_blessed ? "not made" : "not checked");
    }
    if (report->is_full && report->test_count > 0) {
        text_append(text, "; %zu rank tests, false-alarm rate %.2g together", report->test_count,
                    report->rate);
    }
    const size_t alone = lacking_baselines(report);
    if (alone > 0) {
        text_append(text, "; %zu without a baseline, judged by limits alone", alone);
    }
    text_append(text, "%s\n", report->is_full ? "" : "; quick: no ensembles, no orders");
    Text outcomes;
    text_init(&outcomes);
    check_report_outcomes(report, &outcomes);
    text_append(text, "%s%s", outcomes.data, outcomes.length > 0 ? "\n" : "");
    text_finish(&outcomes);
}
