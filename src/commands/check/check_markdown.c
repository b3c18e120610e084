// Writes a check as a comment on a change, in Markdown.
#include "base/printable.h"
#include "commands/check/check_report.h"
#include "write/units.h"

#include <stdlib.h>
#include <string.h>

enum { WORST_ROWS = 10 }; // of a case: a comment is to be short

// The backquotes that code of these words stands between: more than they have in a row.
static size_t fence_length(const char *words, size_t least)
{
    size_t longest = least - 1;
    while (*words != '\0') {
        const size_t run = strspn(words, "`");
        longest = run > longest ? run : longest;
        words += run > 0 ? run : 1;
    }
    return longest + 1;
}

static void append_fence(Text *text, size_t length)
{
    for (size_t i = 0; i < length; i++) {
        text_append(text, "`");
    }
}

// Any text, such as a path, as code, where no character is special. In the cell of a table a bar is
// escaped.
static void append_code(Text *text, const char *words, bool is_cell)
{
    char *shown = printable_copy(words, false);
    const size_t fence = fence_length(shown, 1);
    // a blank separates a backquote at an end from the fence; it is not shown
    const char *blank = strchr(shown, '`') != NULL || shown[0] == '\0' ? " " : "";
    append_fence(text, fence);
    text_append(text, "%s", blank);
    for (const char *c = shown; *c != '\0'; c++) {
        text_append(text, is_cell && *c == '|' ? "\\%c" : "%c", *c);
    }
    text_append(text, "%s", blank);
    append_fence(text, fence);
    free(shown);
}

// Lines of words, as a block of code.
static void append_block(Text *text, const char *words)
{
    enum { FENCE_LEAST = 3 };
    char *shown = printable_copy(words, true);
    const size_t fence = fence_length(shown, FENCE_LEAST);
    append_fence(text, fence);
    text_append(text, "text\n%s\n", shown);
    append_fence(text, fence);
    text_append(text, "\n");
    free(shown);
}

static void check_markdown_append_name(Text *text, const char *words)
{
    text_append(text, "| ");
    append_code(text, words, true);
    text_append(text, " ");
}

// Words in a cell, where no character is special.
static void append_words(Text *text, const char *words)
{
    char *shown = printable_copy(words, false);
    for (const char *c = shown; *c != '\0'; c++) {
        text_append(text, strchr("|`<>&\\*_[]", *c) != NULL ? "\\%c" : "%c", *c);
    }
    text_append(text, " ");
    free(shown);
}

static void check_markdown_append_cell(Text *text, const char *words)
{
    text_append(text, "| ");
    append_words(text, words);
}

// The file of a path.
static const char *file_name(const char *path)
{
    const char *slash = strrchr(path, '/');
    return slash != NULL ? slash + 1 : path;
}

// What a paragraph is about.
static void check_markdown_append_case(Text *text, const CheckCase *item)
{
    text_append(text, "\n**");
    append_code(text, item->path, false);
    text_append(text, "**");
}

static void append_blessed(const CheckReport *report, Text *text)
{
    const size_t errors = check_report_errors(report);
    text_append(text, "### jointplay check --bless: %zu new, %zu replaced, %zu unchanged",
                check_report_changes(report, CHECK_CHANGE_NEW) +
                    check_report_changes(report, CHECK_CHANGE_UNREADABLE),
                check_report_changes(report, CHECK_CHANGE_REPLACED),
                check_report_changes(report, CHECK_CHANGE_NONE));
    if (errors > 0) {
        text_append(text, ", %zu not made", errors);
    }
    text_append(text, "\n");
}

// Whether a case was judged by more than how its runs end.
static bool is_measured(const CheckCase *item)
{
    return item->outcome_count == 0 || item->row_count + item->limit_count > 0;
}

static bool has_numbers(const CheckReport *report)
{
    for (size_t i = 0; i < report->case_count; i++) {
        if (is_measured(&report->cases[i])) {
            return true;
        }
    }
    return false;
}

static void append_headline(const CheckReport *report, Text *text)
{
    if (report->is_blessed) {
        append_blessed(report, text);
        return;
    }
    const size_t errors = check_report_errors(report);
    const size_t differing = check_report_differing(report);
    text_append(text, "### jointplay check: ");
    const char *plural = report->case_count == 1 ? "" : "s";
    if (!has_numbers(report)) {
        text_append(text, "%zu of %zu case%s as expected", report->case_count - errors - differing,
                    report->case_count, plural);
    } else if (errors + differing == 0) {
        text_append(text, "%zu case%s within %s bands\n", report->case_count, plural,
                    report->case_count == 1 ? "its" : "their");
        return;
    } else {
        text_append(text, "%zu of %zu cases out of their bands", differing, report->case_count);
    }
    if (errors > 0) {
        text_append(text, ", %zu not checked", errors);
    }
    text_append(text, "\n");
}

static void append_out(const CheckCase *item, Text *text)
{
    const size_t out = check_report_count(item).out;
    check_markdown_append_case(text, item);
    text_append(text, "\n\n| metric | baseline | now | difference | allowed |\n"
                      "|---|---:|---:|---:|---:|\n");
    for (size_t i = 0; i < out && i < WORST_ROWS; i++) {
        const CheckRow *row = &item->rows[i];
        const CheckCells cells = check_report_cells(row);
        check_markdown_append_name(text, row->name);
        // values of settings are text from a baseline and a case
        (row->verdict == CHECK_SETTING ? check_markdown_append_name
                                       : check_markdown_append_cell)(text, cells.was);
        (row->verdict == CHECK_SETTING ? check_markdown_append_name
                                       : check_markdown_append_cell)(text, cells.now);
        check_markdown_append_cell(text, cells.difference);
        check_markdown_append_cell(text, cells.allowed);
        text_append(text, "|\n");
    }
    if (out > WORST_ROWS) {
        text_append(text, "\nand %zu more.\n", out - WORST_ROWS);
    }
}

static void append_limits(const CheckCase *item, Text *text)
{
    check_markdown_append_case(text, item);
    text_append(text, ": limits of its own\n\n| expected of | limit | now | outside by |\n"
                      "|---|---|---:|---:|\n");
    for (size_t i = 0; i < item->limit_count; i++) {
        const CheckLimit *limit = &item->limits[i];
        const CheckLimitCells cells = check_report_limit_cells(limit);
        if (limit->verdict == CHECK_WITHIN) {
            continue;
        }
        check_markdown_append_name(text, limit->name);
        check_markdown_append_cell(text, limit->expectation->words);
        check_markdown_append_cell(text,
                                   limit->verdict == CHECK_GONE ? "not measured" : cells.value);
        check_markdown_append_cell(text, cells.off);
        text_append(text, "|\n");
    }
}

static void append_all(const CheckReport *report, Text *text)
{
    text_append(text,
                "\n<details><summary>All cases (%s check)</summary>\n\n"
                "| case | within | out | left out | nearest to its band |\n"
                "|---|---:|---:|---:|---|\n",
                report->is_full ? "full" : "quick");
    for (size_t i = 0; i < report->case_count; i++) {
        const CheckCase *item = &report->cases[i];
        if (!is_measured(item)) {
            continue;
        }
        const CheckCounts counts = check_report_count(item);
        check_markdown_append_name(text, item->path);
        if (item->err.kind != ERR_NONE) {
            text_append(text, "| | | | not checked |\n");
            continue;
        }
        text_append(text, "| %zu | %zu | %zu ", counts.within + counts.limits_within,
                    counts.out + counts.limits_out, counts.left_out);
        if (item->row_count > 0) {
            check_markdown_append_name(text, item->rows[0].name);
        } else {
            check_markdown_append_cell(text, "");
        }
        text_append(text, "|\n");
    }
    text_append(text, "\n</details>\n");
}

// One run; the case is named in its first.
static void check_markdown_append_expected(const CheckCase *item, size_t number, Text *text)
{
    const CheckOutcome *outcome = &item->outcomes[number];
    const OutcomeRun *run = &outcome->run;
    const bool is_first = number == 0;
    char words[CHECK_OUTCOME_TEXT_SIZE];
    check_outcome_words(outcome, words);
    check_markdown_append_cell(text, is_first ? file_name(item->path) : "");
    check_markdown_append_cell(text, is_first ? item->title : "");
    check_markdown_append_cell(text, outcome->name);
    const bool has_words = !outcome->is_as_expected || !run->is_complete || run->is_short;
    text_append(text, "| %s", outcome->is_as_expected ? "" : "**WRONG**: ");
    text_append(text, "%s", has_words ? "" : check_outcome_kind(outcome));
    append_words(text, has_words ? words : "");
    if (run->has_error) {
        text_append(text, "| %.2g | %.3g ", run->error, outcome->share * UNITS_PERCENT);
    } else {
        text_append(text, "| | ");
    }
    text_append(text, "| %zu | %.0f |\n", run->steps, run->wall_s * UNITS_MS);
}

// The runs whose end the cases expect, in one table.
static void append_outcomes(const CheckReport *report, Text *text)
{
    Text counts;
    text_init(&counts);
    check_report_outcomes(report, &counts);
    if (counts.length > 0) {
        text_append(
            text,
            "\n%s\n\n| case | what it is | run | outcome | error | up to, %% | steps | time, ms |\n"
            "|---|---|---|---|---:|---:|---:|---:|\n",
            counts.data);
    }
    text_finish(&counts);
    for (size_t i = 0; i < report->case_count; i++) {
        for (size_t k = 0; k < report->cases[i].outcome_count; k++) {
            check_markdown_append_expected(&report->cases[i], k, text);
        }
    }
}

void check_markdown_write(const void *target, Text *text)
{
    const CheckReport *report = target;
    append_headline(report, text);
    for (size_t i = 0; i < report->case_count; i++) {
        const CheckCase *item = &report->cases[i];
        if (item->err.kind != ERR_NONE) {
            check_markdown_append_case(text, item);
            text_append(text, " %s:\n\n",
                        report->is_blessed ? "has no new baseline" : "was not checked");
            append_block(text, item->err.text);
            continue;
        }
        const CheckCounts counts = check_report_count(item);
        if (counts.limits_out > 0) {
            append_limits(item, text);
        }
        if (counts.out > 0) {
            append_out(item, text);
        }
    }
    append_outcomes(report, text);
    if (has_numbers(report)) {
        append_all(report, text);
    }
}
