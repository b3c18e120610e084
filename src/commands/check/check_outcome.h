// How the runs of a case end, beside how the case expects them to: `outcome` in its `expect:`.
#pragma once

#include "base/err.h"
#include "measure/scheme.h"
#include "measure/truth.h"

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
