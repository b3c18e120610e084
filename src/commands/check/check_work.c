// How are the runs of a check made side by side, and none at another's risk?
#include "commands/check/check_work.h"

#include "base/clock.h"
#include "measure/child.h"
#include "measure/task.h"

#include <assert.h>
#include <stdio.h>
#include <stdlib.h>

static const double PAUSE_S = 0.2; // between two signs of life

// Works and the children that do them.
typedef struct Pool {
    const CheckWorkers *workers;
    CheckWork *works;
    size_t count;
    bool *is_begun; // by work
    size_t places;
    size_t *numbers; // of the work in each place; the count where it has none
    Child *children; // by place
    size_t running;
} Pool;

static void measure(const void *context, void *result)
{
    const CheckWork *work = context;
    Scenario scenario = *work->scenario;
    check_measure_start(&scenario, work->start);
    check_measure(&scenario, &work->plan, result);
}

static void take_in(CheckWork *work, const Child *child)
{
    work->is_over = true;
    work->wall_s = clock_now_s() - child->started_s;
    if (child->end != CHILD_DONE) {
        char words[CHILD_TEXT_SIZE];
        child_describe(child, words);
        work->measure->is_complete = false;
        work->measure->count = 0;
        snprintf(work->measure->message, sizeof work->measure->message, "its process %s", words);
    }
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

// How far it has come. Works that run count as half done.
static CheckWorkState state_of(const Pool *pool)
{
    CheckWorkState state = {.total = pool->count};
    double left = 0.0;
    double expected = 0.0;
    const Scenario *scenario = NULL;
    for (size_t i = 0; i < pool->count; i++) {
        const CheckWork *work = &pool->works[i];
        const double share = work->is_over ? 0.0 : pool->is_begun[i] ? 0.5 : 1.0;
        state.done += work->is_over ? 1 : 0;
        // works of one case stand together
        if (work->scenario != scenario) {
            scenario = work->scenario;
            expected = expected_wall(pool->works, pool->count, scenario);
        }
        left += share * expected;
    }
    state.left_s = left / (double)(pool->places > 0 ? pool->places : 1);
    return state;
}

// The next work to begin: the own starts of all cases first, for what they take tells what the
// others will. The count where there is none.
static size_t next_work(Pool *pool)
{
    for (int round = 0; round < 2; round++) {
        for (size_t i = 0; i < pool->count; i++) {
            const bool is_own = pool->works[i].start.member == 0;
            if (!pool->works[i].is_over && !pool->is_begun[i] && (is_own || round == 1)) {
                pool->is_begun[i] = true;
                return i;
            }
        }
    }
    return pool->count;
}

// Gives a free place its next work, if there is one.
static bool fill_place(Pool *pool, size_t place, Err *err)
{
    pool->children[place] = (Child){0};
    const size_t number = next_work(pool);
    pool->numbers[place] = number;
    if (number == pool->count) {
        return true;
    }
    const CheckWorkers *workers = pool->workers;
    const ChildLimits limits = {.time_s = workers->time_limit_s, .memory_bytes = TASK_MEMORY_LIMIT};
    CheckWork *work = &pool->works[number];
    pool->running++;
    return child_start(&pool->children[place], measure, work, work->measure, sizeof *work->measure,
                       limits, err);
}

// Takes in what has ended, and fills its places.
static bool turn_over(Pool *pool, Err *err)
{
    bool is_going = true;
    for (size_t i = 0; i < pool->places && is_going; i++) {
        if (pool->numbers[i] == pool->count || pool->children[i].end == CHILD_RUNNING) {
            continue;
        }
        CheckWork *work = &pool->works[pool->numbers[i]];
        take_in(work, &pool->children[i]);
        pool->running--;
        const CheckWorkers *workers = pool->workers;
        is_going = (workers->keep == NULL || !work->measure->is_complete ||
                    workers->keep(work, workers->context, err)) &&
                   fill_place(pool, i, err);
    }
    return is_going;
}

bool check_work_do(const CheckWorkers *workers, CheckWork *works, size_t count, Err *err)
{
    Pool pool = {.workers = workers, .works = works, .count = count};
    pool.places = workers->jobs < count ? workers->jobs : count;
    pool.children = calloc(pool.places + 1, sizeof *pool.children);
    pool.numbers = calloc(pool.places + 1, sizeof *pool.numbers);
    pool.is_begun = calloc(count + 1, sizeof *pool.is_begun);
    assert(pool.children != NULL && pool.numbers != NULL && pool.is_begun != NULL);
    bool is_going = true;
    for (size_t i = 0; i < pool.places && is_going; i++) {
        is_going = fill_place(&pool, i, err);
    }
    while (is_going && pool.running > 0) {
        const CheckWorkState state = state_of(&pool);
        if (!workers->wait(&state, workers->context)) {
            break;
        }
        child_wait(pool.children, pool.places, PAUSE_S);
        is_going = turn_over(&pool, err);
    }
    for (size_t i = 0; i < pool.places; i++) {
        child_kill(&pool.children[i]);
    }
    free(pool.is_begun);
    free(pool.numbers);
    free(pool.children);
    return is_going;
}
