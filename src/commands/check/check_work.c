// Makes the runs of a check side by side in child processes, and shows their progress.
#include "commands/check/check_work.h"
#include "base/clock.h"
#include "base/text.h"
#include "measure/child.h"
#include "measure/task.h"

#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

// Works that are being done.
typedef struct Doing {
    const CheckWorkers *workers;
    CheckWork *works;
    size_t count;
    bool *is_begun; // by work
} Doing;

static void check_work_measure(const void *context, void *result)
{
    const CheckWork *work = context;
    Scenario scenario = scenario_copy(work->scenario);
    check_measure_start(&scenario, work->start);
    CheckMeasure made = {.is_complete = false};
    check_measure(&scenario, &work->plan, &made);
    check_measure_pack(&made, result, check_measure_packed_size(work->scenario));
    check_measure_finish(&made);
    scenario_free(&scenario);
}

static bool check_work_take(void *owner, size_t number, const void *result, const Child *child,
                            Err *err)
{
    const Doing *doing = owner;
    CheckWork *work = &doing->works[number];
    work->is_over = true;
    work->wall_s = clock_now_s() - child->started_s;
    if (child->end != CHILD_DONE) {
        char words[CHILD_TEXT_SIZE];
        child_describe(child, words);
        work->measure->is_complete = false;
        work->measure->count = 0;
        snprintf(work->measure->message, sizeof work->measure->message, "its process %s", words);
        return true;
    }
    check_measure_finish(work->measure);
    *work->measure = check_measure_unpack(result);
    const CheckWorkers *workers = doing->workers;
    return workers->keep == NULL || !work->measure->is_complete ||
           workers->keep(work, workers->context, err);
}

// What a start takes: as the mean of those of its case, else of all. 0 where none was measured.
static double expected_wall(const CheckWork *works, size_t count, const Scenario *scenario)
{
    double sums[2] = {0.0, 0.0};
    size_t counts[2] = {0, 0};
    for (size_t i = 0; i < count; i++) {
        const int kind = works[i].scenario == scenario ? 0 : 1;
        sums[kind] += works[i].wall_s;
        counts[kind] += works[i].wall_s > 0.0 ? 1 : 0;
    }
    const int kind = counts[0] > 0 ? 0 : 1;
    return counts[kind] > 0 ? sums[kind] / (double)counts[kind] : 0.0;
}

// Says how far it has come. Works that run count as half done.
static bool check_work_wait(void *owner)
{
    const Doing *doing = owner;
    CheckWorkState state = {.total = doing->count};
    double left = 0.0;
    double expected = 0.0;
    const Scenario *scenario = NULL;
    for (size_t i = 0; i < doing->count; i++) {
        const CheckWork *work = &doing->works[i];
        const double share = work->is_over ? 0.0 : doing->is_begun[i] ? 0.5 : 1.0;
        state.done += work->is_over ? 1 : 0;
        // works of one case stand together
        if (work->scenario != scenario) {
            scenario = work->scenario;
            expected = expected_wall(doing->works, doing->count, scenario);
        }
        left += share * expected;
    }
    const size_t jobs = doing->workers->jobs < doing->count ? doing->workers->jobs : doing->count;
    state.left_s = left / (double)(jobs > 0 ? jobs : 1);
    return doing->workers->wait(&state, doing->workers->context);
}

// The own starts of all cases come first, for what they take tells what the others will.
static bool check_work_next(void *owner, size_t *number, const void **context)
{
    Doing *doing = owner;
    for (int round = 0; round < 2; round++) {
        for (size_t i = 0; i < doing->count; i++) {
            const CheckWork *work = &doing->works[i];
            const bool is_own = work->start.member == 0;
            if (!work->is_over && !doing->is_begun[i] && (is_own || round == 1)) {
                doing->is_begun[i] = true;
                *number = i;
                *context = work;
                return true;
            }
        }
    }
    return false;
}

static size_t largest_result(const CheckWork *works, size_t count)
{
    size_t largest = sizeof(CheckMeasure);
    for (size_t i = 0; i < count; i++) {
        const size_t size = works[i].is_over ? 0 : check_measure_packed_size(works[i].scenario);
        largest = size > largest ? size : largest;
    }
    return largest;
}

bool check_work_do(const CheckWorkers *workers, CheckWork *works, size_t count, Err *err)
{
    Doing doing = {workers, works, count, calloc(count + 1, sizeof *doing.is_begun)};
    assert(doing.is_begun != NULL);
    const Pool pool = {
        .jobs = workers->jobs,
        .work = check_work_measure,
        .result_size = largest_result(works, count),
        .takes_no_memory = true,
        .limits = {.time_s = workers->time_limit_s, .memory_bytes = TASK_MEMORY_LIMIT},
        .next = check_work_next,
        .take = check_work_take,
        .wait = check_work_wait,
        .owner = &doing,
    };
    const bool is_going = pool_run(&pool, err);
    free(doing.is_begun);
    return is_going;
}

// The progress.

CheckProgress check_progress_start(const char *doing, bool is_quiet)
{
    return (CheckProgress){.doing = doing, .line = status_line_start(is_quiet)};
}

void check_progress_show(CheckProgress *progress, const CheckWorkState *state)
{
    const double wall_s = status_line_time(&progress->line);
    // what is left is that of this case alone
    const bool is_last = progress->case_number >= progress->case_count;
    const double left_s = is_last && state->left_s > 0.0 ? state->left_s : INFINITY;
    if (!status_line_is_due(&progress->line, wall_s, left_s)) {
        return;
    }
    Text words;
    text_init(&words);
    if (progress->case_count > 1) {
        text_append(&words, "case %zu of %zu, ", progress->case_number, progress->case_count);
    }
    text_append(&words, "%s: ", progress->doing);
    if (state->total == 0) {
        text_append(&words, "making and certifying the reference");
    } else {
        text_append(&words, "%zu of %zu starts", state->done, state->total);
    }
    text_append(&words, ", %.0f s", wall_s);
    status_line_append_left(&words, state->left_s);
    status_line_show(&progress->line, words.data);
    text_finish(&words);
}

void check_progress_end(CheckProgress *progress)
{
    status_line_end(&progress->line);
}
