// Makes the runs of a ladder in their order, each in a child process.
//
// truth -> error runs -> timing runs, one at a time, round by round -> ensembles. What a ladder
// already holds is not made again; the truth's trajectory is, where an error run still needs it.
#include "measure/runner.h"
#include "base/clock.h"
#include "measure/child.h"
#include "measure/task.h"

#include <assert.h>

// Runs of one kind, or ensembles, that are being made.
typedef struct Stage {
    const Runner *runner;
    const Truth *truth;
    const char *doing;
    size_t from; // number of the run, or of the scheme, from which on to look for the next
    size_t end;  // number behind the last
    Task task;   // that is about to begin
} Stage;

static bool is_stopped(const Runner *runner)
{
    const RunnerListener *listener = &runner->listener;
    return listener->should_stop != NULL && listener->should_stop(listener->context);
}

static bool runner_wait(void *owner)
{
    const Stage *stage = owner;
    const RunnerListener *listener = &stage->runner->listener;
    listener->wait(stage->doing, listener->context);
    return !is_stopped(stage->runner);
}

// Runs a pool; one that is stopped leaves what it was for undone.
static bool run_pool(const Runner *runner, const Pool *pool, Err *err)
{
    return pool_run(pool, err) && (!is_stopped(runner) || err_set(err, ERR_SOLVER, "stopped"));
}

static bool next_run(void *owner, size_t *number, const void **context)
{
    Stage *stage = owner;
    const Ladder *ladder = stage->runner->ladder;
    *number = ladder_next(ladder, stage->from);
    if (*number >= stage->end) {
        return false;
    }
    stage->from = *number + 1;
    stage->task =
        task_make(ladder, stage->runner->scenario, ladder_run(ladder, *number), stage->truth);
    *context = &stage->task;
    return true;
}

static bool runner_take_run(void *owner, size_t number, const void *result, const Child *child,
                            Err *err)
{
    const Runner *runner = ((Stage *)owner)->runner;
    const LadderRun run = task_run(ladder_run(runner->ladder, number), result, child);
    const bool is_new = ladder_add(runner->ladder, &run);
    assert(is_new);
    return runner->listener.keep_run(&run, runner->listener.context, err);
}

// Ensembles belong to the reference and to ODE's schemes that have a point. Other engines have
// none: what happens between samples is not known of them.
static bool next_ensemble(void *owner, size_t *number, const void **context)
{
    Stage *stage = owner;
    const Ladder *ladder = stage->runner->ladder;
    while (stage->from < stage->end &&
           (ladder->ensembles[stage->from].is_known ||
            ladder->schemes[stage->from].driver != NULL ||
            ladder_finest(ladder, stage->from) == ladder->point_count)) {
        stage->from++;
    }
    if (stage->from == stage->end) {
        return false;
    }
    *number = stage->from++;
    const LadderRun run = {.point = ladder_finest(ladder, *number)};
    stage->task = task_make(ladder, stage->runner->scenario, run, stage->truth);
    *context = &stage->task;
    return true;
}

static bool runner_take_ensemble(void *owner, size_t number, const void *result, const Child *child,
                                 Err *err)
{
    const Runner *runner = ((Stage *)owner)->runner;
    LadderEnsemble *ensemble = &runner->ladder->ensembles[number];
    const size_t point = ladder_finest(runner->ladder, number);
    *ensemble = (LadderEnsemble){.is_known = true, .step_s = runner->ladder->points[point].step_s};
    if (child->end == CHILD_DONE) {
        ensemble->ensemble = *(const Ensemble *)result;
    } else {
        ensemble->ensemble.failed = ENSEMBLE_MEMBERS;
        child_describe(child, ensemble->ensemble.message);
    }
    return runner->listener.keep_ensemble(number, ensemble, runner->listener.context, err);
}

static bool runner_make_runs(const Runner *runner, const Truth *truth, const char *doing,
                             size_t jobs, size_t end, Err *err)
{
    Stage stage = {.runner = runner, .truth = truth, .doing = doing, .end = end};
    const Pool pool = {
        .jobs = jobs,
        .work = task_measure,
        .result_size = sizeof(LadderRun),
        .limits = {.time_s = runner->time_limit_s, .memory_bytes = TASK_MEMORY_LIMIT},
        .next = next_run,
        .take = runner_take_run,
        .wait = runner_wait,
        .owner = &stage,
    };
    return run_pool(runner, &pool, err);
}

static bool make_ensembles(const Runner *runner, const Truth *truth, Err *err)
{
    Stage stage = {.runner = runner,
                   .truth = truth,
                   .doing = "ensembles",
                   .end = runner->ladder->scheme_count};
    const Pool pool = {
        .jobs = runner->jobs,
        .work = task_spread,
        .result_size = sizeof(Ensemble),
        .limits = {.time_s = ENSEMBLE_MEMBERS * runner->time_limit_s,
                   .memory_bytes = TASK_MEMORY_LIMIT},
        .next = next_ensemble,
        .take = runner_take_ensemble,
        .wait = runner_wait,
        .owner = &stage,
    };
    return run_pool(runner, &pool, err);
}

static bool runner_make_truth(const Runner *runner, Truth *truth, Err *err)
{
    const double started_s = clock_now_s();
    const TruthChild work = {
        .scenario = runner->scenario,
        .run_limit_s = runner->time_limit_s,
        .wait = runner->listener.wait,
        .should_stop = runner->listener.should_stop,
        .context = runner->listener.context,
    };
    if (!truth_child_make(&work, truth, err)) {
        return false;
    }
    LadderTruth *known = &runner->ladder->truth;
    if (known->is_known) {
        return true;
    }
    *known = ladder_truth_of(truth, clock_now_s() - started_s);
    return runner->listener.keep_truth(known, runner->listener.context, err);
}

// Errors are taken against the truth, and steps are chosen by it.
static bool needs_truth(const Runner *runner)
{
    const Ladder *ladder = runner->ladder;
    const size_t total = ladder_run_total(ladder);
    for (size_t i = ladder_next(ladder, 0); i < total; i = ladder_next(ladder, i + 1)) {
        const LadderRun run = ladder_run(ladder, i);
        const Scheme *scheme = &ladder->schemes[ladder->points[run.point].scheme];
        if (run.kind == LADDER_ERROR || scheme_is_chosen(scheme)) {
            return true;
        }
    }
    return !ladder->truth.is_known;
}

bool runner_execute(const Runner *runner, Err *err)
{
    const Ladder *ladder = runner->ladder;
    const size_t total = ladder_run_total(ladder);
    Truth truth = {0};
    const bool is_done =
        (!needs_truth(runner) || runner_make_truth(runner, &truth, err)) &&
        runner_make_runs(runner, &truth, "error runs", runner->jobs, ladder->point_count, err) &&
        runner_make_runs(runner, &truth, "timing runs", 1, total, err) &&
        (!ladder->truth.is_limited || make_ensembles(runner, &truth, err));
    truth_finish(&truth);
    return is_done;
}
