// Which process is to be started next, and what became of those that ended?
//
// There are as many slots as jobs; in each a process works and another one, already started, waits.
// A process lives for many runs, and ends with a run that goes wrong.
// Runs start by rising number. A truth is a process like a run, and is started early enough that no
// run waits for it: as soon as fewer runs than jobs are ready to start. The number of open groups
// is that of the jobs plus one, so that there is always something to start: each open group has a
// process, or a run that is ready.
#include "commands/study/sweep_pool.h"

#include "base/clock.h"
#include "commands/study/last_words.h"
#include "commands/study/slot.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

// Runs of one worker: what a process costs is then some per cent of a short run, and what it might
// lose of its memory from run to run is given back.
enum { WORKER_RUNS_MAX = 200 };

void sweep_pool_open(const Sweep *sweep, SweepState *state, SweepPool *pool)
{
    *pool = (SweepPool){
        .sweep = sweep,
        .work = sweep->work == NULL ? &SWEEP_WORK : sweep->work,
        .state = state,
        .slots = slot_open(),
        .slot_count = sweep->jobs,
        .ended_s = calloc(sweep->jobs, sizeof *pool->ended_s),
        .job_count = SWEEP_SLOT_DEPTH * sweep->jobs,
        .jobs = calloc(SWEEP_SLOT_DEPTH * sweep->jobs, sizeof *pool->jobs),
        .children = calloc(SWEEP_SLOT_DEPTH * sweep->jobs, sizeof *pool->children),
        .group_count = sweep->jobs + 1,
        .groups = calloc(sweep->jobs + 1, sizeof *pool->groups),
        .end = design_run_count(sweep->spec),
    };
    assert(pool->ended_s != NULL && pool->jobs != NULL && pool->children != NULL &&
           pool->groups != NULL);
    for (size_t i = 0; i < pool->job_count; i++) {
        pool->jobs[i].slot = (SweepSlot){
            .work = pool->work,
            .words = last_words_open(),
            .slots = pool->slots,
            .number = i % pool->slot_count,
        };
    }
}

void sweep_pool_close(SweepPool *pool)
{
    for (size_t i = 0; i < pool->job_count; i++) {
        child_kill(&pool->children[i]);
        last_words_close(pool->jobs[i].slot.words);
    }
    for (size_t i = 0; i < pool->group_count; i++) {
        sweep_group_close(&pool->groups[i]);
    }
    slot_close(pool->slots);
    free(pool->ended_s);
    free(pool->jobs);
    free(pool->children);
    free(pool->groups);
}

// The first group by number of run that has a run to start, and whether the runs to start are
// enough for every job.
static SweepGroup *find_ready(const SweepPool *pool, bool *are_enough)
{
    SweepGroup *first = NULL;
    uint64_t ready = 0;
    for (size_t i = 0; i < pool->group_count; i++) {
        SweepGroup *group = &pool->groups[i];
        if (group->state == SWEEP_GROUP_READY && group->next < group->end) {
            ready += group->end - group->next;
            first = first == NULL || group->next < first->next ? group : first;
        }
    }
    *are_enough = ready >= pool->slot_count;
    return first;
}

static SweepGroup *find_group(const SweepPool *pool, SweepGroupState state)
{
    for (size_t i = 0; i < pool->group_count; i++) {
        if (pool->groups[i].state == state) {
            return &pool->groups[i];
        }
    }
    return NULL;
}

// Opens the next group where there is room for it and one is left.
static bool open_next(SweepPool *pool, SweepGroup **opened, Err *err)
{
    SweepGroup *group = find_group(pool, SWEEP_GROUP_NONE);
    *opened = NULL;
    if (group == NULL || pool->from >= pool->end) {
        return true;
    }
    uint64_t run;
    if (!sweep_group_next(pool->sweep, pool->from, pool->end, &run, err)) {
        return false;
    }
    pool->from = run;
    if (run < pool->end) {
        sweep_group_open(pool->sweep, run, group);
        pool->from = group->end;
        *opened = group;
    }
    return true;
}

// Gives the run to the worker that is there, where it knows the group's truth.
static bool go_on(SweepJob *job, Child *child, const SweepGroup *group)
{
    if (!child_is_at_rest(child) || job->serves != group->end || job->made >= WORKER_RUNS_MAX) {
        return false;
    }
    job->made++;
    return child_order(child, &job->run);
}

static bool start_worker(SweepJob *job, Child *child, const SweepGroup *group, ChildLimits limits,
                         Err *err)
{
    child_kill(child);
    job->serves = group->end;
    job->made = 1;
    return child_start_worker(child, sweep_work_run, &job->run, sizeof job->run, &job->record,
                              sizeof job->record, limits, err);
}

// Begins what the job is to do. Where the system has no process left but some are running, one
// becomes free when they end. The slot applies the time limit, because the process may have to wait
// first.
static bool start(SweepPool *pool, size_t number, SweepGroup *group, bool *is_started, Err *err)
{
    SweepJob *job = &pool->jobs[number];
    Child *child = &pool->children[number];
    Err reason = {0};
    ChildLimits limits =
        job->is_truth ? sweep_group_limits(pool->sweep) : pool->sweep->spec->limits;
    job->slot.limit_s = limits.time_s;
    limits.time_s = 0.0;
    last_words_clear(job->slot.words);
    if (job->is_truth) {
        child_kill(child);
        group->wanted->slot = job->slot;
        *is_started = child_start(child, sweep_work_certify, group->wanted, group->packed,
                                  group->packed_size, limits, &reason);
    } else {
        job->run.slot = job->slot;
        *is_started = go_on(job, child, group) || start_worker(job, child, group, limits, &reason);
    }
    pool->busy += *is_started ? 1 : 0;
    job->group = *is_started ? group : NULL;
    return *is_started || pool->busy > 0 || err_set_lines(err, reason.kind, reason.text);
}

static bool start_truth(SweepPool *pool, size_t number, SweepGroup *group, bool *is_started,
                        Err *err)
{
    pool->jobs[number].is_truth = true;
    if (!start(pool, number, group, is_started, err)) {
        return false;
    }
    group->state = *is_started ? SWEEP_GROUP_MAKING : SWEEP_GROUP_WANTED;
    return true;
}

static bool start_run(SweepPool *pool, size_t number, SweepGroup *group, bool *is_started, Err *err)
{
    SweepJob *job = &pool->jobs[number];
    job->is_truth = false;
    job->run = (SweepRun){
        .spec = pool->sweep->spec,
        .layout = pool->sweep->layout,
        .truth = group->has_truth ? &group->truth : NULL,
        .run = group->next,
    };
    if (!start(pool, number, group, is_started, err)) {
        return false;
    }
    if (!*is_started) {
        return true;
    }
    group->busy++;
    return sweep_group_next(pool->sweep, group->next + 1, group->end, &group->next, err);
}

// Gives a free job something to do, where there is something.
static bool fill(SweepPool *pool, size_t number, bool *is_started, Err *err)
{
    bool are_enough;
    SweepGroup *ready = find_ready(pool, &are_enough);
    *is_started = false;
    while (!are_enough) {
        SweepGroup *group = find_group(pool, SWEEP_GROUP_WANTED);
        if (group == NULL && !open_next(pool, &group, err)) {
            return false;
        }
        if (group == NULL) {
            break;
        }
        if (group->state == SWEEP_GROUP_WANTED) {
            return start_truth(pool, number, group, is_started, err);
        }
        // it needs no truth, or can have none
        ready = find_ready(pool, &are_enough);
    }
    return ready == NULL || start_run(pool, number, ready, is_started, err);
}

static size_t count_slot(const SweepPool *pool, size_t slot)
{
    size_t count = 0;
    for (size_t i = slot; i < pool->job_count; i += pool->slot_count) {
        count += pool->jobs[i].group != NULL ? 1 : 0;
    }
    return count;
}

// Empty slots come first, then those with nothing ready.
bool sweep_pool_fill(SweepPool *pool, Err *err)
{
    bool is_started = true;
    for (size_t depth = 0; depth < SWEEP_SLOT_DEPTH; depth++) {
        for (size_t i = 0; i < pool->job_count && is_started; i++) {
            if (pool->jobs[i].group == NULL &&
                count_slot(pool, pool->jobs[i].slot.number) <= depth &&
                !fill(pool, i, &is_started, err)) {
                return false;
            }
        }
    }
    return true;
}

// How long a process worked, as far as its parent knows: it may have had to wait.
static double time_of(SweepPool *pool, const SweepJob *job, const Child *child)
{
    double *ended_s = &pool->ended_s[job->slot.number];
    const double from_s = child->started_s > *ended_s ? child->started_s : *ended_s;
    *ended_s = clock_now_s();
    return *ended_s - from_s;
}

static bool take_run(SweepPool *pool, SweepJob *job, const Child *child, double wall_s, Err *err)
{
    SweepState *state = pool->state;
    Record *record = &job->record;
    if (child->end != CHILD_DONE) {
        sweep_work_lost(&job->run, child, wall_s, record);
    }
    state->inside_s += record->wall_s;
    state->made++;
    state->done++;
    state->failed += record->outcome != RUN_OUTCOME_OK ? 1 : 0;
    state->without_truth += record->outcome == RUN_OUTCOME_OK && job->group->lacks_truth ? 1 : 0;
    job->group->busy--;
    pool->has_news = true;
    return store_add(pool->sweep->store, record, err);
}

static void take_truth(SweepPool *pool, SweepGroup *group, const Child *child, double wall_s)
{
    char reason[RECORD_REASON_SIZE] = "";
    pool->state->inside_s += wall_s;
    if (sweep_group_take(group, child, reason) && pool->state->no_truth[0] == '\0') {
        memcpy(pool->state->no_truth, reason, sizeof reason);
    }
}

// What went wrong in a worker may be the fault of an earlier run: a run is judged by what it does
// in a process of its own. A limit of time is its own in any case.
static bool is_in_doubt(const SweepJob *job, const Child *child)
{
    const bool is_lost = child->end != CHILD_DONE && child->end != CHILD_TIMED_OUT;
    const bool is_starved =
        child->end == CHILD_DONE && job->record.outcome == RUN_OUTCOME_NO_MEMORY;
    return !job->is_truth && job->made > 1 && (is_lost || is_starved);
}

// Makes the run of a job once more, in a new process. False where there is none.
static bool try_again(SweepPool *pool, size_t number)
{
    SweepJob *job = &pool->jobs[number];
    Err unused = {0};
    ChildLimits limits = pool->sweep->spec->limits;
    limits.time_s = 0.0;
    last_words_clear(job->slot.words);
    return start_worker(job, &pool->children[number], job->group, limits, &unused);
}

bool sweep_pool_take(SweepPool *pool, Err *err)
{
    bool is_taken = true;
    for (size_t i = 0; i < pool->job_count && is_taken; i++) {
        SweepJob *job = &pool->jobs[i];
        SweepGroup *group = job->group;
        if (group == NULL || pool->children[i].end == CHILD_RUNNING) {
            continue;
        }
        Child *child = &pool->children[i];
        const double wall_s = time_of(pool, job, child);
        sweep_work_mark_timeout(&job->slot, child);
        if (is_in_doubt(job, child) && try_again(pool, i)) {
            pool->state->inside_s += wall_s;
            continue;
        }
        if (job->is_truth) {
            take_truth(pool, group, child, wall_s);
        } else {
            is_taken = take_run(pool, job, child, wall_s, err);
        }
        job->group = NULL;
        pool->busy--;
        if (group->state == SWEEP_GROUP_READY && group->next == group->end && group->busy == 0) {
            sweep_group_close(group);
        }
    }
    return is_taken;
}

bool sweep_pool_has_more(const SweepPool *pool)
{
    bool is_open = pool->from < pool->end;
    for (size_t i = 0; i < pool->group_count; i++) {
        is_open = is_open || pool->groups[i].state != SWEEP_GROUP_NONE;
    }
    return is_open;
}
