// Makes the missing runs of a study, each in a process of its own.
#include "commands/study/sweep.h"
#include "base/clock.h"
#include "base/printable.h"
#include "commands/study/design.h"
#include "commands/study/follow.h"
#include "commands/study/neighbours.h"
#include "commands/study/worker.h"
#include "measure/chosen_run.h"
#include "run/registry.h"
#include "run/settle.h"

#include <assert.h>
#include <errno.h>
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef enum SweepGroupState {
    SWEEP_GROUP_NONE,   // no group
    SWEEP_GROUP_WANTED, // its truth is to be made
    SWEEP_GROUP_MAKING, // its truth is being made
    SWEEP_GROUP_READY,  // its runs may start
} SweepGroupState;

typedef struct SweepGroup {
    SweepGroupState state;
    uint64_t next;      // its next run to be started, or end
    uint64_t end;       // number behind its last
    size_t busy;        // of its runs at work
    bool is_block;      // one process makes them, which knows their settled motions
    bool is_alone;      // it is one, and a process died over it: each run settles by itself
    bool has_truth;     // of SWEEP_GROUP_READY
    bool lacks_truth;   // there should be one, and it cannot be computed
    Truth truth;        // owned
    SweepTruth *wanted; // owned; while the truth is to be made
    void *packed;       // owned; the truth as it arrives
    size_t packed_size; // bytes
    size_t lost;        // processes that died over the truth
} SweepGroup;

enum { SWEEP_SLOT_DEPTH = 2 }; // processes of a slot: one at work, one ready

// One process. It lives for many runs of one group, since it knows the truth from its start.
typedef struct SweepJob {
    SweepGroup *group; // NULL: none
    bool is_truth;
    SweepSlot slot;
    SweepRun run;
    Record record;
    uint64_t serves; // the worker there: `end` of the group whose truth it knows
    size_t made;     // and the runs that it was given
} SweepJob;

typedef struct SweepPool {
    const Sweep *sweep;
    const SweepWork *work;
    SweepState *state;
    int slots;
    size_t slot_count;
    double *ended_s;  // by the clock, of each slot's last process
    size_t job_count; // those of slot k are k, k + slot_count, ...
    SweepJob *jobs;
    Child *children; // of the jobs
    size_t group_count;
    SweepGroup *groups;
    uint64_t from; // the first run of no group yet
    uint64_t end;  // number of runs of the study
    size_t busy;   // processes
    bool has_news; // rows were added to the store
} SweepPool;

// The work of one process, and the record of one that ended without a result.
//
// values -> scenario -> trajectory -> metrics -> record.

static void give_reason(Record *record, RunOutcome outcome, const char *reason)
{
    record->outcome = outcome;
    shorten_copy(record->reason, sizeof record->reason, reason);
}

// No number that is not finite becomes a data point; NAN alone says that there is none.
static void check_results(const Layout *layout, Record *record)
{
    for (size_t i = 0; i < layout->result_count && record->outcome == RUN_OUTCOME_OK; i++) {
        if (isinf(record->results[i])) {
            record->outcome = RUN_OUTCOME_FAILED;
            snprintf(record->reason, sizeof record->reason, "%.*s is not finite",
                     RECORD_NAME_SIZE - 1, layout->results[i].name);
        }
    }
}

static void forget_results(Record *record)
{
    for (size_t i = 0; i < RECORD_RESULT_MAX; i++) {
        record->results[i] = NAN;
    }
}

static void sweep_measure(const SweepRun *task, const Scenario *scenario, BackendKind backend,
                          Record *record)
{
    Trajectory *trajectory = backend_run(scenario, backend, task->truth,
                                         (ChosenWatch){.begin = NULL}, backend_run_probe(scenario));
    if (trajectory->is_complete &&
        metrics_take(task->layout, scenario, trajectory, task->truth, record->results)) {
        record->hash = trajectory->hash;
        check_results(task->layout, record);
    } else {
        const bool is_starved = child_lacks_memory();
        give_reason(record, is_starved ? RUN_OUTCOME_NO_MEMORY : RUN_OUTCOME_FAILED,
                    trajectory->message);
    }
    if (record->outcome != RUN_OUTCOME_OK) {
        forget_results(record);
        record->hash = 0;
    }
    trajectory_destroy(trajectory);
}

static void sweep_run(const SweepRun *task, Record *record)
{
    Scenario *scenario = calloc(1, sizeof *scenario);
    assert(scenario != NULL);
    record->run = task->run;
    forget_results(record);
    design_values(task->spec, task->run, record->settings);
    BackendKind backend;
    Err err = {0};
    if (!design_scenario(task->spec, record->settings, scenario, &backend, &err)) {
        give_reason(record, RUN_OUTCOME_REFUSED, err.text);
    } else if (scenario_lacks_start(scenario) && !registry_check_backend(scenario, backend, &err)) {
        // one whose start need not be found is refused as soon as it runs
        give_reason(record, RUN_OUTCOME_FAILED, err.text);
    } else {
        if (task->spec->has_neighbours && !task->is_alone) {
            neighbours_settle(task->spec, task->run, task->slot.limit_s, scenario);
        } else {
            follow_settle(task->spec, task->run, scenario);
        }
        if (task->spec->has_growth) {
            settle_growth(scenario, (RunWatch){.progress = NULL});
        }
        sweep_measure(task, scenario, backend, record);
    }
    scenario_destroy(scenario);
}

// In its own process, as the runs of the group do it in theirs: all find the same start.
static void sweep_certify(const SweepTruth *truth, void *packed)
{
    Task *task = calloc(1, sizeof *task);
    assert(task != NULL);
    *task = truth->task;
    task->scenario = scenario_copy(&truth->task.scenario);
    follow_settle(truth->spec, truth->run, &task->scenario);
    task_certify(task, packed);
    scenario_free(&task->scenario);
    free(task);
}

const SweepWork SWEEP_WORK = {sweep_run, sweep_certify};

static void enter(const SweepSlot *slot)
{
    last_words_listen(slot->words);
    slot_enter(slot->slots, slot->number, slot->limit_s);
    errno = 0;
}

static void sweep_work_run(const void *context, void *result)
{
    const SweepRun *task = context;
    Record *record = result;
    enter(&task->slot);
    const double started_s = clock_now_s();
    task->slot.work->run(task, record);
    record->wall_s = clock_now_s() - started_s;
    slot_leave(task->slot.slots, task->slot.number);
}

// Each is a ChildWork: takes a SweepRun or SweepTruth, waits for its slot, and does its work with
// its output captured.
static void sweep_work_certify(const void *context, void *packed)
{
    const SweepTruth *task = context;
    enter(&task->slot);
    task->slot.work->certify(task, packed);
    slot_leave(task->slot.slots, task->slot.number);
}

// Marks a process that its slot's time limit ended as timed out; SIGALRM did it.
static void sweep_work_mark_timeout(const SweepSlot *slot, Child *child)
{
    if (child->end == CHILD_SIGNALLED && child->code == SIGALRM && slot->limit_s > 0.0) {
        child->end = CHILD_TIMED_OUT;
        child->limits.time_s = slot->limit_s;
    }
}

static RunOutcome outcome_of(ChildEnd end)
{
    switch (end) {
    case CHILD_TIMED_OUT:
        return RUN_OUTCOME_TIMED_OUT;
    case CHILD_NO_MEMORY:
        return RUN_OUTCOME_NO_MEMORY;
    default:
        return RUN_OUTCOME_ENDED;
    }
}

// The record of a run whose process ended without one: why is in the child and in its last words.
static void sweep_work_lost(const SweepRun *task, const Child *child, double wall_s, Record *record)
{
    char words[CHILD_TEXT_SIZE];
    char said[RECORD_REASON_SIZE - CHILD_TEXT_SIZE - 2];
    memset(record, 0, sizeof *record);
    record->run = task->run;
    record->wall_s = wall_s;
    forget_results(record);
    design_values(task->spec, task->run, record->settings);
    child_describe(child, words);
    last_words_read(task->slot.words, said, sizeof said);
    record->outcome = outcome_of(child->end);
    snprintf(record->reason, sizeof record->reason, "%s%s%s", words, said[0] != '\0' ? ": " : "",
             said);
}

// The runs that share a truth, and what happens where it cannot be computed.
//
// The group number never decreases with the run number, so that its end is found by bisection.

// Processes that may die over a truth before it is given up; the fault may be another's.
enum { LOST_MAX = 3 };

// Finds the first run of the sweep from a number on, and below an end, that is not in its store;
// the end where there is none. ERR_FILE.
static bool sweep_group_next(const Sweep *sweep, uint64_t from, uint64_t end, uint64_t *run,
                             Err *err)
{
    bool has = true;
    uint64_t next = from;
    while (next < end) {
        next = design_next(sweep->spec, sweep->shard, next);
        if (next >= end) {
            break;
        }
        if (!store_has(sweep->store, next, &has, err)) {
            return false;
        }
        if (!has) {
            break;
        }
        next++;
    }
    *run = next < end ? next : end;
    return true;
}

// The number behind the last run of a run's group.
static uint64_t sweep_find_end(const Spec *spec, uint64_t run)
{
    const uint64_t group = design_group(spec, run);
    uint64_t inside = run;
    uint64_t behind = design_run_count(spec);
    while (behind - inside > 1) {
        const uint64_t middle = inside + (behind - inside) / 2;
        if (design_group(spec, middle) == group) {
            inside = middle;
        } else {
            behind = middle;
        }
    }
    return behind;
}

// The number behind the last run of a run's block.
static uint64_t block_end(const Spec *spec, uint64_t run)
{
    const uint64_t size = design_block_size(spec);
    const uint64_t left = design_run_count(spec) - run;
    const uint64_t own = size - run % size;
    return run + (own < left ? own : left);
}

// What the truth's process is to do. False where the values of that run make no case.
static bool prepare_truth(const Spec *spec, uint64_t run, SweepGroup *group)
{
    Cell values[RECORD_SETTING_MAX];
    BackendKind backend;
    Err err = {0};
    design_values(spec, run, values);
    group->wanted = calloc(1, sizeof *group->wanted);
    assert(group->wanted != NULL);
    if (!design_scenario(spec, values, &group->wanted->task.scenario, &backend, &err)) {
        free(group->wanted);
        group->wanted = NULL;
        return false;
    }
    group->wanted->spec = spec;
    group->wanted->run = run;
    group->packed_size = truth_pack_size(&group->wanted->task.scenario);
    group->packed = malloc(group->packed_size);
    assert(group->packed != NULL);
    return true;
}

// Opens the group that a run is the first of to be made.
static void sweep_group_open(const Sweep *sweep, uint64_t run, SweepGroup *group)
{
    const Spec *spec = sweep->spec;
    *group = (SweepGroup){.state = SWEEP_GROUP_READY, .next = run};
    if (!spec->has_truth) {
        group->is_block = spec->has_neighbours;
        group->end = group->is_block ? block_end(spec, run) : design_run_count(spec);
        return;
    }
    group->end = sweep_find_end(spec, run);
    // a run whose own step makes no case says so itself; the truth is that of the others, too
    bool is_prepared = false;
    for (uint64_t i = run; i < group->end && !is_prepared; i++) {
        is_prepared = prepare_truth(spec, i, group);
    }
    group->state = is_prepared ? SWEEP_GROUP_WANTED : SWEEP_GROUP_READY;
}

static void drop_preparations(SweepGroup *group)
{
    if (group->wanted != NULL) {
        scenario_free(&group->wanted->task.scenario);
    }
    free(group->wanted);
    free(group->packed);
    group->wanted = NULL;
    group->packed = NULL;
}

// Takes the result of the truth's process, which has ended. False where the truth is to be tried
// again. `reason`, of RECORD_REASON_SIZE, is filled where it cannot be computed.
static bool sweep_group_take(SweepGroup *group, const Child *child, char *reason)
{
    const bool is_accident = child->end == CHILD_SIGNALLED || child->end == CHILD_EXITED;
    if (is_accident && ++group->lost < LOST_MAX) {
        group->state = SWEEP_GROUP_WANTED;
        return false;
    }
    group->state = SWEEP_GROUP_READY;
    if (child->end == CHILD_DONE) {
        group->truth = truth_pack_read(&group->wanted->task.scenario, group->packed);
        group->has_truth = group->truth.trajectory->is_complete;
    }
    if (!group->has_truth) {
        char words[CHILD_TEXT_SIZE];
        child_describe(child, words);
        shorten_copy(reason, RECORD_REASON_SIZE,
                     child->end == CHILD_DONE ? group->truth.trajectory->message : words);
    }
    group->lacks_truth = !group->has_truth;
    drop_preparations(group);
    return true;
}

// The limits of the process that makes a truth.
static ChildLimits sweep_group_limits(const Sweep *sweep)
{
    const ChildLimits limits = sweep->spec->limits;
    return (ChildLimits){.time_s = TASK_TRUTH_RUNS * limits.time_s,
                         .memory_bytes = limits.memory_bytes};
}

// Drops the truth. Accepts zeroed groups, and leaves one.
static void sweep_group_close(SweepGroup *group)
{
    drop_preparations(group);
    truth_finish(&group->truth);
    *group = (SweepGroup){.state = SWEEP_GROUP_NONE};
}

// The processes: which is started next, and what became of those that ended.
//
// There are as many slots as jobs; in each a process works and another one, already started, waits.
// A process lives for many runs, and ends with a run that goes wrong.
// A block is the matter of one process, which makes its runs one after another.
// Runs start by rising number. A truth is a process like a run, and is started early enough that no
// run waits for it: as soon as fewer runs than jobs are ready to start. The number of open groups
// is that of the jobs plus one, so that there is always something to start: each open group has a
// process, or a run that is ready.

// Runs of one worker: what a process costs is then some per cent of a short run, and what it might
// lose of its memory from run to run is given back.
enum { WORKER_RUNS_MAX = 200 };

static void sweep_pool_open(const Sweep *sweep, SweepState *state, SweepPool *pool)
{
    // each process has a block of its own
    const size_t group_count =
        (sweep->spec->has_neighbours ? SWEEP_SLOT_DEPTH : 1) * sweep->jobs + 1;
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
        .group_count = group_count,
        .groups = calloc(group_count, sizeof *pool->groups),
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

// Ends the processes that are still there.
static void sweep_pool_close(SweepPool *pool)
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

// Whether the process of a job knows what a group shares, and waits for a run of it.
static bool is_served_by(const SweepPool *pool, size_t number, const SweepGroup *group)
{
    const SweepJob *job = &pool->jobs[number];
    return job->serves == group->end && job->made < WORKER_RUNS_MAX &&
           child_is_at_rest(&pool->children[number]);
}

// Whether a job may start a run of a block: no process is at work on it, and no other knows it.
static bool is_free_for(const SweepPool *pool, size_t number, const SweepGroup *block)
{
    bool is_free = block->busy == 0;
    for (size_t i = 0; i < pool->job_count && is_free; i++) {
        is_free = i == number || pool->jobs[i].group != NULL || !is_served_by(pool, i, block);
    }
    return is_free;
}

// The first group by number of run that has a run for a job to start, of blocks that which its
// process knows, and whether the runs to start are enough for every job.
static SweepGroup *find_ready(const SweepPool *pool, size_t number, bool *are_enough)
{
    SweepGroup *first = NULL;
    bool is_own = false;
    uint64_t ready = 0;
    for (size_t i = 0; i < pool->group_count; i++) {
        SweepGroup *group = &pool->groups[i];
        if (group->state != SWEEP_GROUP_READY || group->next >= group->end ||
            (group->is_block && !is_free_for(pool, number, group))) {
            continue;
        }
        const bool is_known = group->is_block && is_served_by(pool, number, group);
        ready += group->is_block ? pool->slot_count : group->end - group->next;
        if (first == NULL || (is_known && !is_own) ||
            (is_known == is_own && group->next < first->next)) {
            first = group;
            is_own = is_known;
        }
    }
    *are_enough = ready >= pool->slot_count;
    return first;
}

static SweepGroup *sweep_find_group(const SweepPool *pool, SweepGroupState state)
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
    SweepGroup *group = sweep_find_group(pool, SWEEP_GROUP_NONE);
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
static bool sweep_pool_go_on(SweepJob *job, Child *child, const SweepGroup *group)
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
static bool sweep_start(SweepPool *pool, size_t number, SweepGroup *group, bool *is_started,
                        Err *err)
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
        *is_started =
            sweep_pool_go_on(job, child, group) || start_worker(job, child, group, limits, &reason);
    }
    pool->busy += *is_started ? 1 : 0;
    job->group = *is_started ? group : NULL;
    return *is_started || pool->busy > 0 || err_set_lines(err, reason.kind, reason.text);
}

static bool start_truth(SweepPool *pool, size_t number, SweepGroup *group, bool *is_started,
                        Err *err)
{
    pool->jobs[number].is_truth = true;
    if (!sweep_start(pool, number, group, is_started, err)) {
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
        .is_alone = group->is_alone,
    };
    if (!sweep_start(pool, number, group, is_started, err)) {
        return false;
    }
    if (!*is_started) {
        return true;
    }
    group->busy++;
    return sweep_group_next(pool->sweep, group->next + 1, group->end, &group->next, err);
}

// Gives a free job something to do, where there is something.
static bool sweep_fill(SweepPool *pool, size_t number, bool *is_started, Err *err)
{
    bool are_enough;
    SweepGroup *ready = find_ready(pool, number, &are_enough);
    *is_started = false;
    while (!are_enough) {
        SweepGroup *group = sweep_find_group(pool, SWEEP_GROUP_WANTED);
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
        ready = find_ready(pool, number, &are_enough);
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

// Starts a process for every free job, as far as there is work. Fails with ERR_FILE where the store
// does, with ERR_SOLVER where the system has no process at all.
//
// Empty slots come first, then those with nothing ready. Where there is nothing for one job there
// may be for the next: the block that its process knows.
static bool sweep_pool_fill(SweepPool *pool, Err *err)
{
    bool is_started;
    for (size_t depth = 0; depth < SWEEP_SLOT_DEPTH; depth++) {
        for (size_t i = 0; i < pool->job_count; i++) {
            if (pool->jobs[i].group == NULL &&
                count_slot(pool, pool->jobs[i].slot.number) <= depth &&
                !sweep_fill(pool, i, &is_started, err)) {
                return false;
            }
        }
    }
    return true;
}

// How long a process worked, as far as its parent knows: it may have had to wait.
static double sweep_time_of(SweepPool *pool, const SweepJob *job, const Child *child)
{
    double *ended_s = &pool->ended_s[job->slot.number];
    const double from_s = child->started_s > *ended_s ? child->started_s : *ended_s;
    *ended_s = clock_now_s();
    return *ended_s - from_s;
}

static bool sweep_take_run(SweepPool *pool, SweepJob *job, const Child *child, double wall_s,
                           Err *err)
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

static void sweep_take_truth(SweepPool *pool, SweepGroup *group, const Child *child, double wall_s)
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
    const bool is_own = job->made <= 1 && (!job->group->is_block || job->run.is_alone);
    // what settles a block is the work of all its runs
    const bool is_blocks =
        job->group->is_block && !job->run.is_alone && child->end == CHILD_TIMED_OUT;
    return !job->is_truth && !is_own && (is_lost || is_starved || is_blocks);
}

// Makes the run of a job once more, in a new process. False where there is none.
static bool try_again(SweepPool *pool, size_t number)
{
    SweepJob *job = &pool->jobs[number];
    Err unused = {0};
    ChildLimits limits = pool->sweep->spec->limits;
    limits.time_s = 0.0;
    last_words_clear(job->slot.words);
    job->group->is_alone = job->group->is_block;
    job->run.is_alone = job->group->is_alone;
    return start_worker(job, &pool->children[number], job->group, limits, &unused);
}

// Takes the results of ended processes into the store and the state, and closes finished groups.
// ERR_FILE.
static bool sweep_pool_take(SweepPool *pool, Err *err)
{
    bool is_taken = true;
    for (size_t i = 0; i < pool->job_count && is_taken; i++) {
        SweepJob *job = &pool->jobs[i];
        SweepGroup *group = job->group;
        if (group == NULL || pool->children[i].end == CHILD_RUNNING) {
            continue;
        }
        Child *child = &pool->children[i];
        const double wall_s = sweep_time_of(pool, job, child);
        sweep_work_mark_timeout(&job->slot, child);
        if (is_in_doubt(job, child) && try_again(pool, i)) {
            pool->state->inside_s += wall_s;
            continue;
        }
        if (job->is_truth) {
            sweep_take_truth(pool, group, child, wall_s);
        } else {
            is_taken = sweep_take_run(pool, job, child, wall_s, err);
        }
        job->group = NULL;
        pool->busy--;
        if (group->state == SWEEP_GROUP_READY && group->next == group->end && group->busy == 0) {
            sweep_group_close(group);
        }
    }
    return is_taken;
}

// Whether anything is left to be done.
static bool sweep_pool_has_more(const SweepPool *pool)
{
    bool is_open = pool->from < pool->end;
    for (size_t i = 0; i < pool->group_count; i++) {
        is_open = is_open || pool->groups[i].state != SWEEP_GROUP_NONE;
    }
    return is_open;
}

// The loop of the sweep.
//
// fill the slots -> wait -> take in what has ended -> commit now and then -> report.

static const double PAUSE_S = 0.2;       // between two looks at who wants it to stop
static const double COMMIT_S = 0.25;     // between two commits: what a power cut takes away
static const double COMMIT_SHARE = 0.02; // of the time that commits may take at most
static const double REPORT_S = 0.1;      // between two words of progress

// When what was done last.
typedef struct Times {
    double started_s; // all by the clock
    double committed_s;
    double reported_s;
    double commit_s; // that the last commit took
} Times;

// The rows of the shard that are there already. A store of its own has no others.
static bool count_done(const Sweep *sweep, uint64_t *done, Err *err)
{
    StoreCount count;
    if (!store_count(sweep->store, &count, err)) {
        return false;
    }
    *done = count.rows;
    if (sweep->shard.count == 1 || count.rows == 0) {
        return true;
    }
    const uint64_t end = design_run_count(sweep->spec);
    *done = 0;
    for (uint64_t run = 0; (run = design_next(sweep->spec, sweep->shard, run)) < end; run++) {
        bool has;
        if (!store_has(sweep->store, run, &has, err)) {
            return false;
        }
        *done += has ? 1 : 0;
    }
    return true;
}

static bool commit(const Sweep *sweep, Times *times, Err *err)
{
    const double started_s = clock_now_s();
    const bool is_kept = store_commit(sweep->store, err);
    times->committed_s = clock_now_s();
    times->commit_s = times->committed_s - started_s;
    return is_kept;
}

static void report(const Sweep *sweep, SweepState *state, Times *times)
{
    times->reported_s = clock_now_s();
    state->wall_s = times->reported_s - times->started_s;
    sweep->report(state, sweep->context);
}

static bool sweep_keep(SweepPool *pool, Times *times, Err *err)
{
    const double clock_s = clock_now_s();
    if (clock_s - times->reported_s >= REPORT_S) {
        report(pool->sweep, pool->state, times);
    }
    // a slow disk is asked less often
    const double pause_s = fmax(COMMIT_S, times->commit_s / COMMIT_SHARE);
    if (!pool->has_news || clock_s - times->committed_s < pause_s) {
        return true;
    }
    pool->has_news = false;
    return commit(pool->sweep, times, err);
}

static bool sweep_loop_go_on(SweepPool *pool, Times *times, SweepEnd *end, Err *err)
{
    const Sweep *sweep = pool->sweep;
    *end = SWEEP_COMPLETE;
    while (sweep_pool_has_more(pool)) {
        if (sweep->should_stop(sweep->context)) {
            *end = SWEEP_STOPPED;
            break;
        }
        if (!sweep_pool_fill(pool, err)) {
            return false;
        }
        child_wait(pool->children, pool->job_count, PAUSE_S);
        if (!sweep_pool_take(pool, err) || !sweep_keep(pool, times, err)) {
            return false;
        }
    }
    return commit(sweep, times, err);
}

bool sweep_execute(const Sweep *sweep, SweepEnd *end, SweepState *state, Err *err)
{
    assert(sweep->jobs >= 1 && sweep->jobs <= SWEEP_JOB_MAX);
    *state = (SweepState){.total = design_shard_count(sweep->spec, sweep->shard)};
    if (!count_done(sweep, &state->done, err)) {
        return false;
    }
    const double started_s = clock_now_s();
    Times times = {started_s, started_s, started_s, 0.0};
    SweepPool pool;
    sweep_pool_open(sweep, state, &pool);
    const bool is_done = sweep_loop_go_on(&pool, &times, end, err);
    report(sweep, state, &times);
    sweep_pool_close(&pool);
    return is_done;
}
