// Judges which numbers have moved by more than they may.
#pragma once

#include "base/err.h"
#include "commands/check/baseline.h"
#include "measure/scheme.h"
#include "measure/truth.h"

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
    double relative;     // 1, of each number: what it may move by at least
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

// Whether the runs of a case keep within the limits that it sets itself.

enum { CHECK_LIMIT_MAX = EXPECTATION_MAX * BACKEND_COUNT };

// One limit on one backend.
typedef struct CheckLimit {
    char name[LINKAGE_NAME_SIZE + EXPECTATION_PATH_SIZE]; // ode.joints.crank-coupler.force_max
    const Expectation *expectation;                       // of the scenario: lives as long as it
    CheckVerdict verdict; // CHECK_WITHIN, CHECK_OUT, or CHECK_GONE where nothing was measured
    double value;         // SI; NAN where nothing was measured
    double off;           // SI, by how much it is outside; see check_measure.h
} CheckLimit;

// Judges the limits of a scenario by its own start: writes at most CHECK_LIMIT_MAX, in the order of
// the case, and returns their count. A limit that concerns no backend of the case is not measured.
size_t check_limits_judge(const Scenario *scenario, const CheckMeasure *run, CheckLimit *limits);

// How the runs of a case end, beside how the case expects them to: `outcome` in its `expect:`.

enum { CHECK_OUTCOME_TEXT_SIZE = 768 };

// What became of one run, as its child process hands it over.
typedef struct OutcomeRun {
    bool is_lost; // its process died or was ended; the message says how
    bool is_complete;
    bool is_short; // its step was chosen, and its tolerance does not hold to the end
    char message[CHECK_OUTCOME_TEXT_SIZE]; // why it is not complete, or is short
    bool has_error;
    double error;       // 1, up to the horizon; of the reference itself its uncertainty
    double bound;       // 1, that a run with a chosen step states; else 0
    double bound_error; // 1, its error as far as the bound holds
    double step_s;
    size_t steps;
    double wall_s;
} OutcomeRun;

// One run and its verdict.
typedef struct CheckOutcome {
    char name[SCHEME_NAME_SIZE];     // backend or scheme; "case" where the file itself is refused
    const ExpectedOutcome *expected; // lives as long as the item
    bool is_as_expected;
    OutcomeRun run;
    double uncertainty; // 1, of the reference; INFINITY where unknown
    double horizon_s;   // up to when errors are taken
    double share;       // of the run that is
} CheckOutcome;

// Judges a run: sets is_as_expected from all else. A run agrees where its error and the reference's
// uncertainty together are within the limit and no bound that it states is broken.
void check_outcome_judge(CheckOutcome *outcome);

// What was found, in one sentence: "error 2.1e-07 +- 3e-12", "refused: ...", with what was expected
// where it is something else.
void check_outcome_words(const CheckOutcome *outcome, char words[CHECK_OUTCOME_TEXT_SIZE]);

// The kind of what was found, as results have it: "agrees", "reported", "detected", "refused", or
// "WRONG" where it is not what the case expects.
const char *check_outcome_kind(const CheckOutcome *outcome);
