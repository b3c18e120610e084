// How do the runs of a case end, on every backend and scheme that it names?
//
// The reference is made and certified first; then every run is one child process, which measures
// its own error against it. What happens to one run is no other's concern.
#include "commands/check/check_outcome_run.h"

#include "base/text.h"
#include "commands/check/expect_value.h"
#include "measure/backend_run.h"
#include "measure/pool.h"
#include "measure/task.h"
#include "measure/truth_child.h"

#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

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
    result->error = is_truth ? truth->uncertainty : NAN;
    if (!is_truth) {
        const double horizon_s = truth->is_limited ? truth->horizon_s : INFINITY;
        TrajectoryError error = error_against(run, truth->trajectory, horizon_s);
        if (error_fail_unstable(run, truth->trajectory, &error)) {
            return;
        }
        result->error = error.is_known ? error.max_in_horizon : NAN;
    }
    result->has_error = isfinite(result->error);
    if (run->error_estimate > 0.0) {
        result->bound = run->error_estimate;
        result->bound_error = error_against(run, truth->trajectory, run->estimate_s).max_in_horizon;
    }
}

// In a child process.
static void measure(const void *context, void *target)
{
    const Piece *piece = context;
    OutcomeRun *result = target;
    const ChosenWatch nobody = {.begin = NULL};
    Trajectory *run = backend_run(&piece->scenario, piece->backend, piece->truth, nobody, NULL);
    if (run->is_complete && piece->truth != NULL) {
        keep_error(piece, run, result);
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

static bool next(void *owner, size_t *number, const void **context)
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

static bool take(void *owner, size_t number, const void *result, const Child *child, Err *err)
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

static bool wait(void *owner)
{
    const Outcomes *all = owner;
    check_progress_show(all->work->progress,
                        &(CheckWorkState){.done = all->next, .total = all->count});
    return true;
}

static bool make_runs(Outcomes *all, Err *err)
{
    const Pool pool = {
        .jobs = all->work->jobs,
        .work = measure,
        .result_size = sizeof(OutcomeRun),
        .limits = {.time_s = all->work->time_limit_s, .memory_bytes = TASK_MEMORY_LIMIT},
        .next = next,
        .take = take,
        .wait = wait,
        .owner = all,
    };
    all->piece = malloc(sizeof *all->piece);
    assert(all->piece != NULL);
    const bool is_done = pool_run(&pool, err);
    free(all->piece);
    return is_done;
}

static void add(Outcomes *all, const ExpectedOutcome *expected, const char *name,
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
            add(all, expected, OPTIONS_BACKENDS[i], &scheme);
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
            add(all, expected, schemes[i].name, &schemes[i]);
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

static void wait_for_truth(const char *doing, void *context)
{
    (void)doing;
    check_progress_show(context, &(CheckWorkState){.total = 0});
}

// The truth that all errors are taken against; without one the reason is in the error.
static bool make_truth(const OutcomeWork *work, Truth *truth, Err *why)
{
    const TruthChild child = {.scenario = work->item->scenario,
                              .run_limit_s = work->time_limit_s,
                              .wait = wait_for_truth,
                              .context = work->progress};
    return truth_child_make(&child, truth, why);
}

static void judge(Outcomes *all, const Truth *truth, const Err *no_truth)
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
    add(all, &item->refusal, "case", &none);
    CheckOutcome *outcome = &all->outcomes[0];
    text_copy(outcome->run.message, sizeof outcome->run.message, item->refused.text);
    check_outcome_judge(outcome);
}

bool check_outcome_run(const OutcomeWork *work, CheckOutcome **outcomes, size_t *count, Err *err)
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
            all.truth = make_truth(work, &truth, &no_truth) ? &truth : NULL;
            is_done = make_runs(&all, err);
            judge(&all, &truth, &no_truth);
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
