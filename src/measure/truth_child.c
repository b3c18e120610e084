// How is the truth had without its dangers?
#include "measure/truth_child.h"

#include "measure/child.h"
#include "measure/task.h"
#include "measure/truth_pack.h"

#include <assert.h>
#include <stdlib.h>

static const double PAUSE_S = 0.2; // between two signs of life

// True where the child came back whole.
static bool certify(const TruthChild *work, void *packed, size_t size, Err *err)
{
    Task *task = calloc(1, sizeof *task);
    assert(task != NULL);
    task->scenario = *work->scenario;
    const ChildLimits limits = {.time_s = TASK_TRUTH_RUNS * work->run_limit_s,
                                .memory_bytes = TASK_MEMORY_LIMIT};
    Child child = {0};
    bool is_done = child_start(&child, task_certify, task, packed, size, limits, err);
    while (is_done && child.end == CHILD_RUNNING) {
        work->wait("making and certifying the reference", work->context);
        child_wait(&child, 1, PAUSE_S);
        if (work->should_stop != NULL && work->should_stop(work->context)) {
            child_kill(&child);
            is_done = err_set(err, ERR_SOLVER, "stopped");
        }
    }
    if (is_done && child.end != CHILD_DONE) {
        char words[CHILD_TEXT_SIZE];
        child_describe(&child, words);
        is_done =
            err_set(err, ERR_SOLVER, "there is no truth to compare with: its process %s", words);
    }
    free(task);
    return is_done;
}

bool truth_child_make(const TruthChild *work, Truth *truth, Err *err)
{
    const size_t size = truth_pack_size(work->scenario);
    void *packed = malloc(size);
    assert(packed != NULL);
    *truth = (Truth){.trajectory = NULL};
    bool is_made = certify(work, packed, size, err);
    if (is_made) {
        *truth = truth_pack_read(work->scenario, packed);
        is_made = truth->trajectory->is_complete ||
                  err_set(err, ERR_SOLVER, "there is no truth to compare with: %s",
                          truth->trajectory->message);
    }
    if (!is_made) {
        truth_finish(truth);
    }
    free(packed);
    return is_made;
}
