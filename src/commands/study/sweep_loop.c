// How does a sweep proceed?
//
// fill the slots -> wait -> take in what has ended -> commit now and then -> report.
#include "base/clock.h"
#include "commands/study/sweep_pool.h"

#include <assert.h>
#include <math.h>

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

static bool keep(SweepPool *pool, Times *times, Err *err)
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

static bool go_on(SweepPool *pool, Times *times, SweepEnd *end, Err *err)
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
        if (!sweep_pool_take(pool, err) || !keep(pool, times, err)) {
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
    const bool is_done = go_on(&pool, &times, end, err);
    report(sweep, state, &times);
    sweep_pool_close(&pool);
    return is_done;
}
