// Judges which numbers moved by more than they may, and whether runs keep a case's limits and end
// as it expects.
//
// exact and rounding   |now - was| <= band
// statistical          p of the rank test of the baseline's sample against the check's own is above
//                      rate / tests: with Bonferroni's bound the chance of any false alarm in the
//                      whole check is at most the rate, however the tests depend on one another.
#include "commands/check/check_judge.h"
#include "base/sorted.h"
#include "base/text.h"
#include "casefile/expect_outcome.h"
#include "commands/check/check_measure.h"
#include "commands/check/setting_agrees.h"

#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const double CHECK_FALSE_ALARM_RATE = 1e-3;

const char *const CHECK_VERDICT_WORDS[CHECK_VERDICT_COUNT] = {
    [CHECK_WITHIN] = "within", [CHECK_OUT] = "out",   [CHECK_SETTING] = "setting",
    [CHECK_NEW] = "new",       [CHECK_GONE] = "gone", [CHECK_LEFT_OUT] = "left out",
};

size_t check_test_count(const Baseline *baseline)
{
    size_t count = 0;
    for (size_t i = 0; i < baseline->count; i++) {
        count += baseline->metrics[i].band_kind == BAND_STATISTICAL ? 1 : 0;
    }
    return count;
}

size_t check_row_max(const Baseline *baseline, const CheckEvidence *evidence)
{
    return baseline->setting_count + baseline->count + evidence->run->count;
}

bool check_row_is_out(const CheckRow *row)
{
    return row->verdict != CHECK_WITHIN && row->verdict != CHECK_LEFT_OUT;
}

static const char *check_judge_find_setting(const Baseline *baseline, const char *key)
{
    for (size_t i = 0; i < baseline->setting_count; i++) {
        if (strcmp(baseline->settings[i].key, key) == 0) {
            return baseline->settings[i].value;
        }
    }
    return NULL;
}

// A setting that is another now, or is not made use of any more. One that the baseline does not
// know is no difference by itself: a newer program may have more of them.
static void judge_setting(const BaselineSetting *was, const char *now, CheckRow *rows,
                          size_t *count)
{
    if (now != NULL && setting_agrees(was->value, now)) {
        return;
    }
    CheckRow *row = &rows[(*count)++];
    *row = (CheckRow){.verdict = CHECK_SETTING, .severity = INFINITY};
    text_copy(row->name, sizeof row->name, was->key);
    text_copy(row->was_text, sizeof row->was_text, was->value);
    text_copy(row->now_text, sizeof row->now_text, now != NULL ? now : "not used");
    snprintf(row->why, sizeof row->why, "a setting of the case, not a number measured");
}

static void judge_settings(const Baseline *baseline, const Baseline *now, CheckRow *rows,
                           size_t *count)
{
    for (size_t i = 0; i < baseline->setting_count; i++) {
        const BaselineSetting *setting = &baseline->settings[i];
        judge_setting(setting, check_judge_find_setting(now, setting->key), rows, count);
    }
}

static void leave_out(CheckRow *row, const char *why)
{
    row->verdict = CHECK_LEFT_OUT;
    row->severity = 0.0;
    snprintf(row->why, sizeof row->why, "%s", why);
}

static void judge_hash(const Baseline *baseline, const BaselineMetric *metric,
                       const CheckEvidence *evidence, uint64_t hash, CheckRow *row)
{
    row->hash_was = metric->hash;
    row->hash_now = hash;
    if (evidence->is_shaken || evidence->relative > 0.0) {
        leave_out(row, evidence->is_shaken ? "the inputs were shaken" : "numbers may move");
    } else if (strcmp(baseline->build, evidence->now->build) != 0) {
        leave_out(row, "of another build of the program");
    } else {
        row->verdict = metric->hash == hash ? CHECK_WITHIN : CHECK_OUT;
        row->severity = metric->hash == hash ? 0.0 : INFINITY;
    }
}

// The band of the baseline, or that of the user where it is wider.
static void widen(const BaselineMetric *metric, double relative, CheckRow *row)
{
    const double own = relative * fabs(metric->value);
    if (own > metric->band) {
        row->band = own;
        snprintf(row->why, sizeof row->why, "%g %% of it, by --rel", 100.0 * relative);
    }
}

static void judge_number(const BaselineMetric *metric, double relative, double now, CheckRow *row)
{
    row->now = now;
    row->deviation = now - metric->value;
    widen(metric, relative, row);
    const double size = fabs(row->deviation);
    row->verdict = size <= row->band ? CHECK_WITHIN : CHECK_OUT;
    row->severity = size == 0.0 ? 0.0 : row->band > 0.0 ? size / row->band : INFINITY;
}

static void judge_sample(const BaselineMetric *metric, size_t number, const CheckEvidence *evidence,
                         RankTest *test, CheckRow *row)
{
    double values[RANK_TEST_MAX];
    const size_t count = evidence->sample_count;
    assert(count > 0 && count <= RANK_TEST_MAX);
    for (size_t i = 0; i < count; i++) {
        const size_t index = baseline_find(&evidence->sample[i], metric->name, number);
        if (index == evidence->sample[i].count) {
            row->verdict = CHECK_GONE;
            row->severity = INFINITY;
            return;
        }
        values[i] = evidence->sample[i].metrics[index].value;
    }
    baseline_snap(metric, values, count);
    sorted_make(values, count);
    row->now = sorted_median(values, count);
    row->deviation = row->now - metric->value;
    row->p = rank_test_p(test, metric->sample, metric->sample_count, values, count);
    widen(metric, evidence->relative, row);
    const bool is_near = evidence->relative > 0.0 && fabs(row->deviation) <= row->band;
    row->verdict = row->p > evidence->rate || is_near ? CHECK_WITHIN : CHECK_OUT;
    row->severity = row->p > 0.0 ? log(row->p) / log(evidence->rate) : INFINITY;
}

static void judge_metric(const Baseline *baseline, size_t number, const CheckEvidence *evidence,
                         RankTest *test, CheckRow *row)
{
    const BaselineMetric *metric = &baseline->metrics[number];
    *row = (CheckRow){.kind = metric->kind,
                      .band_kind = metric->band_kind,
                      .was = metric->value,
                      .now = NAN,
                      .deviation = NAN,
                      .band = metric->band,
                      .p = NAN};
    text_copy(row->name, sizeof row->name, metric->name);
    text_copy(row->why, sizeof row->why, metric->why);
    const bool is_statistical = metric->band_kind == BAND_STATISTICAL;
    if (!evidence->is_full && (is_statistical || metric->is_slow)) {
        leave_out(row, is_statistical ? "statistical: for a full check" : "for a full check");
        return;
    }
    const size_t index = baseline_find(evidence->run, metric->name, number);
    if (index == evidence->run->count) {
        row->verdict = CHECK_GONE;
        row->severity = INFINITY;
    } else if ((metric->kind == CHECK_HASH) != (evidence->run->metrics[index].kind == CHECK_HASH)) {
        // one is a hash and the other a number: not the same measurement
        row->verdict = CHECK_GONE;
        row->severity = INFINITY;
    } else if (metric->kind == CHECK_HASH) {
        judge_hash(baseline, metric, evidence, evidence->run->metrics[index].hash, row);
    } else if (is_statistical) {
        judge_sample(metric, number, evidence, test, row);
    } else {
        judge_number(metric, evidence->relative, evidence->run->metrics[index].value, row);
    }
}

// What is measured, and stands in no baseline.
static void judge_new(const Baseline *baseline, const CheckMeasure *run, CheckRow *rows,
                      size_t *count)
{
    for (size_t i = 0; i < run->count; i++) {
        const CheckMetric *metric = &run->metrics[i];
        bool is_known = i < baseline->count && strcmp(baseline->metrics[i].name, metric->name) == 0;
        for (size_t k = 0; k < baseline->count && !is_known; k++) {
            is_known = strcmp(baseline->metrics[k].name, metric->name) == 0;
        }
        if (is_known) {
            continue;
        }
        CheckRow *row = &rows[(*count)++];
        *row = (CheckRow){.verdict = CHECK_NEW,
                          .kind = metric->kind,
                          .was = NAN,
                          .now = metric->value,
                          .deviation = NAN,
                          .band = NAN,
                          .p = NAN,
                          .hash_now = metric->hash,
                          .severity = INFINITY};
        text_copy(row->name, sizeof row->name, metric->name);
        snprintf(row->why, sizeof row->why, "the baseline does not have it; --bless adds it");
    }
}

// Settings first, then what is out, then what is within, each the worst first.
static int compare_rows(const void *a, const void *b)
{
    const CheckRow *left = a;
    const CheckRow *right = b;
    const int ranks[2] = {
        left->verdict == CHECK_SETTING ? 0
        : check_row_is_out(left)       ? 1
                                       : 2,
        right->verdict == CHECK_SETTING ? 0
        : check_row_is_out(right)       ? 1
                                        : 2,
    };
    if (ranks[0] != ranks[1]) {
        return ranks[0] - ranks[1];
    }
    if (left->severity != right->severity) {
        return left->severity < right->severity ? 1 : -1;
    }
    return strcmp(left->name, right->name);
}

size_t check_judge(const Baseline *baseline, const CheckEvidence *evidence, CheckRow *rows)
{
    size_t count = 0;
    RankTest test = {.count = 0};
    judge_settings(baseline, evidence->now, rows, &count);
    for (size_t i = 0; i < baseline->count; i++) {
        judge_metric(baseline, i, evidence, &test, &rows[count++]);
    }
    rank_test_finish(&test);
    judge_new(baseline, evidence->run, rows, &count);
    qsort(rows, count, sizeof *rows, compare_rows);
    return count;
}

// The limits that a case sets itself.

static CheckLimit check_judge_judge(const Expectation *expectation, const char *backend,
                                    double value)
{
    CheckLimit limit = {.expectation = expectation, .value = value};
    snprintf(limit.name, sizeof limit.name, "%s%s%s", backend, backend[0] != '\0' ? "." : "",
             expectation->path);
    limit.off = isfinite(value) ? expect_value_off(expectation, value) : NAN;
    limit.verdict = !isfinite(value) ? CHECK_GONE : limit.off == 0.0 ? CHECK_WITHIN : CHECK_OUT;
    return limit;
}

size_t check_limits_judge(const Scenario *scenario, const CheckMeasure *run, CheckLimit *limits)
{
    size_t count = 0;
    for (size_t i = 0; i < scenario->expectation_count; i++) {
        const Expectation *expectation = &scenario->expectations[i];
        if (expect_value_is_settled(expectation)) {
            const double value = expect_value_of_settled(expectation, scenario);
            limits[count++] = check_judge_judge(expectation, "", value);
            continue;
        }
        const size_t before = count;
        for (size_t k = 0; k < scenario->run.backend_count; k++) {
            const BackendKind backend = scenario->run.backends[k];
            if (expect_value_concerns(expectation, scenario, backend)) {
                limits[count++] = check_judge_judge(expectation, OPTIONS_BACKENDS[backend],
                                                    run->expected[i][backend]);
            }
        }
        if (count == before) {
            const bool is_named = expectation->backend != EXPECTATION_ANY_BACKEND;
            limits[count++] = check_judge_judge(
                expectation, is_named ? OPTIONS_BACKENDS[expectation->backend] : "", NAN);
        }
    }
    return count;
}

// The outcome that a case expects of its runs.
//
//     agrees      complete, error + uncertainty of the reference <= limit, no stated bound broken
//     reported    complete, error - uncertainty > limit: `jointplay run` prints that error
//     detected    stopped with a message after its first step, or short of its tolerance
//     refused     no step was taken; the message says why
//
// Anything else is WRONG: a complete run that is further off than its case says, a bound that does
// not hold, a message without the words expected, a process that died.

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
