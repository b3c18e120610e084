// Which runs share a truth, and what if it cannot be computed?
//
// The group number never decreases with the run number, so that its end is found by bisection.
#include "commands/study/sweep_group.h"

#include "base/printable.h"

#include <assert.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// Processes that may die over a truth before it is given up; the fault may be another's.
enum { LOST_MAX = 3 };

bool sweep_group_next(const Sweep *sweep, uint64_t from, uint64_t end, uint64_t *run, Err *err)
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
static uint64_t find_end(const Spec *spec, uint64_t run)
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
    group->packed_size = truth_pack_size(&group->wanted->task.scenario);
    group->packed = malloc(group->packed_size);
    assert(group->packed != NULL);
    return true;
}

void sweep_group_open(const Sweep *sweep, uint64_t run, SweepGroup *group)
{
    const Spec *spec = sweep->spec;
    *group = (SweepGroup){.state = SWEEP_GROUP_READY, .next = run};
    if (!spec->has_truth) {
        group->end = design_run_count(spec);
        return;
    }
    group->end = find_end(spec, run);
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

bool sweep_group_take(SweepGroup *group, const Child *child, char *reason)
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

ChildLimits sweep_group_limits(const Sweep *sweep)
{
    const ChildLimits limits = sweep->spec->limits;
    return (ChildLimits){.time_s = TASK_TRUTH_RUNS * limits.time_s,
                         .memory_bytes = limits.memory_bytes};
}

void sweep_group_close(SweepGroup *group)
{
    drop_preparations(group);
    truth_finish(&group->truth);
    *group = (SweepGroup){.state = SWEEP_GROUP_NONE};
}
