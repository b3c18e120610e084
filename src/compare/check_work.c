// How are the runs of a check made side by side, and none at another's risk?
#include "compare/check_work.h"

#include "base/child.h"
#include "compare/task.h"

#include <assert.h>
#include <stdio.h>
#include <stdlib.h>

static const double PAUSE_S = 0.2; // between two signs of life

static void measure(const void *context, void *result)
{
    const CheckWork *work = context;
    Scenario scenario = *work->scenario;
    check_measure_start(&scenario, work->start);
    check_measure(&scenario, &work->plan, result);
}

static bool start(const CheckWorkers *workers, CheckWork *work, Child *child, Err *err)
{
    const ChildLimits limits = {.time_s = workers->time_limit_s, .memory_bytes = TASK_MEMORY_LIMIT};
    return child_start(child, measure, work, work->measure, sizeof *work->measure, limits, err);
}

static void take_in(const CheckWork *work, const Child *child)
{
    if (child->end != CHILD_DONE) {
        char words[CHILD_TEXT_SIZE];
        child_describe(child, words);
        work->measure->is_complete = false;
        work->measure->count = 0;
        snprintf(work->measure->message, sizeof work->measure->message, "its process %s", words);
    }
}

bool check_work_do(const CheckWorkers *workers, CheckWork *works, size_t count, Err *err)
{
    const size_t places = workers->jobs < count ? workers->jobs : count;
    Child *children = calloc(places + 1, sizeof *children);
    size_t *numbers = calloc(places + 1, sizeof *numbers);
    assert(children != NULL && numbers != NULL);
    size_t next = 0;
    size_t done = 0;
    bool is_going = true;
    for (size_t i = 0; i < places && is_going; i++) {
        numbers[i] = next;
        is_going = start(workers, &works[next++], &children[i], err);
    }
    while (is_going && done < count) {
        workers->wait(done, count, workers->context);
        child_wait(children, places, PAUSE_S);
        for (size_t i = 0; i < places && is_going; i++) {
            if (numbers[i] == count || children[i].end == CHILD_RUNNING) {
                continue;
            }
            take_in(&works[numbers[i]], &children[i]);
            done++;
            numbers[i] = next < count ? next : count;
            if (next < count) {
                children[i] = (Child){0};
                is_going = start(workers, &works[next++], &children[i], err);
            }
        }
    }
    for (size_t i = 0; i < places; i++) {
        child_kill(&children[i]);
    }
    free(numbers);
    free(children);
    return is_going;
}
