// Computes the reference in a child process, so that a crash cannot take the program down.
#include "measure/truth_child.h"

#include "measure/pool.h"
#include "measure/task.h"
#include "measure/truth_pack.h"

#include <assert.h>
#include <stdlib.h>

typedef struct Making {
    const TruthChild *work;
    Task *task;
    Truth *truth;
    bool is_begun;
    bool is_stopped;
} Making;

static bool next(void *owner, size_t *number, const void **context)
{
    Making *making = owner;
    *number = 0;
    *context = making->task;
    const bool is_first = !making->is_begun;
    making->is_begun = true;
    return is_first;
}

static bool take(void *owner, size_t number, const void *packed, const Child *child, Err *err)
{
    (void)number;
    Making *making = owner;
    if (child->end != CHILD_DONE) {
        char words[CHILD_TEXT_SIZE];
        child_describe(child, words);
        return err_set(err, ERR_SOLVER, "there is no reference to compare with: its process %s",
                       words);
    }
    *making->truth = truth_pack_read(making->work->scenario, packed);
    const Trajectory *trajectory = making->truth->trajectory;
    return trajectory->is_complete ||
           err_set(err, ERR_SOLVER, "there is no reference to compare with: %s",
                   trajectory->message);
}

static bool wait(void *owner)
{
    Making *making = owner;
    const TruthChild *work = making->work;
    making->is_stopped = work->should_stop != NULL && work->should_stop(work->context);
    work->wait("making and certifying the reference", work->context);
    return !making->is_stopped;
}

bool truth_child_make(const TruthChild *work, Truth *truth, Err *err)
{
    Making making = {.work = work, .task = calloc(1, sizeof *making.task), .truth = truth};
    assert(making.task != NULL);
    making.task->scenario = *work->scenario;
    *truth = (Truth){.trajectory = NULL};
    const Pool pool = {
        .jobs = 1,
        .work = task_certify_alone,
        .result_size = truth_pack_size(work->scenario),
        .limits = {.time_s = TASK_TRUTH_RUNS * work->run_limit_s,
                   .memory_bytes = TASK_MEMORY_LIMIT},
        .next = next,
        .take = take,
        .wait = wait,
        .owner = &making,
    };
    bool is_made = pool_run(&pool, err);
    if (making.is_stopped) {
        is_made = err_set(err, ERR_SOLVER, "stopped");
    }
    if (!is_made) {
        truth_finish(truth);
    }
    free(making.task);
    return is_made;
}
