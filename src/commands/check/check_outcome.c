// Did a run end as its case expects?
//
//     agrees      complete, error + uncertainty of the reference <= limit, no stated bound broken
//     reported    complete, error - uncertainty > limit: `jointplay run` prints that error
//     detected    stopped with a message after its first step, or short of its tolerance
//     refused     no step was taken; the message says why
//
// Anything else is WRONG: a complete run that is further off than its case says, a bound that does
// not hold, a message without the words expected, a process that died.
#include "commands/check/check_outcome.h"

#include "casefile/expect_outcome.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static bool is_bound_broken(const OutcomeRun *run, double uncertainty)
{
    return run->bound > 0.0 && run->bound_error - uncertainty > run->bound;
}

static bool is_refused(const OutcomeRun *run)
{
    return !run->is_lost && !run->is_complete && run->steps == 0;
}

static bool is_detected(const OutcomeRun *run)
{
    return !run->is_lost && (run->is_complete ? run->is_short : run->steps > 0);
}

void check_outcome_judge(CheckOutcome *outcome)
{
    const OutcomeRun *run = &outcome->run;
    const ExpectedOutcome *expected = outcome->expected;
    const bool is_measured = run->is_complete && run->has_error && isfinite(outcome->uncertainty);
    const bool is_honest = !is_bound_broken(run, outcome->uncertainty);
    bool is_it = false;
    switch (expected->kind) {
    case OUTCOME_AGREES:
        is_it = is_measured && !run->is_short &&
                run->error + outcome->uncertainty <= expected->limit && is_honest;
        break;
    case OUTCOME_REPORTED:
        is_it = is_measured && run->error - outcome->uncertainty > expected->limit && is_honest;
        break;
    case OUTCOME_DETECTED:
        is_it = is_detected(run) && strstr(run->message, expected->message) != NULL && is_honest;
        break;
    default:
        is_it = is_refused(run) && strstr(run->message, expected->message) != NULL;
    }
    outcome->is_as_expected = is_it;
}

const char *check_outcome_kind(const CheckOutcome *outcome)
{
    return outcome->is_as_expected ? EXPECT_OUTCOME_WORDS[outcome->expected->kind] : "WRONG";
}

// What was found.
static void say_found(const CheckOutcome *outcome, char words[CHECK_OUTCOME_TEXT_SIZE])
{
    const OutcomeRun *run = &outcome->run;
    // the first line of a message, without the lines of a case file
    const int room = (int)strcspn(run->message, "\n");
    if (run->is_lost || is_refused(run) || is_detected(run)) {
        snprintf(words, CHECK_OUTCOME_TEXT_SIZE, "%s: %.*s",
                 run->is_lost      ? "lost"
                 : is_refused(run) ? "refused"
                                   : "detected",
                 room, run->message);
    } else if (is_bound_broken(run, outcome->uncertainty)) {
        snprintf(words, CHECK_OUTCOME_TEXT_SIZE, "error %.3g, above the bound %.3g that it states",
                 run->bound_error, run->bound);
    } else if (!run->has_error) {
        snprintf(words, CHECK_OUTCOME_TEXT_SIZE, "its error could not be measured%s%.*s",
                 run->message[0] != '\0' ? ": " : "", room, run->message);
    } else {
        snprintf(words, CHECK_OUTCOME_TEXT_SIZE, "error %.3g, reference +- %.2g", run->error,
                 outcome->uncertainty);
    }
}

void check_outcome_words(const CheckOutcome *outcome, char words[CHECK_OUTCOME_TEXT_SIZE])
{
    say_found(outcome, words);
    if (!outcome->is_as_expected) {
        const size_t length = strlen(words);
        snprintf(words + length, CHECK_OUTCOME_TEXT_SIZE - length, "; expected: %s",
                 outcome->expected->words);
    }
}
