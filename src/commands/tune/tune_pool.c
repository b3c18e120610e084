// How do several runs go on at once?
#include "commands/tune/tune_pool.h"

#include <assert.h>
#include <stdio.h>
#include <stdlib.h>

static const double PAUSE_S = 0.2; // between two looks of whoever waits

void tune_pool_init(TunePool *pool, size_t jobs, double time_limit_s)
{
    assert(jobs >= 1 && jobs <= TUNE_POOL_MAX);
    *pool = (TunePool){.jobs = jobs, .time_limit_s = time_limit_s};
    pool->places = calloc(jobs, sizeof *pool->places);
    pool->children = calloc(jobs, sizeof *pool->children);
    assert(pool->places != NULL && pool->children != NULL);
}

void tune_pool_finish(TunePool *pool)
{
    for (size_t i = 0; i < pool->jobs; i++) {
        child_kill(&pool->children[i]);
    }
    free(pool->places);
    free(pool->children);
    *pool = (TunePool){.jobs = 0};
}

bool tune_pool_has_place(const TunePool *pool)
{
    return pool->busy < pool->jobs;
}

bool tune_pool_start(TunePool *pool, const Task *task, size_t tag, Err *err)
{
    size_t place = 0;
    while (place < pool->jobs && pool->places[place].is_busy) {
        place++;
    }
    assert(place < pool->jobs);
    TunePoolJob *job = &pool->places[place];
    job->task = *task;
    job->tag = tag;
    const ChildLimits limits = {.time_s = pool->time_limit_s, .memory_bytes = TASK_MEMORY_LIMIT};
    job->is_busy = child_start(&pool->children[place], task_measure, &job->task, &job->run,
                               sizeof job->run, limits, err);
    pool->busy += job->is_busy ? 1 : 0;
    return job->is_busy;
}

static bool take_ended(TunePool *pool, size_t *tag, LadderRun *run)
{
    for (size_t i = 0; i < pool->jobs; i++) {
        TunePoolJob *job = &pool->places[i];
        const Child *child = &pool->children[i];
        if (!job->is_busy || child->end == CHILD_RUNNING) {
            continue;
        }
        job->is_busy = false;
        pool->busy--;
        *tag = job->tag;
        *run = job->run;
        if (child->end != CHILD_DONE) {
            char words[CHILD_TEXT_SIZE];
            child_describe(child, words);
            *run = job->task.run;
            run->is_lost = true;
            snprintf(run->message, sizeof run->message, "the run's process %s", words);
        }
        return true;
    }
    return false;
}

bool tune_pool_take(TunePool *pool, size_t *tag, LadderRun *run)
{
    if (take_ended(pool, tag, run)) {
        return true;
    }
    child_wait(pool->children, pool->jobs, PAUSE_S);
    return take_ended(pool, tag, run);
}
