// What does one process of a sweep do, and which record stands for one that ended without a result?
//
// values -> scenario -> trajectory -> metrics -> record.
#include "commands/study/sweep_work.h"

#include "base/clock.h"
#include "base/printable.h"
#include "commands/study/design.h"
#include "commands/study/last_words.h"
#include "commands/study/slot.h"
#include "measure/backend_run.h"
#include "run/registry.h"

#include <assert.h>
#include <errno.h>
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

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

static void measure(const SweepRun *task, const Scenario *scenario, BackendKind backend,
                    Record *record)
{
    Trajectory *trajectory =
        backend_run(scenario, backend, task->truth, (ChosenWatch){.begin = NULL}, NULL);
    if (trajectory->is_complete &&
        metrics_take(scenario, trajectory, task->truth, record->results)) {
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

static void run(const SweepRun *task, Record *record)
{
    Scenario *scenario = calloc(1, sizeof *scenario);
    assert(scenario != NULL);
    record->run = task->run;
    forget_results(record);
    design_values(task->spec, task->run, record->settings);
    BackendKind backend;
    Err err = {0};
    if (design_scenario(task->spec, record->settings, scenario, &backend, &err)) {
        measure(task, scenario, backend, record);
    } else {
        give_reason(record, RUN_OUTCOME_REFUSED, err.text);
    }
    scenario_destroy(scenario);
}

static void certify(const SweepTruth *truth, void *packed)
{
    task_certify(&truth->task, packed);
}

const SweepWork SWEEP_WORK = {run, certify};

static void enter(const SweepSlot *slot)
{
    last_words_listen(slot->words);
    slot_enter(slot->slots, slot->number, slot->limit_s);
    errno = 0;
}

void sweep_work_run(const void *context, void *result)
{
    const SweepRun *task = context;
    Record *record = result;
    enter(&task->slot);
    const double started_s = clock_now_s();
    task->slot.work->run(task, record);
    record->wall_s = clock_now_s() - started_s;
    slot_leave(task->slot.slots, task->slot.number);
}

void sweep_work_certify(const void *context, void *packed)
{
    const SweepTruth *task = context;
    enter(&task->slot);
    task->slot.work->certify(task, packed);
    slot_leave(task->slot.slots, task->slot.number);
}

void sweep_work_mark_timeout(const SweepSlot *slot, Child *child)
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

void sweep_work_lost(const SweepRun *task, const Child *child, double wall_s, Record *record)
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
