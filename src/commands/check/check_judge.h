// Which numbers have moved by more than they may?
#pragma once

#include "commands/check/baseline.h"

// Chance that a check of any number of cases names at least one number of those that are tested
// statistically although nothing has changed: one check in a thousand.
extern const double CHECK_FALSE_ALARM_RATE;

typedef enum CheckVerdict {
    CHECK_WITHIN,
    CHECK_OUT,      // moved by more than its band, or of another distribution
    CHECK_SETTING,  // not a number measured but one given: a setting of the case is another
    CHECK_NEW,      // measured, and not in the baseline
    CHECK_GONE,     // in the baseline, and not measured any more
    CHECK_LEFT_OUT, // not looked at: the why says why
    CHECK_VERDICT_COUNT,
} CheckVerdict;

extern const char *const CHECK_VERDICT_WORDS[CHECK_VERDICT_COUNT];

typedef struct CheckRow {
    char name[BASELINE_KEY_SIZE]; // of the metric, or of the setting
    CheckVerdict verdict;
    CheckKind kind;
    BandKind band_kind;
    double was; // of BAND_STATISTICAL medians, as in `now`
    double now;
    double deviation; // now less was
    double band;
    double severity;   // 1 where the band ends, or where the p-value is the test's rate; INFINITY
                       // where there is no band
    double p;          // of BAND_STATISTICAL
    uint64_t hash_was; // of CHECK_HASH
    uint64_t hash_now;
    char was_text[BASELINE_VALUE_SIZE]; // of CHECK_SETTING
    char now_text[BASELINE_VALUE_SIZE];
    char why[BASELINE_WHY_SIZE];
} CheckRow;

typedef struct CheckEvidence {
    const CheckMeasure *run;
    const CheckMeasure *sample; // of the starts of a check; NULL where there is none
    size_t sample_count;
    const Baseline *now; // head only: settings and fingerprint of this check
    bool is_full;        // slow metrics were measured
    bool is_shaken;      // the inputs were rounded anew, so that hashes say nothing
    double rate;         // false-alarm rate of one test
} CheckEvidence;

// The number of tests that a baseline asks for.
size_t check_test_count(const Baseline *baseline);

// The most rows that there can be.
size_t check_row_max(const Baseline *baseline, const CheckEvidence *evidence);

// Judges a case: writes its rows, the worst first, and returns their count.
size_t check_judge(const Baseline *baseline, const CheckEvidence *evidence, CheckRow *rows);

// Whether a row makes the check fail.
bool check_row_is_out(const CheckRow *row);
