// Everything there is to tell about a regression check: plain pointers, nothing owned.
#pragma once

#include "base/text.h"
#include "commands/check/check_judge.h"
#include "write/table.h"

#include <jansson.h>

enum {
    CHECK_NOTE_SIZE = 4 * BASELINE_TEXT_SIZE + 128, // the versions of two libraries, then and now
    CHECK_WORDS_SIZE = 1024,
};

// What a new baseline is to the one before it.
typedef enum CheckChange {
    CHECK_CHANGE_NONE,       // every number stands in the bands of the one before
    CHECK_CHANGE_NEW,        // there was none before
    CHECK_CHANGE_UNREADABLE, // the one before could not be read
    CHECK_CHANGE_REPLACED,   // numbers or settings moved
    CHECK_CHANGE_COUNT,
} CheckChange;

extern const char *const CHECK_CHANGE_WORDS[CHECK_CHANGE_COUNT];

typedef struct CheckCase {
    const char *path;           // of the case
    const char *baseline;       // of its baseline; empty where its limits alone judge it
    bool lacks_baseline;        // there is none, though it was not asked to go without
    Err err;                    // why it could not be checked; ERR_NONE where it was
    char note[CHECK_NOTE_SIZE]; // of another version of a library; empty where there is none
    double wall_s;              // of its runs, added up; when blessing, of all that was done
    CheckChange change;         // where is_blessed and without an error
    size_t made_count;          // likewise: numbers in the new baseline
    size_t row_count;
    const CheckRow *rows; // worst first
    size_t limit_count;
    const CheckLimit *limits; // that the case sets itself, in its order
    const char *title;        // of a case with outcomes; may be empty
    size_t outcome_count;
    const CheckOutcome *outcomes; // of the runs whose end the case expects
} CheckCase;

typedef struct CheckReport {
    size_t case_count;
    const CheckCase *cases;
    bool is_full;
    bool is_all;       // every number is shown, not the worst of each case alone
    bool is_blessed;   // the rows are what a new baseline changes of the old one
    size_t test_count; // statistical tests in all cases
    double rate;       // false-alarm rate of all of them together
} CheckReport;

typedef struct CheckCounts {
    size_t within; // rows, as the two below
    size_t out;
    size_t left_out;
    size_t limits_within;
    size_t limits_out;                   // those that were not measured among them
    size_t outcomes[OUTCOME_KIND_COUNT]; // as expected, by kind
    size_t outcomes_wrong;
} CheckCounts;

CheckCounts check_report_count(const CheckCase *item);

// The outcomes of all cases in one line: "12 outcomes: 9 agrees, 1 refused, 2 WRONG"; nothing where
// there are none.
void check_report_outcomes(const CheckReport *report, Text *text);

// Cases of which the new baseline is that to the one before.
size_t check_report_changes(const CheckReport *report, CheckChange change);

// Whether a row, a limit or an outcome of the case is out.
bool check_report_is_out(const CheckCase *item);

// Cases that could not be checked, and cases with a number out.
size_t check_report_errors(const CheckReport *report);
size_t check_report_differing(const CheckReport *report);

// The numbers of a row as one sentence: "was 1, is 2: +1, allowed 0.25 (rounding: ...)".
void check_report_words(const CheckRow *row, char words[CHECK_WORDS_SIZE]);

// The cells of a row: baseline, now, difference, and how far it may move.
enum { CHECK_CELL_SIZE = 64 };
typedef struct CheckCells {
    char was[CHECK_CELL_SIZE];
    char now[CHECK_CELL_SIZE];
    char difference[CHECK_CELL_SIZE];
    char allowed[CHECK_CELL_SIZE];
} CheckCells;

CheckCells check_report_cells(const CheckRow *row);

// A limit as one sentence: "is 1.31 kN, expected below 1.2 kN: 0.11 kN too high (9.2 %)"; and its
// cells: the number and by how much it is outside, in the unit of the limit.
typedef struct CheckLimitCells {
    char value[CHECK_CELL_SIZE];
    char off[CHECK_CELL_SIZE];
} CheckLimitCells;

void check_report_limit(const CheckLimit *limit, char words[CHECK_WORDS_SIZE]);
CheckLimitCells check_report_limit_cells(const CheckLimit *limit);

// Each is of a CheckReport: for other programs, a new reference; for CI systems, as JUnit XML; for
// a comment on a change, as Markdown; and for people.
json_t *check_json_build(const void *report);
void check_junit_write(const void *report, Text *text);
void check_markdown_write(const void *report, Text *text);
void check_text_write(const void *report, const Style *style, Text *text);
