// What should who reads a change see of a regression check?
#include "report/check_markdown.h"

#include <string.h>

enum { WORST_ROWS = 10 }; // of a case: a comment is no log

// Text in a cell: a bar would end it.
static void append_cell(Text *text, const char *words)
{
    text_append(text, "| ");
    for (const char *c = words; *c != '\0'; c++) {
        text_append(text, strchr("|`<>\\*_", *c) != NULL ? "\\%c" : "%c", *c == '\n' ? ' ' : *c);
    }
    text_append(text, " ");
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

static void append_headline(const CheckReport *report, Text *text)
{
    if (report->is_blessed) {
        append_blessed(report, text);
        return;
    }
    const size_t errors = check_report_errors(report);
    const size_t differing = check_report_differing(report);
    text_append(text, "### jointplay check: ");
    if (errors + differing == 0) {
        text_append(text, "%zu %s within %s\n", report->case_count,
                    report->case_count == 1 ? "case" : "cases",
                    report->case_count == 1 ? "its bands" : "their bands");
        return;
    }
    text_append(text, "%zu of %zu cases out of their bands", differing, report->case_count);
    if (errors > 0) {
        text_append(text, ", %zu not checked", errors);
    }
    text_append(text, "\n");
}

static void append_out(const CheckCase *item, Text *text)
{
    const size_t out = check_report_count(item).out;
    text_append(text,
                "\n**%s**\n\n| metric | baseline | now | difference | band | bands off |\n"
                "|---|---:|---:|---:|---:|---:|\n",
                item->path);
    for (size_t i = 0; i < out && i < WORST_ROWS; i++) {
        const CheckRow *row = &item->rows[i];
        const CheckCells cells = check_report_cells(row);
        append_cell(text, row->name);
        append_cell(text, cells.was);
        append_cell(text, cells.now);
        append_cell(text, cells.difference);
        append_cell(text, cells.band);
        append_cell(text,
                    row->verdict == CHECK_OUT ? cells.severity : CHECK_VERDICT_WORDS[row->verdict]);
        text_append(text, "|\n");
    }
    if (out > WORST_ROWS) {
        text_append(text, "\nand %zu more.\n", out - WORST_ROWS);
    }
}

static void append_limits(const CheckCase *item, Text *text)
{
    text_append(text,
                "\n**%s**: limits of its own\n\n| expected of | limit | now | outside by |\n"
                "|---|---|---:|---:|\n",
                item->path);
    for (size_t i = 0; i < item->limit_count; i++) {
        const CheckLimit *limit = &item->limits[i];
        const CheckLimitCells cells = check_report_limit_cells(limit);
        if (limit->verdict == CHECK_WITHIN) {
            continue;
        }
        append_cell(text, limit->name);
        append_cell(text, limit->expectation->words);
        append_cell(text, limit->verdict == CHECK_GONE ? "not measured" : cells.value);
        append_cell(text, cells.off);
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
        const CheckCounts counts = check_report_count(item);
        append_cell(text, item->path);
        if (item->err.kind != ERR_NONE) {
            text_append(text, "| | | | not checked |\n");
            continue;
        }
        text_append(text, "| %zu | %zu | %zu ", counts.within + counts.limits_within,
                    counts.out + counts.limits_out, counts.left_out);
        append_cell(text, item->row_count > 0 ? item->rows[0].name : "");
        text_append(text, "|\n");
    }
    text_append(text, "\n</details>\n");
}

void check_markdown_write(const CheckReport *report, Text *text)
{
    append_headline(report, text);
    for (size_t i = 0; i < report->case_count; i++) {
        const CheckCase *item = &report->cases[i];
        if (item->err.kind != ERR_NONE) {
            text_append(text, "\n**%s** %s: %s\n", item->path,
                        report->is_blessed ? "has no new baseline" : "was not checked",
                        item->err.text);
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
    append_all(report, text);
}
