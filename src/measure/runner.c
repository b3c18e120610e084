// In which order, and how many at a time, are the runs of a ladder made?
//
// truth -> error runs -> timing runs, one at a time, round by round -> ensembles. What a ladder
// already holds is not made again; the truth's trajectory is, where an error run still needs it.
#include "measure/runner.h"

#include "base/clock.h"
#include "measure/child.h"
#include "measure/task.h"
#include "measure/truth_child.h"

#include <assert.h>
#include <stdio.h>
#include <stdlib.h>

static const double PAUSE_S = 0.2; // between two looks of the listener
// One child at work.
typedef struct Job {
    bool is_busy;
    size_t number; // of the run, or of the scheme
    Task task;
    union {
        LadderRun run;
        Ensemble ensemble;
    } result;
} Job;

// A kind of work, of which several may go on at a time.
typedef struct Work {
    const char *doing;
    size_t jobs;
    size_t runs; // that one job makes, each of which may take the whole time limit
    size_t end;  // number behind the last
    size_t (*next)(const Runner *runner, size_t from); // number that is to be done
    Task (*make)(const Runner *runner, size_t number, const Truth *truth);
    ChildWork work;
    size_t result_size;
    bool (*finish)(const Runner *runner, Job *job, const Child *child, Err *err);
} Work;

static ChildLimits limits_of(const Runner *runner, size_t runs)
{
    return (ChildLimits){.time_s = (double)runs * runner->time_limit_s,
                         .memory_bytes = TASK_MEMORY_LIMIT};
}

static bool start_job(const Runner *runner, const Work *work, size_t number, const Truth *truth,
                      Job *job, Child *child, Err *err)
{
    job->number = number;
    job->task = work->make(runner, number, truth);
    job->is_busy = child_start(child, work->work, &job->task, &job->result, work->result_size,
                               limits_of(runner, work->runs), err);
    return job->is_busy;
}

// Fills the free places, waits, and takes in what has ended. False where something cannot go on.
static bool turn(const Runner *runner, const Work *work, const Truth *truth, Job *jobs,
                 Child *children, size_t *number, size_t *busy, Err *err)
{
    for (size_t i = 0; i < work->jobs && *number < work->end; i++) {
        if (!jobs[i].is_busy) {
            if (!start_job(runner, work, *number, truth, &jobs[i], &children[i], err)) {
                return false;
            }
            (*busy)++;
            *number = work->next(runner, *number + 1);
        }
    }
    runner->listener.wait(work->doing, runner->listener.context);
    child_wait(children, work->jobs, PAUSE_S);
    for (size_t i = 0; i < work->jobs; i++) {
        if (jobs[i].is_busy && children[i].end != CHILD_RUNNING) {
            jobs[i].is_busy = false;
            (*busy)--;
            if (!work->finish(runner, &jobs[i], &children[i], err)) {
                return false;
            }
        }
    }
    return true;
}

static bool do_work(const Runner *runner, const Work *work, const Truth *truth, Err *err)
{
    Job *jobs = calloc(work->jobs, sizeof *jobs);
    Child *children = calloc(work->jobs, sizeof *children);
    assert(jobs != NULL && children != NULL);
    size_t number = work->next(runner, 0);
    size_t busy = 0;
    bool is_going = true;
    while (is_going && (busy > 0 || number < work->end)) {
        is_going = turn(runner, work, truth, jobs, children, &number, &busy, err);
    }
    for (size_t i = 0; i < work->jobs; i++) {
        child_kill(&children[i]);
    }
    free(jobs);
    free(children);
    return is_going;
}

static size_t next_run(const Runner *runner, size_t from)
{
    return ladder_next(runner->ladder, from);
}

static Task make_run(const Runner *runner, size_t number, const Truth *truth)
{
    return task_make(runner->ladder, runner->scenario, ladder_run(runner->ladder, number), truth);
}

static bool finish_run(const Runner *runner, Job *job, const Child *child, Err *err)
{
    LadderRun *run = &job->result.run;
    if (child->end != CHILD_DONE) {
        char words[CHILD_TEXT_SIZE];
        child_describe(child, words);
        *run = ladder_run(runner->ladder, job->number);
        run->is_lost = true;
        snprintf(run->message, sizeof run->message, "the run's process %s", words);
    }
    const bool is_new = ladder_add(runner->ladder, run);
    assert(is_new);
    return runner->listener.keep_run(run, runner->listener.context, err);
}

// Ensembles belong to the reference and to ODE's schemes that have a point.
static size_t next_ensemble(const Runner *runner, size_t from)
{
    const Ladder *ladder = runner->ladder;
    while (from < ladder->scheme_count && (ladder->ensembles[from].is_known ||
                                           ladder_finest(ladder, from) == ladder->point_count)) {
        from++;
    }
    return from;
}

static Task make_ensemble(const Runner *runner, size_t number, const Truth *truth)
{
    const LadderRun run = {.point = ladder_finest(runner->ladder, number)};
    return task_make(runner->ladder, runner->scenario, run, truth);
}

static bool finish_ensemble(const Runner *runner, Job *job, const Child *child, Err *err)
{
    LadderEnsemble *ensemble = &runner->ladder->ensembles[job->number];
    const size_t point = ladder_finest(runner->ladder, job->number);
    *ensemble = (LadderEnsemble){.is_known = true, .step_s = runner->ladder->points[point].step_s};
    if (child->end == CHILD_DONE) {
        ensemble->ensemble = job->result.ensemble;
    } else {
        ensemble->ensemble.failed = ENSEMBLE_MEMBERS;
        child_describe(child, ensemble->ensemble.message);
    }
    return runner->listener.keep_ensemble(job->number, ensemble, runner->listener.context, err);
}

static bool make_truth(const Runner *runner, Truth *truth, Err *err)
{
    const double started_s = clock_now_s();
    const TruthChild work = {
        .scenario = runner->scenario,
        .run_limit_s = runner->time_limit_s,
        .wait = runner->listener.wait,
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

// Errors are taken against the truth, and steps that are chosen are chosen by it, whatever is then
// measured of them.
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
    const Work errors = {"error runs",        runner->jobs,      1,
                         ladder->point_count, next_run,          make_run,
                         task_measure,        sizeof(LadderRun), finish_run};
    const Work timings = {
        "timing runs",     1,         1, ladder_run_total(ladder), next_run, make_run, task_measure,
        sizeof(LadderRun), finish_run};
    const Work ensembles = {"ensembles",          runner->jobs,     ENSEMBLE_MEMBERS,
                            ladder->scheme_count, next_ensemble,    make_ensemble,
                            task_spread,          sizeof(Ensemble), finish_ensemble};
    Truth truth = {0};
    const bool is_done = (!needs_truth(runner) || make_truth(runner, &truth, err)) &&
                         do_work(runner, &errors, &truth, err) &&
                         do_work(runner, &timings, &truth, err) &&
                         (!ladder->truth.is_limited || do_work(runner, &ensembles, &truth, err));
    truth_finish(&truth);
    return is_done;
}
