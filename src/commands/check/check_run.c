// What has become of the numbers of some cases?
#include "commands/check/check_run.h"

#include "base/clock.h"
#include "base/text.h"
#include "commands/check/check_outcome_run.h"
#include "commands/check/check_progress.h"
#include "commands/check/check_work.h"
#include "commands/check/expect_value.h"
#include "measure/truth_child.h"

#include <assert.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// The work of one item among that of all.
typedef struct Share {
    size_t first; // its own start; those of a sample follow
    size_t count;
} Share;

static bool has_slow_sample(const Baseline *baseline)
{
    for (size_t i = 0; i < baseline->count; i++) {
        const BaselineMetric *metric = &baseline->metrics[i];
        if (metric->is_slow && metric->band_kind == BAND_STATISTICAL) {
            return true;
        }
    }
    return false;
}

static void add_work(CheckWork *work, const CheckItem *item, CheckStart start, bool is_full,
                     size_t shake)
{
    *work = (CheckWork){.scenario = item->scenario, .plan = item->baseline.plan, .start = start};
    work->plan.is_full = is_full;
    work->start.shake = (unsigned)shake;
    work->measure = calloc(1, sizeof *work->measure);
    assert(work->measure != NULL);
}

// Whether anything is measured of a case: not of one that expects outcomes alone.
static bool needs_start(const CheckItem *item)
{
    return item->has_baseline || (item->scenario != NULL && item->scenario->expectation_count > 0);
}

// The starts of one item: its own, and in a full check those of a sample.
static Share plan_item(const CheckOptions *options, const CheckItem *item, CheckWork *works,
                       size_t first)
{
    Share share = {first, 0};
    if (item->err.kind != ERR_NONE || !needs_start(item)) {
        return share;
    }
    const CheckStart own = {0, 0.0, 0};
    const bool is_full = !options->is_quick && item->has_baseline;
    add_work(&works[first + share.count++], item, own, is_full, options->shake);
    if (!is_full || check_test_count(&item->baseline) == 0) {
        return share;
    }
    const bool is_slow = has_slow_sample(&item->baseline);
    for (unsigned i = 1; i <= BASELINE_SAMPLE_SIZE; i++) {
        // those of the baseline come before
        const CheckStart start = baseline_sample_start(BASELINE_SAMPLE_SIZE + i);
        add_work(&works[first + share.count++], item, start, is_slow, options->shake);
    }
    return share;
}

static void note_versions(const CheckItem *item, CheckCase *result)
{
    const Baseline *was = &item->baseline;
    const Baseline *now = &item->now;
    if (strcmp(was->ode, now->ode) != 0) {
        snprintf(result->note, sizeof result->note,
                 "the baseline was made with ODE %s, this program has ODE %s", was->ode, now->ode);
    }
}

// Why no baseline judges a case, and why an error could not be measured.
static void note_alone(const CheckOptions *options, const CheckItem *item, CheckCase *result)
{
    if (!options->is_expect_only && item->scenario->expectation_count > 0) {
        result->lacks_baseline = true;
        snprintf(result->note, sizeof result->note,
                 "there is no baseline %.150s: judged by its limits alone", item->baseline_path);
    }
    if (item->no_truth[0] != '\0') {
        text_copy(result->note, sizeof result->note, item->no_truth);
    }
}

static void judge_item(const CheckItem *item, const CheckEvidence *evidence, CheckCase *result)
{
    CheckRow *rows = calloc(check_row_max(&item->baseline, evidence), sizeof *rows);
    assert(rows != NULL);
    result->row_count = check_judge(&item->baseline, evidence, rows);
    result->rows = rows;
    note_versions(item, result);
}

// A start that failed is an error of the case.
static bool check_share(const CheckWork *works, Share share, Err *err)
{
    for (size_t i = share.first; i < share.first + share.count; i++) {
        const CheckMeasure *measure = works[i].measure;
        if (!measure->is_complete) {
            return err_set(err, ERR_SOLVER, "%s", measure->message);
        }
    }
    return true;
}

// Moves the measures of a sample side by side, as judges take them.
static CheckMeasure *gather(const CheckWork *works, Share share)
{
    CheckMeasure *sample = calloc(share.count, sizeof *sample);
    assert(sample != NULL);
    for (size_t i = 1; i < share.count; i++) {
        sample[i - 1] = *works[share.first + i].measure;
    }
    return sample;
}

static void finish_item(const CheckOptions *options, const CheckItem *item, const CheckWork *works,
                        Share share, const CheckReport *report, CheckCase *result)
{
    for (size_t i = share.first; i < share.first + share.count; i++) {
        result->wall_s += works[i].wall_s;
    }
    if (result->err.kind != ERR_NONE || share.count == 0 ||
        !check_share(works, share, &result->err)) {
        return;
    }
    CheckLimit *limits = calloc(CHECK_LIMIT_MAX, sizeof *limits);
    assert(limits != NULL);
    result->limit_count = check_limits_judge(item->scenario, works[share.first].measure, limits);
    result->limits = limits;
    if (!item->has_baseline) {
        note_alone(options, item, result);
        return;
    }
    CheckMeasure *sample = gather(works, share);
    const CheckEvidence evidence = {
        .run = works[share.first].measure,
        .sample = sample,
        .sample_count = share.count - 1,
        .now = &item->now,
        .is_full = !options->is_quick,
        .is_shaken = options->shake > 0,
        .rate = report->rate / (double)(report->test_count > 0 ? report->test_count : 1),
    };
    judge_item(item, &evidence, result);
    free(sample);
}

static void wait_for_truth(const char *doing, void *context)
{
    (void)doing;
    check_progress_show(context, &(CheckWorkState){.total = 0});
}

// A case without a baseline has no truth from there; where it limits an error it needs one.
static void find_plan(const CheckOptions *options, CheckProgress *progress, CheckItem *item)
{
    bool needs_truth = false;
    const size_t limits = item->scenario != NULL ? item->scenario->expectation_count : 0;
    for (size_t i = 0; item->err.kind == ERR_NONE && i < limits; i++) {
        needs_truth = needs_truth || expect_value_is_error(&item->scenario->expectations[i]);
    }
    if (item->has_baseline || !needs_truth) {
        return;
    }
    Truth truth;
    Err err = {0};
    const TruthChild work = {.scenario = item->scenario,
                             .run_limit_s = options->common.time_limit_s,
                             .wait = wait_for_truth,
                             .context = progress};
    if (truth_child_make(&work, &truth, &err)) {
        item->baseline.plan = check_plan(&truth);
    }
    if (!item->baseline.plan.has_truth) {
        snprintf(item->no_truth, sizeof item->no_truth, "errors are not measured: %.200s",
                 err.kind != ERR_NONE ? err.text : truth.message);
    }
    truth_finish(&truth);
}

static CheckRun begin(const CheckOptions *options, const CheckItem *items, size_t count)
{
    CheckRun run = {.cases = calloc(count + 1, sizeof *run.cases)};
    assert(run.cases != NULL);
    run.report = (CheckReport){.case_count = count,
                               .cases = run.cases,
                               .is_full = !options->is_quick,
                               .is_blessed = options->is_blessing,
                               .rate = CHECK_FALSE_ALARM_RATE};
    for (size_t i = 0; i < count; i++) {
        const bool is_tested = items[i].err.kind == ERR_NONE && !options->is_quick;
        run.report.test_count += is_tested ? check_test_count(&items[i].baseline) : 0;
    }
    return run;
}

static void begin_case(const CheckItem *item, CheckCase *result)
{
    *result = (CheckCase){.path = item->path,
                          .baseline = item->has_baseline ? item->baseline_path : "",
                          .title = item->scenario != NULL ? item->scenario->title : item->title,
                          .err = item->err};
}

// Makes the runs whose end each case expects.
static void find_outcomes(const CheckOptions *options, CheckItem *items, size_t count,
                          CheckProgress *progress, CheckRun *run)
{
    for (size_t i = 0; i < count; i++) {
        CheckCase *result = &run->cases[i];
        CheckOutcome *outcomes = NULL;
        const double started_s = clock_now_s();
        const OutcomeWork work = {&items[i], options->common.jobs, options->common.time_limit_s,
                                  progress};
        progress->case_number = i + 1;
        progress->case_count = count;
        if (result->err.kind != ERR_NONE ||
            !check_outcome_run(&work, &outcomes, &result->outcome_count, &result->err)) {
            continue;
        }
        result->outcomes = outcomes;
        result->wall_s += result->outcome_count > 0 ? clock_now_s() - started_s : 0.0;
    }
    progress->case_count = 0;
}

static bool wait(const CheckWorkState *state, void *context)
{
    check_progress_show(context, state);
    return true;
}

bool check_run_execute(const CheckOptions *options, CheckItem *items, size_t count, CheckRun *run,
                       Err *err)
{
    *run = begin(options, items, count);
    CheckWork *works = calloc(count * (1 + BASELINE_SAMPLE_SIZE) + 1, sizeof *works);
    Share *shares = calloc(count + 1, sizeof *shares);
    assert(works != NULL && shares != NULL);
    size_t total = 0;
    CheckProgress progress = check_progress_start("checking", options->common.is_quiet);
    for (size_t i = 0; i < count; i++) {
        begin_case(&items[i], &run->cases[i]);
    }
    find_outcomes(options, items, count, &progress, run);
    for (size_t i = 0; i < count; i++) {
        find_plan(options, &progress, &items[i]);
        shares[i] = plan_item(options, &items[i], works, total);
        total += shares[i].count;
    }
    const CheckWorkers workers = {options->common.jobs, options->common.time_limit_s, wait, NULL,
                                  &progress};
    const bool is_done = check_work_do(&workers, works, total, err);
    check_progress_end(&progress);
    for (size_t i = 0; is_done && i < count; i++) {
        finish_item(options, &items[i], works, shares[i], &run->report, &run->cases[i]);
    }
    for (size_t i = 0; i < total; i++) {
        check_measure_finish(works[i].measure);
        free(works[i].measure);
    }
    free(shares);
    free(works);
    return is_done;
}

void check_run_finish(CheckRun *run)
{
    for (size_t i = 0; run->cases != NULL && i < run->report.case_count; i++) {
        free((CheckRow *)run->cases[i].rows);
        free((CheckLimit *)run->cases[i].limits);
        free((CheckOutcome *)run->cases[i].outcomes);
    }
    free(run->cases);
    *run = (CheckRun){.cases = NULL};
}
