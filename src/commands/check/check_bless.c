// How is a baseline made?
//
// truth, for the horizon -> the case's own start and 8 beside it, in full -> bands -> where one is
// statistical a sample of 32 starts -> the file. What the new one says of the old one is a check.
// Until then each measured start is kept in a file, so that an interrupted run can be resumed.
#include "base/clock.h"
#include "base/text.h"
#include "cli/interrupt.h"
#include "cli/output.h"
#include "cli/written.h"
#include "commands/check/baseline_json.h"
#include "commands/check/check_progress.h"
#include "commands/check/check_run.h"
#include "commands/check/check_store.h"
#include "commands/check/check_work.h"
#include "measure/truth_child.h"

#include <assert.h>
#include <stdio.h>
#include <stdlib.h>

// The measures of a baseline in the making.
typedef struct Making {
    const CheckItem *item;
    const CheckOptions *options;
    CheckProgress progress;
    CheckStore store;
    CheckPlan plan;
    char no_truth[CHECK_NOTE_SIZE]; // why there are no errors; empty where there are
    CheckMeasure *measures;         // the case's own, then the members of an ensemble
} Making;

static void wait_for_truth(const char *doing, void *context)
{
    (void)doing;
    Making *making = context;
    check_progress_show(&making->progress, &(CheckWorkState){.total = 0});
}

static bool should_stop(void *context)
{
    (void)context;
    return interrupt_number() != 0;
}

static bool wait(const CheckWorkState *state, void *context)
{
    Making *making = context;
    check_progress_show(&making->progress, state);
    return interrupt_number() == 0;
}

static bool keep(const CheckWork *work, void *context, Err *err)
{
    Making *making = context;
    return check_store_keep(&making->store, work, err);
}

// The plan that the truth gives. A mechanism that the reference cannot take has numbers all the
// same, and no errors. But where the old baseline has errors a missing reference is a failure: it
// would remove the most sensitive numbers.
static bool make_plan(Making *making, Err *err)
{
    Truth truth;
    const TruthChild work = {.scenario = making->item->scenario,
                             .run_limit_s = making->options->common.time_limit_s,
                             .wait = wait_for_truth,
                             .should_stop = should_stop,
                             .context = making};
    Err own = {0};
    const bool is_made = truth_child_make(&work, &truth, &own);
    making->plan = is_made ? check_plan(&truth) : (CheckPlan){.is_full = true};
    if (!making->plan.has_truth) {
        snprintf(making->no_truth, sizeof making->no_truth, "without errors: %.200s",
                 is_made ? truth.message : own.text);
    }
    truth_finish(&truth);
    if (should_stop(making)) {
        return err_set(err, ERR_SOLVER,
                       "stopped before its first start; nothing is kept, and the same "
                       "command begins anew");
    }
    const CheckItem *item = making->item;
    const bool had_truth = item->baseline_err.kind == ERR_NONE && item->baseline.plan.has_truth;
    if (!making->plan.has_truth && had_truth) {
        return err_set(err, ERR_SOLVER,
                       "the old baseline has numbers of errors, and now there is no reference for "
                       "them: %s; mend that (jointplay run shows it), or delete %s, and the new "
                       "one is made without errors",
                       making->no_truth, item->baseline_path);
    }
    return check_store_keep_plan(&making->store, &making->plan, making->no_truth, err);
}

static bool find_plan(Making *making, Err *err)
{
    return check_store_take_plan(&making->store, &making->plan, making->no_truth,
                                 sizeof making->no_truth) ||
           make_plan(making, err);
}

// Whether all works were measured; the error says which was not, and why.
static bool check_measures(const Making *making, const CheckWork *works, size_t count, Err *err)
{
    for (size_t i = 0; i < count; i++) {
        if (!works[i].is_over) {
            return err_set(err, ERR_SOLVER,
                           "stopped; %zu measured starts are kept in %s, and the same command "
                           "goes on from there",
                           check_store_count(&making->store), making->store.journal.path);
        }
        if (!works[i].measure->is_complete) {
            return err_set(err, ERR_SOLVER,
                           "no baseline of a run that fails: %s; change the case until jointplay "
                           "run completes it; one that is meant to end so states it under "
                           "expect: and needs no baseline",
                           works[i].measure->message);
        }
    }
    return true;
}

// Measures those starts that are not kept yet; the first of a list of works is the number of the
// member given.
static bool measure(Making *making, CheckStart (*start_of)(unsigned member), unsigned first,
                    size_t count, CheckMeasure *measures, Err *err)
{
    CheckWork *works = calloc(count, sizeof *works);
    assert(works != NULL);
    for (size_t i = 0; i < count; i++) {
        const unsigned member = first + (unsigned)i;
        works[i] = (CheckWork){.scenario = making->item->scenario, .plan = making->plan};
        works[i].start = member > 0 ? start_of(member) : (CheckStart){0, 0.0, 0};
        works[i].measure = &measures[i];
    }
    check_store_take(&making->store, works, count);
    const CheckWorkers workers = {making->options->common.jobs,
                                  making->options->common.time_limit_s, wait, keep, making};
    const bool is_done =
        check_work_do(&workers, works, count, err) && check_measures(making, works, count, err);
    free(works);
    return is_done;
}

// The baseline; `run` receives the case's own measure, the sample stays in the making.
static bool make_baseline(Making *making, Baseline *made, CheckMeasure *run, size_t *sample_count,
                          Err *err)
{
    CheckMeasure *measures = making->measures;
    *sample_count = 0;
    if (!find_plan(making, err) ||
        !measure(making, baseline_rounding_start, 0, 1 + BASELINE_MEMBERS, measures, err)) {
        return false;
    }
    *run = check_measure_copy(&measures[0]);
    baseline_set_head(made, making->item->scenario, &making->plan);
    text_copy(made->case_path, sizeof made->case_path, making->item->relative);
    if (!baseline_set_metrics(made, run, &measures[1], BASELINE_MEMBERS, err)) {
        return false;
    }
    const size_t tests = check_test_count(made);
    if (tests == 0) {
        return true;
    }
    *sample_count = BASELINE_SAMPLE_SIZE;
    return measure(making, baseline_sample_start, 1, BASELINE_SAMPLE_SIZE, measures, err) &&
           baseline_set_sample(made, measures, BASELINE_SAMPLE_SIZE,
                               CHECK_FALSE_ALARM_RATE / (double)tests, err);
}

// What the old baseline, which may be none, says of the new measures.
static void hold_against_old(const Making *making, const Baseline *made, const CheckMeasure *run,
                             size_t sample_count, CheckCase *result)
{
    const Baseline *old = &making->item->baseline;
    const size_t tests = check_test_count(old);
    const CheckEvidence evidence = {
        .run = run,
        .sample = making->measures,
        .sample_count = sample_count,
        .now = made,
        .is_full = tests == 0 || sample_count > 0,
        .rate = CHECK_FALSE_ALARM_RATE / (double)(tests > 0 ? tests : 1),
    };
    text_copy(result->note, sizeof result->note, making->no_truth);
    result->made_count = made->count;
    if (making->item->baseline_err.kind != ERR_NONE) {
        // one that cannot be read is replaced and reported
        result->change = making->item->is_there ? CHECK_CHANGE_UNREADABLE : CHECK_CHANGE_NEW;
        return;
    }
    CheckRow *rows = calloc(check_row_max(old, &evidence), sizeof *rows);
    assert(rows != NULL);
    result->row_count = check_judge(old, &evidence, rows);
    result->rows = rows;
    result->change = check_report_count(result).out > 0 ? CHECK_CHANGE_REPLACED : CHECK_CHANGE_NONE;
}

// Reports what was measured before.
static void say_taken(Making *making)
{
    const size_t kept = check_store_count(&making->store);
    written_damage(&making->store.journal, making->options->common.is_quiet);
    if (kept > 0 && !making->options->common.is_quiet) {
        output_say("%s: %zu measured starts are kept in %s: going on from there\n",
                   making->item->path, kept, making->store.journal.path);
    }
}

// Measures, judges against the old baseline and writes the new one.
static bool make_item(Making *making, CheckCase *result)
{
    Baseline made = {.settings = NULL};
    size_t sample_count;
    CheckMeasure run = {.is_complete = false};
    making->measures =
        calloc(1 + BASELINE_MEMBERS + BASELINE_SAMPLE_SIZE, sizeof *making->measures);
    assert(making->measures != NULL);
    const bool is_made = make_baseline(making, &made, &run, &sample_count, &result->err) &&
                         baseline_json_write(making->item->baseline_path, &made, &result->err);
    if (is_made) {
        hold_against_old(making, &made, &run, sample_count, result);
    }
    baseline_finish(&made);
    for (size_t i = 0; i < 1 + BASELINE_MEMBERS + BASELINE_SAMPLE_SIZE; i++) {
        check_measure_finish(&making->measures[i]);
    }
    free(making->measures);
    check_measure_finish(&run);
    return is_made;
}

static void bless_item(Making *making, CheckCase *result)
{
    const CheckItem *item = making->item;
    *result = (CheckCase){.path = item->path, .baseline = item->baseline_path, .err = item->err};
    if (item->err.kind != ERR_NONE) {
        return;
    }
    if (interrupt_number() != 0) {
        err_set(&result->err, ERR_SOLVER, "stopped before it began");
        return;
    }
    if (!check_store_open(&making->store, item, &result->err)) {
        return;
    }
    say_taken(making);
    const double started_s = clock_now_s();
    const bool is_made = make_item(making, result);
    result->wall_s = clock_now_s() - started_s;
    check_progress_end(&making->progress);
    // a file with nothing but a plan is not kept
    check_store_close(&making->store, !is_made && check_store_count(&making->store) > 0);
}

void check_run_bless(const CheckOptions *options, CheckItem *items, size_t count, CheckRun *run)
{
    *run = (CheckRun){.cases = calloc(count + 1, sizeof *run->cases)};
    assert(run->cases != NULL);
    interrupt_watch();
    // one for all cases, so that long work is warned of once
    CheckProgress progress = check_progress_start("", options->common.is_quiet);
    progress.case_count = count;
    for (size_t i = 0; i < count; i++) {
        progress.doing = items[i].path;
        progress.case_number = i + 1;
        Making making = {.item = &items[i], .options = options, .progress = progress};
        bless_item(&making, &run->cases[i]);
        progress = making.progress;
    }
    run->report = (CheckReport){.case_count = count,
                                .cases = run->cases,
                                .is_full = true,
                                .is_blessed = true,
                                .rate = CHECK_FALSE_ALARM_RATE};
}
