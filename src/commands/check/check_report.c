// How is a number that moved described?
#include "commands/check/check_report.h"

#include "casefile/expect_outcome.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>

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

void check_report_change(const CheckCase *item, Text *text)
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
        snprintf(words, CHECK_WORDS_SIZE, "was %.17g, is %.17g: %+.3g, %.3g bands of %.3g (%s: %s)",
                 row->was, row->now, row->deviation, row->severity, row->band, kind, row->why);
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
    number(cells.band, "%.2g", is_number ? row->band : NAN);
    number(cells.severity, "%.2g", is_number ? row->severity : NAN);
    if (is_number && row->band_kind == BAND_STATISTICAL && isfinite(row->p)) {
        snprintf(cells.severity, sizeof cells.severity, "p %.2g", row->p);
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
