// Reports a check as text and as JSON.
#include "commands/check/check_report.h"
#include "casefile/expect_outcome.h"
#include "write/json_value.h"
#include "write/settings_json.h"
#include "write/table.h"
#include "write/units.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

const char *const CHECK_CHANGE_WORDS[CHECK_CHANGE_COUNT] = {
    [CHECK_CHANGE_NONE] = "unchanged",
    [CHECK_CHANGE_NEW] = "new",
    [CHECK_CHANGE_UNREADABLE] = "unreadable",
    [CHECK_CHANGE_REPLACED] = "replaced",
};

size_t check_report_changes(const CheckReport *report, CheckChange change)
{
    size_t count = 0;
    for (size_t i = 0; i < report->case_count; i++) {
        const CheckCase *item = &report->cases[i];
        count += item->err.kind == ERR_NONE && item->change == change ? 1 : 0;
    }
    return count;
}

// The change of a case in words: "new baseline: 114 numbers", "replaced: 3 of 114 numbers moved".
static void check_report_change(const CheckCase *item, Text *text)
{
    size_t settings = 0;
    for (size_t i = 0; i < item->row_count; i++) {
        settings += item->rows[i].verdict == CHECK_SETTING ? 1 : 0;
    }
    switch (item->change) {
    case CHECK_CHANGE_NEW:
        text_append(text, "new baseline: %zu numbers", item->made_count);
        break;
    case CHECK_CHANGE_UNREADABLE:
        text_append(text, "new baseline: %zu numbers, in place of a file that could not be read",
                    item->made_count);
        break;
    case CHECK_CHANGE_REPLACED:
        text_append(text, "replaced: %zu of %zu numbers moved",
                    check_report_count(item).out - settings, item->made_count);
        if (settings > 0) {
            text_append(text, ", %zu %s changed", settings, settings == 1 ? "setting" : "settings");
        }
        break;
    default:
        text_append(text, "unchanged: %zu numbers within the bands of the old baseline",
                    item->made_count);
    }
}

CheckCounts check_report_count(const CheckCase *item)
{
    CheckCounts counts = {0};
    for (size_t i = 0; i < item->row_count; i++) {
        const CheckVerdict verdict = item->rows[i].verdict;
        counts.within += verdict == CHECK_WITHIN ? 1 : 0;
        counts.left_out += verdict == CHECK_LEFT_OUT ? 1 : 0;
        counts.out += check_row_is_out(&item->rows[i]) ? 1 : 0;
    }
    for (size_t i = 0; i < item->limit_count; i++) {
        const bool is_within = item->limits[i].verdict == CHECK_WITHIN;
        counts.limits_within += is_within ? 1 : 0;
        counts.limits_out += is_within ? 0 : 1;
    }
    for (size_t i = 0; i < item->outcome_count; i++) {
        const CheckOutcome *outcome = &item->outcomes[i];
        counts.outcomes[outcome->expected->kind] += outcome->is_as_expected ? 1 : 0;
        counts.outcomes_wrong += outcome->is_as_expected ? 0 : 1;
    }
    return counts;
}

bool check_report_is_out(const CheckCase *item)
{
    const CheckCounts counts = check_report_count(item);
    return counts.out + counts.limits_out + counts.outcomes_wrong > 0;
}

void check_report_outcomes(const CheckReport *report, Text *text)
{
    size_t kinds[OUTCOME_KIND_COUNT] = {0};
    size_t wrong = 0;
    size_t all = 0;
    for (size_t i = 0; i < report->case_count; i++) {
        const CheckCounts counts = check_report_count(&report->cases[i]);
        for (int kind = 0; kind < OUTCOME_KIND_COUNT; kind++) {
            kinds[kind] += counts.outcomes[kind];
        }
        wrong += counts.outcomes_wrong;
        all += report->cases[i].outcome_count;
    }
    if (all == 0) {
        return;
    }
    text_append(text, "%zu %s: ", all, all == 1 ? "outcome" : "outcomes");
    for (int kind = 0; kind < OUTCOME_KIND_COUNT; kind++) {
        text_append(text, "%s%zu %s", kind > 0 ? ", " : "", kinds[kind],
                    EXPECT_OUTCOME_WORDS[kind]);
    }
    text_append(text, ", %zu WRONG", wrong);
}

size_t check_report_errors(const CheckReport *report)
{
    size_t count = 0;
    for (size_t i = 0; i < report->case_count; i++) {
        count += report->cases[i].err.kind != ERR_NONE ? 1 : 0;
    }
    return count;
}

size_t check_report_differing(const CheckReport *report)
{
    size_t count = 0;
    for (size_t i = 0; i < report->case_count; i++) {
        count += check_report_is_out(&report->cases[i]) ? 1 : 0;
    }
    return count;
}

// What there is to say of a setting, of what came or went, and of a hash. False for a number.
static bool say_other(const CheckRow *row, char words[CHECK_WORDS_SIZE])
{
    if (row->verdict == CHECK_SETTING) {
        snprintf(words, CHECK_WORDS_SIZE, "setting %s was %s, is %s", row->name, row->was_text,
                 row->now_text);
    } else if (row->kind == CHECK_HASH &&
               (row->verdict == CHECK_NEW || row->verdict == CHECK_GONE)) {
        snprintf(words, CHECK_WORDS_SIZE, "a hash that is %s",
                 row->verdict == CHECK_NEW ? "not in the baseline" : "not measured any more");
    } else if (row->verdict == CHECK_NEW) {
        snprintf(words, CHECK_WORDS_SIZE, "is %.17g and not in the baseline", row->now);
    } else if (row->verdict == CHECK_GONE) {
        snprintf(words, CHECK_WORDS_SIZE, "was %.17g and is not measured any more", row->was);
    } else if (row->verdict == CHECK_LEFT_OUT) {
        snprintf(words, CHECK_WORDS_SIZE, "not looked at: %s", row->why);
    } else if (row->kind == CHECK_HASH) {
        snprintf(words, CHECK_WORDS_SIZE,
                 "was %016" PRIx64 ", is %016" PRIx64 " in the same build of the program",
                 row->hash_was, row->hash_now);
    } else {
        return false;
    }
    return true;
}

void check_report_words(const CheckRow *row, char words[CHECK_WORDS_SIZE])
{
    const char *kind = BASELINE_BAND_WORDS[row->band_kind];
    if (say_other(row, words)) {
        return;
    }
    if (row->band_kind == BAND_STATISTICAL) {
        snprintf(words, CHECK_WORDS_SIZE,
                 "median was %.9g, is %.9g: %+.3g; p = %.2g of the rank test (%s: %s)", row->was,
                 row->now, row->deviation, row->p, kind, row->why);
    } else if (isfinite(row->severity)) {
        snprintf(words, CHECK_WORDS_SIZE, "was %.17g, is %.17g: %+.3g, allowed %.3g (%s: %s)",
                 row->was, row->now, row->deviation, row->band, kind, row->why);
    } else {
        snprintf(words, CHECK_WORDS_SIZE, "was %.17g, is %.17g: %+.3g (%s: %s)", row->was, row->now,
                 row->deviation, kind, row->why);
    }
}

static void number(char *cell, const char *format, double value)
{
    // the format is one of those below
    snprintf(cell, CHECK_CELL_SIZE, isfinite(value) ? format : "-", value);
}

CheckCells check_report_cells(const CheckRow *row)
{
    CheckCells cells;
    if (row->verdict == CHECK_SETTING) {
        snprintf(cells.was, sizeof cells.was, "%.60s", row->was_text);
        snprintf(cells.now, sizeof cells.now, "%.60s", row->now_text);
    } else if (row->kind == CHECK_HASH) {
        snprintf(cells.was, sizeof cells.was, "%08" PRIx64 "...", row->hash_was >> 32);
        snprintf(cells.now, sizeof cells.now, "%08" PRIx64 "...", row->hash_now >> 32);
    } else {
        number(cells.was, "%.6g", row->was);
        number(cells.now, "%.6g", row->now);
    }
    const bool is_number = row->verdict != CHECK_SETTING && row->kind != CHECK_HASH;
    number(cells.difference, "%+.2g", is_number ? row->deviation : NAN);
    number(cells.allowed, "%.2g", is_number ? row->band : NAN);
    // what has no band says what it is
    if (row->verdict != CHECK_WITHIN && row->verdict != CHECK_OUT) {
        text_copy(cells.allowed, sizeof cells.allowed, CHECK_VERDICT_WORDS[row->verdict]);
    }
    return cells;
}

CheckLimitCells check_report_limit_cells(const CheckLimit *limit)
{
    const Expectation *expectation = limit->expectation;
    const char *blank = expectation->unit[0] != '\0' ? " " : "";
    CheckLimitCells cells = {.value = "-", .off = "-"};
    if (isfinite(limit->value)) {
        snprintf(cells.value, sizeof cells.value, "%.6g%s%s", limit->value / expectation->unit_si,
                 blank, expectation->unit);
    }
    if (limit->verdict == CHECK_OUT) {
        snprintf(cells.off, sizeof cells.off, "%+.3g%s%s", limit->off / expectation->unit_si, blank,
                 expectation->unit);
    }
    return cells;
}

void check_report_limit(const CheckLimit *limit, char words[CHECK_WORDS_SIZE])
{
    const Expectation *expectation = limit->expectation;
    const CheckLimitCells cells = check_report_limit_cells(limit);
    if (limit->verdict == CHECK_GONE) {
        snprintf(words, CHECK_WORDS_SIZE, "is not measured, expected %s", expectation->words);
        return;
    }
    const int length =
        snprintf(words, CHECK_WORDS_SIZE, "is %s, expected %s", cells.value, expectation->words);
    const double end = limit->off > 0.0 ? expectation->high : expectation->low;
    if (limit->verdict == CHECK_WITHIN) {
        return;
    }
    if (limit->value == end) {
        snprintf(words + length, CHECK_WORDS_SIZE - (size_t)length, ": the end itself is outside");
        return;
    }
    char share[CHECK_CELL_SIZE] = "";
    if (end != 0.0) {
        snprintf(share, sizeof share, " (%.2g %%)", 100.0 * fabs(limit->off / end));
    }
    // the sign stands in the words
    snprintf(words + length, CHECK_WORDS_SIZE - (size_t)length, ": %s too %s%s", cells.off + 1,
             limit->off > 0.0 ? "high" : "low", share);
}

// The text.

enum {
    WORST_WITHIN = 5, // rows of a case in which nothing is out
    WORST_OUT = 20,   // rows that are out: twenty show what happened
    WIDE_LEAST = 116, // columns of a terminal that has room for a row in one line
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

// One line for the name and one for the numbers, which so fit into 80 columns. Names and settings
// are text from a baseline and a case.
static void check_report_write_row(const CheckRow *row, Text *text)
{
    const CheckCells cells = check_report_cells(row);
    char words[CHECK_WORDS_SIZE];
    if (row->verdict == CHECK_SETTING) {
        check_report_words(row, words);
        text_append(text, "  ");
        text_append_shown(text, words);
        text_append(text, "\n");
        return;
    }
    text_append(text, "  ");
    text_append_shown(text, row->name);
    text_append(text, "\n    %16s %16s %14s %14s\n", cells.was, cells.now, cells.difference,
                cells.allowed);
}

static void check_report_write_wide(const CheckCase *item, size_t count, const Style *style,
                                    Text *text)
{
    static const SectionHead HEADS[] = {
        {"metric", "", TABLE_LEFT},   {"baseline", "", TABLE_RIGHT},
        {"now", "", TABLE_RIGHT},     {"difference", "", TABLE_RIGHT},
        {"allowed", "", TABLE_RIGHT}, {"why", "", TABLE_LEFT | TABLE_DETAIL},
    };
    Table *table = section_begin(item->path, sizeof HEADS / sizeof *HEADS, HEADS, style, text);
    for (size_t i = 0; i < count; i++) {
        const CheckRow *row = &item->rows[i];
        const CheckCells cells = check_report_cells(row);
        table_cell(table, "%s", row->name);
        table_cell(table, "%s", cells.was);
        table_cell(table, "%s", cells.now);
        table_cell(table, "%s", cells.difference);
        table_cell(table, "%s", cells.allowed);
        table_cell(table, "%s",
                   row->verdict == CHECK_SETTING ? "" : BASELINE_BAND_WORDS[row->band_kind]);
    }
    section_end(table, text);
}

static void check_report_write_rows(const CheckCase *item, size_t count, const Style *style,
                                    Text *text)
{
    if (count > 0 && (style->width == 0 || style->width >= WIDE_LEAST)) {
        check_report_write_wide(item, count, style, text);
        return;
    }
    section_heading(item->path, style, text);
    text_append(text, "\n");
    if (count > 0) {
        text_append(text, "  metric\n    %16s %16s %14s %14s\n", "baseline", "now", "difference",
                    "allowed");
        text_append(text, "  ------------------------------------------------------------------\n");
    }
    for (size_t i = 0; i < count; i++) {
        check_report_write_row(&item->rows[i], text);
    }
}

// The limits of the case itself, each with what its backends say: all of them, for whoever wrote
// them wants to see each.
static void check_report_write_limits(const CheckCase *item, const Style *style, Text *text)
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
static void check_report_write_outcomes(const CheckCase *item, const Style *style, Text *text)
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

static void check_report_write_counts(const CheckCase *item, const Style *style, Text *text)
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
    check_report_write_outcomes(item, style, text);
    check_report_write_limits(item, style, text);
    if (item->baseline[0] == '\0') {
        text_append(text, "%s%s%s", item->note[0] != '\0' ? "  " : "", item->note,
                    item->note[0] != '\0' ? "\n" : "");
        return;
    }
    const size_t shown = rows_to_show(item, is_all);
    check_report_write_rows(item, shown, style, text);
    text_append(text, "  ");
    if (report->is_blessed) {
        check_report_change(item, text);
    } else {
        check_report_write_counts(item, style, text);
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

// The JSON.

static void set_numbers(json_t *object, const CheckRow *row)
{
    if (row->verdict == CHECK_SETTING) {
        json_object_set_new(object, "was", json_value_text(row->was_text));
        json_object_set_new(object, "now", json_value_text(row->now_text));
    } else if (row->kind == CHECK_HASH) {
        json_object_set_new(object, "was", json_sprintf("%016" PRIx64, row->hash_was));
        json_object_set_new(object, "now", json_sprintf("%016" PRIx64, row->hash_now));
    } else {
        json_value_set(object, "was", row->was);
        json_value_set(object, "now", row->now);
        json_value_set(object, "difference", row->deviation);
        json_value_set(object, "band", row->band);
        json_value_set(object, "bands_off", row->severity);
        json_value_set(object, "p", row->band_kind == BAND_STATISTICAL ? row->p : NAN);
    }
}

static json_t *row_object(const CheckRow *row)
{
    char words[CHECK_WORDS_SIZE];
    check_report_words(row, words);
    json_t *object = json_object();
    json_object_set_new(object, "metric", json_value_text(row->name));
    json_object_set_new(object, "verdict", json_string(CHECK_VERDICT_WORDS[row->verdict]));
    set_numbers(object, row);
    if (row->verdict != CHECK_SETTING) {
        json_object_set_new(object, "band_kind", json_string(BASELINE_BAND_WORDS[row->band_kind]));
    }
    json_object_set_new(object, "why", json_value_text(row->why));
    json_object_set_new(object, "message", json_value_text(words));
    return object;
}

static json_t *limit_object(const CheckLimit *limit)
{
    char words[CHECK_WORDS_SIZE];
    check_report_limit(limit, words);
    json_t *object =
        json_pack("{s:o, s:o, s:s, s:o}", "path", json_value_text(limit->name), "limit",
                  json_value_text(limit->expectation->words), "verdict",
                  CHECK_VERDICT_WORDS[limit->verdict], "message", json_value_text(words));
    json_value_set(object, "value", limit->value);
    json_value_set(object, "low", limit->expectation->low);
    json_value_set(object, "high", limit->expectation->high);
    json_value_set(object, "outside_by", limit->off);
    return object;
}

static json_t *outcome_object(const CheckOutcome *outcome)
{
    const OutcomeRun *run = &outcome->run;
    char words[CHECK_OUTCOME_TEXT_SIZE];
    check_outcome_words(outcome, words);
    json_t *object = json_pack(
        "{s:o, s:o, s:s, s:b, s:o, s:o, s:I}", "run", json_value_text(outcome->name), "expected",
        json_value_text(outcome->expected->words), "outcome", check_outcome_kind(outcome),
        "complete", (int)run->is_complete, "message", json_value_text(run->message), "found",
        json_value_text(words), "steps", (json_int_t)run->steps);
    json_value_set(object, "error", run->has_error ? run->error : NAN);
    json_value_set(object, "reference_uncertainty", outcome->uncertainty);
    json_value_set(object, "horizon_s", outcome->share > 0.0 ? outcome->horizon_s : NAN);
    json_value_set(object, "step_s", run->step_s);
    json_value_set(object, "wall_s", run->wall_s);
    return object;
}

static json_t *case_object(const CheckReport *report, const CheckCase *item)
{
    const CheckCounts counts = check_report_count(item);
    const char *status = item->err.kind != ERR_NONE  ? "failed"
                         : check_report_is_out(item) ? "out"
                                                     : "within";
    json_t *rows = json_array();
    for (size_t i = 0; i < item->row_count; i++) {
        json_array_append_new(rows, row_object(&item->rows[i]));
    }
    json_t *object =
        json_pack("{s:o, s:o, s:s, s:o, s:o, s:I, s:I, s:I, s:o}", "case",
                  json_value_text(item->path), "baseline", json_value_text(item->baseline),
                  "status", status, "message", json_value_text(item->err.text), "note",
                  json_value_text(item->note), "within", (json_int_t)counts.within, "out",
                  (json_int_t)counts.out, "left_out", (json_int_t)counts.left_out, "metrics", rows);
    json_t *limits = json_array();
    for (size_t i = 0; i < item->limit_count; i++) {
        json_array_append_new(limits, limit_object(&item->limits[i]));
    }
    json_object_set_new(object, "limits", limits);
    json_t *outcomes = json_array();
    for (size_t i = 0; i < item->outcome_count; i++) {
        json_array_append_new(outcomes, outcome_object(&item->outcomes[i]));
    }
    json_object_set_new(object, "outcomes", outcomes);
    if (report->is_blessed && item->err.kind == ERR_NONE) {
        json_object_set_new(object, "change", json_string(CHECK_CHANGE_WORDS[item->change]));
        json_object_set_new(object, "numbers", json_integer((json_int_t)item->made_count));
    }
    return object;
}

json_t *check_json_build(const void *target)
{
    const CheckReport *report = target;
    json_t *cases = json_array();
    for (size_t i = 0; i < report->case_count; i++) {
        json_array_append_new(cases, case_object(report, &report->cases[i]));
    }
    return json_pack("{s:o, s:s, s:b, s:I, s:f, s:o}", "tool", settings_json_tool(), "mode",
                     report->is_full ? "full" : "quick", "blessed", (int)report->is_blessed,
                     "rank_tests", (json_int_t)report->test_count, "false_alarm_rate", report->rate,
                     "cases", cases);
}
