// Runs the cases of a check and judges them.
#include "commands/check/check_run.h"
#include "base/clock.h"
#include "base/text.h"
#include "commands/check/check_measure.h"
#include "commands/check/check_work.h"
#include "measure/child.h"
#include "measure/chosen_run.h"
#include "measure/task.h"

#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// The runs whose outcome a case expects.
//
// The reference is made and certified first; then every run is one child process, which measures
// its own error against it. What happens to one run is no other's concern.

// A run to be made.
typedef struct Piece {
    Scenario scenario; // with its scheme
    BackendKind backend;
    const Truth *truth; // NULL where there is none
} Piece;

// The runs of one case.
typedef struct Outcomes {
    const OutcomeWork *work;
    const Truth *truth; // NULL where there is none
    CheckOutcome *outcomes;
    Scheme *schemes; // by outcome: those of a backend as the case has it hold but the backend
    size_t count;
    size_t next;
    Piece *piece; // about to begin
} Outcomes;

static void keep_error(const Piece *piece, Trajectory *run, OutcomeRun *result)
{
    const Truth *truth = piece->truth;
    const bool is_truth = piece->backend == truth_backend(&piece->scenario);
    const ToleranceOf kind = piece->scenario.run.tolerance_of;
    result->error = is_truth ? truth->uncertainty : NAN;
    if (!is_truth) {
        const double horizon_s = truth->is_limited ? truth->horizon_s : INFINITY;
        TrajectoryError error = error_against(run, truth->trajectory, horizon_s);
        if (error_fail_unstable(run, truth->trajectory, &error)) {
            return;
        }
        result->error = error.is_known ? error_of_kind(&error, kind, true) : NAN;
    }
    result->has_error = isfinite(result->error);
    if (run->error_estimate > 0.0) {
        result->bound = run->error_estimate;
        const TrajectoryError until = error_against(run, truth->trajectory, run->estimate_s);
        result->bound_error = error_of_kind(&until, kind, true);
    }
}

// In a child process.
static void check_run_measure(const void *context, void *target)
{
    const Piece *piece = context;
    OutcomeRun *result = target;
    const ChosenWatch nobody = {.begin = NULL};
    Trajectory *run = backend_run(&piece->scenario, piece->backend, piece->truth, nobody,
                                  backend_run_probe(&piece->scenario));
    if (run->is_complete && piece->truth != NULL) {
        keep_error(piece, run, result);
    } else {
        error_fail_runaway(&piece->scenario, run);
    }
    result->is_complete = run->is_complete;
    result->is_short = run->is_complete && run->is_short;
    result->step_s = run->step_s;
    result->steps = run->steps;
    result->wall_s = run->wall_s;
    text_copy(result->message, sizeof result->message, run->message);
    if (result->is_short) {
        snprintf(result->message, sizeof result->message,
                 "the tolerance %.3g holds up to %.4g s of %.4g s only",
                 piece->scenario.run.tolerance, run->estimate_s, run->duration_s);
    }
    trajectory_destroy(run);
}

static bool check_run_next(void *owner, size_t *number, const void **context)
{
    Outcomes *all = owner;
    if (all->next == all->count) {
        return false;
    }
    *number = all->next++;
    const Scheme *scheme = &all->schemes[*number];
    *all->piece = (Piece){*all->work->item->scenario, scheme->backend, all->truth};
    if (scheme->name[0] != '\0') {
        scheme_apply(scheme, all->piece->scenario.run.step, &all->piece->scenario);
    }
    *context = all->piece;
    return true;
}

static bool check_run_take(void *owner, size_t number, const void *result, const Child *child,
                           Err *err)
{
    (void)err;
    CheckOutcome *outcome = &((Outcomes *)owner)->outcomes[number];
    if (child->end == CHILD_DONE) {
        outcome->run = *(const OutcomeRun *)result;
    } else {
        char words[CHILD_TEXT_SIZE];
        child_describe(child, words);
        outcome->run = (OutcomeRun){.is_lost = true};
        snprintf(outcome->run.message, sizeof outcome->run.message, "its process %s", words);
    }
    return true;
}

static bool check_outcome_run_wait(void *owner)
{
    const Outcomes *all = owner;
    check_progress_show(all->work->progress,
                        &(CheckWorkState){.done = all->next, .total = all->count});
    return true;
}

static bool check_run_make_runs(Outcomes *all, Err *err)
{
    const Pool pool = {
        .jobs = all->work->jobs,
        .work = check_run_measure,
        .result_size = sizeof(OutcomeRun),
        .takes_no_memory = true,
        .limits = {.time_s = all->work->time_limit_s, .memory_bytes = TASK_MEMORY_LIMIT},
        .next = check_run_next,
        .take = check_run_take,
        .wait = check_outcome_run_wait,
        .owner = all,
    };
    all->piece = malloc(sizeof *all->piece);
    assert(all->piece != NULL);
    const bool is_done = pool_run(&pool, err);
    free(all->piece);
    return is_done;
}

static void check_run_add(Outcomes *all, const ExpectedOutcome *expected, const char *name,
                          const Scheme *scheme)
{
    all->outcomes = realloc(all->outcomes, (all->count + 1) * sizeof *all->outcomes);
    all->schemes = realloc(all->schemes, (all->count + 1) * sizeof *all->schemes);
    assert(all->outcomes != NULL && all->schemes != NULL);
    CheckOutcome *outcome = &all->outcomes[all->count];
    *outcome = (CheckOutcome){.expected = expected, .uncertainty = INFINITY};
    text_copy(outcome->name, sizeof outcome->name, name);
    all->schemes[all->count++] = *scheme;
}

// A backend as the case uses it.
static bool add_backends(Outcomes *all, const ExpectedOutcome *expected)
{
    const Scenario *scenario = all->work->item->scenario;
    bool is_backend = expected->of[0] == '\0';
    for (int i = 0; i < BACKEND_COUNT; i++) {
        const Scheme scheme = {.backend = (BackendKind)i};
        const bool is_named = strcmp(expected->of, OPTIONS_BACKENDS[i]) == 0;
        bool is_run = false;
        for (size_t k = 0; k < scenario->run.backend_count; k++) {
            const bool is_it = scenario->run.backends[k] == scheme.backend;
            const bool feels_play =
                OPTIONS_BACKEND_HAS_PLAY[i] || !scenario_has_clearance(scenario);
            is_run = is_run || (is_it && feels_play && expected->of[0] == '\0');
        }
        if (is_named || is_run) {
            check_run_add(all, expected, OPTIONS_BACKENDS[i], &scheme);
        }
        is_backend = is_backend || is_named;
    }
    return is_backend;
}

static bool add_schemes(Outcomes *all, const ExpectedOutcome *expected, Err *err)
{
    const CheckItem *item = all->work->item;
    Scheme *schemes = calloc(SCHEME_MAX, sizeof *schemes);
    assert(schemes != NULL);
    size_t count = scheme_list(item->scenario, schemes);
    Err wrong = {0};
    bool is_good = scheme_filter(expected->of, schemes, &count, &wrong) ||
                   err_set(err, ERR_CASE, "%s: expect: %s", item->path, wrong.text);
    for (size_t i = 0; is_good && i < count; i++) {
        if (schemes[i].backend != BACKEND_ODE) {
            continue;
        }
        if (scheme_has_step(&schemes[i]) && item->scenario->run.step == 0.0) {
            is_good = err_set(err, ERR_CASE,
                              "%s: the outcome of %s needs a step, and run.step is auto\n"
                              "allowed: a time, such as run.step: 1 us",
                              item->path, schemes[i].name);
        } else {
            check_run_add(all, expected, schemes[i].name, &schemes[i]);
        }
    }
    free(schemes);
    return is_good;
}

static bool list_runs(Outcomes *all, Err *err)
{
    const Scenario *scenario = all->work->item->scenario;
    for (size_t i = 0; i < scenario->outcome_count; i++) {
        const ExpectedOutcome *expected = &scenario->outcomes[i];
        if (!add_backends(all, expected) && !add_schemes(all, expected, err)) {
            return false;
        }
    }
    return true;
}

static void check_outcome_run_wait_for_truth(const char *doing, void *context)
{
    (void)doing;
    check_progress_show(context, &(CheckWorkState){.total = 0});
}

// The truth that all errors are taken against; without one the reason is in the error.
static bool check_run_make_truth(const OutcomeWork *work, Truth *truth, Err *why)
{
    const TruthChild child = {.scenario = work->item->scenario,
                              .run_limit_s = work->time_limit_s,
                              .wait = check_outcome_run_wait_for_truth,
                              .context = work->progress};
    return truth_child_make(&child, truth, why);
}

static void check_run_judge(Outcomes *all, const Truth *truth, const Err *no_truth)
{
    const double duration_s = scenario_duration(all->work->item->scenario);
    for (size_t i = 0; i < all->count; i++) {
        CheckOutcome *outcome = &all->outcomes[i];
        if (all->truth != NULL) {
            outcome->uncertainty = truth->uncertainty;
            outcome->horizon_s = truth->is_limited ? truth->horizon_s : duration_s;
            outcome->share = outcome->horizon_s / duration_s;
        }
        OutcomeRun *run = &outcome->run;
        const char *why = all->truth == NULL ? no_truth->text : truth->message;
        if (run->is_complete && !run->has_error && run->message[0] == '\0') {
            text_copy(run->message, sizeof run->message, why);
        }
        check_outcome_judge(outcome);
    }
}

// The file itself was refused: its error is the outcome.
static void add_refusal(Outcomes *all)
{
    const CheckItem *item = all->work->item;
    const Scheme none = {.backend = BACKEND_ODE};
    check_run_add(all, &item->refusal, "case", &none);
    CheckOutcome *outcome = &all->outcomes[0];
    text_copy(outcome->run.message, sizeof outcome->run.message, item->refused.text);
    check_outcome_judge(outcome);
}

// Makes and judges all runs that the item's case expects an outcome of, each in a child process:
// *outcomes is then theirs, owned by the caller, and *count how many there are; NULL and 0 where
// the case expects none. Fails with ERR_CASE where an outcome names a scheme that the case does not
// have, and with ERR_SOLVER where the system has no process left.
static bool check_outcome_run(const OutcomeWork *work, CheckOutcome **outcomes, size_t *count,
                              Err *err)
{
    Outcomes all = {.work = work};
    Truth truth = {.trajectory = NULL};
    Err no_truth = {0};
    bool is_done = true;
    if (work->item->is_refused) {
        add_refusal(&all);
    } else if (work->item->scenario != NULL && work->item->scenario->outcome_count > 0) {
        is_done = list_runs(&all, err);
        if (is_done) {
            all.truth = check_run_make_truth(work, &truth, &no_truth) ? &truth : NULL;
            is_done = check_run_make_runs(&all, err);
            check_run_judge(&all, &truth, &no_truth);
        }
    }
    truth_finish(&truth);
    free(all.schemes);
    if (!is_done) {
        free(all.outcomes);
        all = (Outcomes){.outcomes = NULL};
    }
    *outcomes = all.outcomes;
    *count = all.count;
    return is_done;
}

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
static CheckMeasure *check_run_gather(const CheckWork *works, Share share)
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
    CheckMeasure *sample = check_run_gather(works, share);
    const CheckEvidence evidence = {
        .run = works[share.first].measure,
        .sample = sample,
        .sample_count = share.count - 1,
        .now = &item->now,
        .is_full = !options->is_quick,
        .is_shaken = options->shake > 0,
        .relative = options->relative,
        .rate = report->rate / (double)(report->test_count > 0 ? report->test_count : 1),
    };
    judge_item(item, &evidence, result);
    free(sample);
}

static void check_run_wait_for_truth(const char *doing, void *context)
{
    (void)doing;
    check_progress_show(context, &(CheckWorkState){.total = 0});
}

// A case without a baseline has no truth from there; where it limits an error it needs one.
static void check_run_find_plan(const CheckOptions *options, CheckProgress *progress,
                                CheckItem *item)
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
                             .wait = check_run_wait_for_truth,
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

static CheckRun check_run_begin(const CheckOptions *options, const CheckItem *items, size_t count)
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

static bool check_run_wait(const CheckWorkState *state, void *context)
{
    check_progress_show(context, state);
    return true;
}

bool check_run_execute(const CheckOptions *options, CheckItem *items, size_t count, CheckRun *run,
                       Err *err)
{
    *run = check_run_begin(options, items, count);
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
        check_run_find_plan(options, &progress, &items[i]);
        shares[i] = plan_item(options, &items[i], works, total);
        total += shares[i].count;
    }
    const CheckWorkers workers = {options->common.jobs, options->common.time_limit_s,
                                  check_run_wait, NULL, &progress};
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
