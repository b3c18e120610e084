// Which process is to be started next, and what became of those that ended?
//
// There are as many lanes as jobs; in each a process works and another one, made ready, stands
// behind it. Runs start by rising number. A truth is a process like a run, and is started early
// enough for runs to wait for none: as soon as fewer runs than jobs are ready to start. One group
// more than there are jobs is open at a time, so that there is always something to start: of those
// open, each has a process, or a run that is ready.
#include "commands/study/sweep_floor.h"

#include "base/clock.h"
#include "commands/study/lane.h"
#include "commands/study/last_words.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

void sweep_floor_open(const Sweep *sweep, SweepState *state, SweepFloor *floor)
{
    *floor = (SweepFloor){
        .sweep = sweep,
        .work = sweep->work == NULL ? &SWEEP_WORK : sweep->work,
        .state = state,
        .lanes = lane_open(),
        .lane_count = sweep->jobs,
        .ended_s = calloc(sweep->jobs, sizeof *floor->ended_s),
        .job_count = SWEEP_LANE_DEPTH * sweep->jobs,
        .jobs = calloc(SWEEP_LANE_DEPTH * sweep->jobs, sizeof *floor->jobs),
        .children = calloc(SWEEP_LANE_DEPTH * sweep->jobs, sizeof *floor->children),
        .group_count = sweep->jobs + 1,
        .groups = calloc(sweep->jobs + 1, sizeof *floor->groups),
        .end = design_run_count(sweep->spec),
    };
    assert(floor->ended_s != NULL && floor->jobs != NULL && floor->children != NULL &&
           floor->groups != NULL);
    for (size_t i = 0; i < floor->job_count; i++) {
        floor->jobs[i].place = (SweepPlace){
            .work = floor->work,
            .words = last_words_open(),
            .lanes = floor->lanes,
            .lane = i % floor->lane_count,
        };
    }
}

void sweep_floor_close(SweepFloor *floor)
{
    for (size_t i = 0; i < floor->job_count; i++) {
        child_kill(&floor->children[i]);
        last_words_close(floor->jobs[i].place.words);
    }
    for (size_t i = 0; i < floor->group_count; i++) {
        sweep_group_close(&floor->groups[i]);
    }
    lane_close(floor->lanes);
    free(floor->ended_s);
    free(floor->jobs);
    free(floor->children);
    free(floor->groups);
}

// The first group by number of run that has a run to start, and whether the runs to start are
// enough for every job.
static SweepGroup *find_ready(const SweepFloor *floor, bool *are_enough)
{
    SweepGroup *first = NULL;
    uint64_t ready = 0;
    for (size_t i = 0; i < floor->group_count; i++) {
        SweepGroup *group = &floor->groups[i];
        if (group->state == SWEEP_GROUP_READY && group->next < group->end) {
            ready += group->end - group->next;
            first = first == NULL || group->next < first->next ? group : first;
        }
    }
    *are_enough = ready >= floor->lane_count;
    return first;
}

static SweepGroup *find_group(const SweepFloor *floor, SweepGroupState state)
{
    for (size_t i = 0; i < floor->group_count; i++) {
        if (floor->groups[i].state == state) {
            return &floor->groups[i];
        }
    }
    return NULL;
}

// Opens the next group where there is room for it and one is left.
static bool open_next(SweepFloor *floor, SweepGroup **opened, Err *err)
{
    SweepGroup *group = find_group(floor, SWEEP_GROUP_NONE);
    *opened = NULL;
    if (group == NULL || floor->from >= floor->end) {
        return true;
    }
    uint64_t run;
    if (!sweep_group_next(floor->sweep, floor->from, floor->end, &run, err)) {
        return false;
    }
    floor->from = run;
    if (run < floor->end) {
        sweep_group_open(floor->sweep, run, group);
        floor->from = group->end;
        *opened = group;
    }
    return true;
}

// Starts a process. Where the system has none left but others are there, one will be free when
// they are done. The limit of its time is the lane's, for it may have to wait.
static bool start(SweepFloor *floor, size_t number, SweepGroup *group, bool *is_started, Err *err)
{
    SweepJob *job = &floor->jobs[number];
    Child *child = &floor->children[number];
    Err reason = {0};
    ChildLimits limits =
        job->is_truth ? sweep_group_limits(floor->sweep) : floor->sweep->spec->limits;
    job->place.limit_s = limits.time_s;
    limits.time_s = 0.0;
    last_words_clear(job->place.words);
    if (job->is_truth) {
        group->wanted->place = job->place;
        *is_started = child_start(child, sweep_work_certify, group->wanted, group->packed,
                                  group->packed_size, limits, &reason);
    } else {
        job->run.place = job->place;
        *is_started = child_start(child, sweep_work_run, &job->run, &job->record,
                                  sizeof job->record, limits, &reason);
    }
    floor->busy += *is_started ? 1 : 0;
    job->group = *is_started ? group : NULL;
    return *is_started || floor->busy > 0 || err_set_lines(err, reason.kind, reason.text);
}

static bool start_truth(SweepFloor *floor, size_t number, SweepGroup *group, bool *is_started,
                        Err *err)
{
    floor->jobs[number].is_truth = true;
    if (!start(floor, number, group, is_started, err)) {
        return false;
    }
    group->state = *is_started ? SWEEP_GROUP_MAKING : SWEEP_GROUP_WANTED;
    return true;
}

static bool start_run(SweepFloor *floor, size_t number, SweepGroup *group, bool *is_started,
                      Err *err)
{
    SweepJob *job = &floor->jobs[number];
    job->is_truth = false;
    job->run = (SweepRun){
        .spec = floor->sweep->spec,
        .layout = floor->sweep->layout,
        .truth = group->has_truth ? &group->truth : NULL,
        .run = group->next,
    };
    if (!start(floor, number, group, is_started, err)) {
        return false;
    }
    if (!*is_started) {
        return true;
    }
    group->busy++;
    return sweep_group_next(floor->sweep, group->next + 1, group->end, &group->next, err);
}

// Gives a free job something to do, where there is something.
static bool fill(SweepFloor *floor, size_t number, bool *is_started, Err *err)
{
    bool are_enough;
    SweepGroup *ready = find_ready(floor, &are_enough);
    *is_started = false;
    while (!are_enough) {
        SweepGroup *group = find_group(floor, SWEEP_GROUP_WANTED);
        if (group == NULL && !open_next(floor, &group, err)) {
            return false;
        }
        if (group == NULL) {
            break;
        }
        if (group->state == SWEEP_GROUP_WANTED) {
            return start_truth(floor, number, group, is_started, err);
        }
        // it needs no truth, or can have none
        ready = find_ready(floor, &are_enough);
    }
    return ready == NULL || start_run(floor, number, ready, is_started, err);
}

static size_t count_lane(const SweepFloor *floor, size_t lane)
{
    size_t count = 0;
    for (size_t i = lane; i < floor->job_count; i += floor->lane_count) {
        count += floor->jobs[i].group != NULL ? 1 : 0;
    }
    return count;
}

// Empty lanes come first, then those with nothing ready.
bool sweep_floor_fill(SweepFloor *floor, Err *err)
{
    bool is_started = true;
    for (size_t depth = 0; depth < SWEEP_LANE_DEPTH; depth++) {
        for (size_t i = 0; i < floor->job_count && is_started; i++) {
            if (floor->jobs[i].group == NULL &&
                count_lane(floor, floor->jobs[i].place.lane) <= depth &&
                !fill(floor, i, &is_started, err)) {
                return false;
            }
        }
    }
    return true;
}

// How long a process was at work, as far as its parent can tell: it may have had to wait.
static double time_of(SweepFloor *floor, const SweepJob *job, const Child *child)
{
    double *ended_s = &floor->ended_s[job->place.lane];
    const double from_s = child->started_s > *ended_s ? child->started_s : *ended_s;
    *ended_s = clock_now_s();
    return *ended_s - from_s;
}

static bool take_run(SweepFloor *floor, SweepJob *job, const Child *child, double wall_s, Err *err)
{
    SweepState *state = floor->state;
    Record *record = &job->record;
    if (child->end != CHILD_DONE) {
        sweep_work_lost(&job->run, child, wall_s, record);
    }
    state->inside_s += record->wall_s;
    state->made++;
    state->done++;
    state->failed += record->fate != FATE_OK ? 1 : 0;
    state->without_truth += record->fate == FATE_OK && job->group->lacks_truth ? 1 : 0;
    job->group->busy--;
    floor->has_news = true;
    return store_add(floor->sweep->store, record, err);
}

static void take_truth(SweepFloor *floor, SweepGroup *group, const Child *child, double wall_s)
{
    char reason[RECORD_REASON_SIZE] = "";
    floor->state->inside_s += wall_s;
    if (sweep_group_take(group, child, reason) && floor->state->no_truth[0] == '\0') {
        memcpy(floor->state->no_truth, reason, sizeof reason);
    }
}

bool sweep_floor_take(SweepFloor *floor, Err *err)
{
    bool is_taken = true;
    for (size_t i = 0; i < floor->job_count && is_taken; i++) {
        SweepJob *job = &floor->jobs[i];
        SweepGroup *group = job->group;
        if (group == NULL || floor->children[i].end == CHILD_RUNNING) {
            continue;
        }
        Child *child = &floor->children[i];
        const double wall_s = time_of(floor, job, child);
        sweep_work_tell_time(&job->place, child);
        if (job->is_truth) {
            take_truth(floor, group, child, wall_s);
        } else {
            is_taken = take_run(floor, job, child, wall_s, err);
        }
        job->group = NULL;
        floor->busy--;
        if (group->state == SWEEP_GROUP_READY && group->next == group->end && group->busy == 0) {
            sweep_group_close(group);
        }
    }
    return is_taken;
}

bool sweep_floor_has_more(const SweepFloor *floor)
{
    bool is_open = floor->from < floor->end;
    for (size_t i = 0; i < floor->group_count; i++) {
        is_open = is_open || floor->groups[i].state != SWEEP_GROUP_NONE;
    }
    return is_open;
}
