// How are the runs of a search made?
#include "commands/tune/tune_runs.h"

#include "base/clock.h"
#include "measure/pool.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>

typedef struct Making {
    const TuneSearch *search;
    const TuneRuns *runs;
    size_t begun;
    size_t taken;
    double started_s; // by the clock
    Task task;        // that is about to begin
} Making;

static bool next(void *owner, size_t *number, const void **context)
{
    Making *making = owner;
    const TuneRuns *runs = making->runs;
    if (runs->choose != NULL ? !runs->choose(runs->owner, number) : making->begun == runs->count) {
        return false;
    }
    *number = runs->choose != NULL ? *number : making->begun;
    making->begun++;
    making->task = (Task){.scenario = *making->search->scenario,
                          .backend = runs->is_reference ? BACKEND_REFERENCE : BACKEND_ODE,
                          .run.kind = runs->is_timing ? LADDER_TIMING : LADDER_ERROR,
                          .truth = making->search->truth};
    runs->apply(runs->owner, *number, &making->task.scenario);
    *context = &making->task;
    return true;
}

static bool take(void *owner, size_t number, const void *result, const Child *child, Err *err)
{
    (void)err;
    Making *making = owner;
    making->taken++;
    const TuneRuns *runs = making->runs;
    const LadderRun asked = {.kind = runs->is_timing ? LADDER_TIMING : LADDER_ERROR};
    const LadderRun run = task_run(asked, result, child);
    runs->take(runs->owner, number, &run);
    return true;
}

// Of runs with a count from those of them that are over.
static double time_left(const Making *making)
{
    const TuneRuns *runs = making->runs;
    if (runs->choose != NULL) {
        return runs->left != NULL ? runs->left(runs->owner) / (double)making->search->jobs
                                  : INFINITY;
    }
    if (making->taken == 0) {
        return INFINITY;
    }
    return (clock_now_s() - making->started_s) * (double)(runs->count - making->taken) /
           (double)making->taken;
}

static bool wait(void *owner)
{
    const Making *making = owner;
    making->search->wait(making->runs->doing, time_left(making), making->search->context);
    return true;
}

bool tune_runs_make(const TuneSearch *search, const TuneRuns *runs, Err *err)
{
    Making *making = calloc(1, sizeof *making);
    assert(making != NULL);
    *making = (Making){.search = search, .runs = runs, .started_s = clock_now_s()};
    const Pool pool = {
        .jobs = runs->is_timing ? 1 : search->jobs,
        .work = task_measure,
        .result_size = sizeof(LadderRun),
        .limits = {.time_s = search->time_limit_s, .memory_bytes = TASK_MEMORY_LIMIT},
        .next = next,
        .take = take,
        .wait = wait,
        .owner = making,
    };
    const bool is_done = pool_run(&pool, err);
    free(making);
    return is_done;
}
