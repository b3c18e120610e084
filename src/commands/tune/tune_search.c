// In which order are settings run, and when is enough known?
//
// Uniform-cost search: of all schemes' next settings always the cheapest is run. A scheme ends
// where two neighbours meet the target, or where its next setting costs more than the best one
// found: then nothing on the grid that has not been run, or ruled out by order, can be cheaper.
#include "commands/tune/tune_search.h"

#include "base/clock.h"
#include "commands/tune/tune_held.h"
#include "commands/tune/tune_linear.h"
#include "commands/tune/tune_pool.h"
#include "measure/truth_child.h"

#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

// steps of one run: some minutes
static const double STEPS_MOST = 1e8;

// rates are not exact: what costs less than this over the best is still run
static const double PRUNE_MARGIN = 1.3;

// whoever keeps an unchanged loop pays for it, but a search for that answer has to end: s, a run
static const double PLAIN_LIMIT_S = 5.0;

// schemes dearer than this over the best by their trials are not timed
static const double FINALIST = 2.5;

static const double TOLERANCE_LEAST = 1e-9; // what the case file allows of run.tolerance

Task tune_search_task(const TuneSearch *search, LadderKind kind, const Truth *truth, size_t scheme,
                      double value)
{
    Task task = {
        .scenario = *search->scenario,
        .backend = BACKEND_ODE,
        .run = {.kind = kind},
        .truth = truth,
    };
    tune_apply(&search->tune->schemes[scheme], value, &task.scenario);
    return task;
}

// One pass of the search: over which schemes, and how long a run may take.
typedef struct Pass {
    const char *doing;
    bool is_in[SCHEME_MAX];
    double limit_s;
} Pass;

// The least cost of a setting that meets the target, among the schemes of a pass.
static double best_cost(const Tune *tune, const Pass *pass)
{
    double best = INFINITY;
    for (int i = 0; i < (int)tune->scheme_count; i++) {
        const TuneTrial *trial = pass->is_in[i] ? tune_best(tune, i) : NULL;
        best = trial != NULL ? fmin(best, tune_trial_cost(tune, trial)) : best;
    }
    return best;
}

static bool is_too_long(const TuneSearch *search, const Pass *pass, size_t scheme)
{
    const TuneScheme *owner = &search->tune->schemes[scheme];
    const double value = tune_value(owner->next);
    if (!scheme_has_step(&owner->scheme)) {
        return value < TOLERANCE_LEAST;
    }
    const double steps = scenario_duration(search->scenario) / value;
    return steps > STEPS_MOST || tune_time(search->tune, scheme, owner->next) > pass->limit_s;
}

// The scheme of the pass whose next setting is the cheapest, or TUNE_NONE; ends those that are
// done.
static int choose(const TuneSearch *search, const Pass *pass)
{
    Tune *tune = search->tune;
    const double best = best_cost(tune, pass);
    int chosen = TUNE_NONE;
    double least = INFINITY;
    for (int i = 0; i < (int)tune->scheme_count; i++) {
        TuneScheme *scheme = &tune->schemes[i];
        if (!pass->is_in[i] || scheme->is_busy || scheme->fate != TUNE_OPEN) {
            continue;
        }
        const double cost = tune_cost(tune, (size_t)i, scheme->next);
        const double margin = tune->cost == TUNE_TIME ? PRUNE_MARGIN : 1.0;
        // one that waits for its neighbour is judged by what it costs itself
        const double own = scheme->pending != TUNE_NONE
                               ? tune_trial_cost(tune, &tune->trials[scheme->pending])
                               : cost;
        if (own > margin * best) {
            scheme->fate = TUNE_DEARER;
        } else if (is_too_long(search, pass, (size_t)i)) {
            scheme->fate = TUNE_TOO_LONG;
        } else if (cost < least) {
            least = cost;
            chosen = i;
        }
    }
    return chosen;
}

static bool run_pass(const TuneSearch *search, const Truth *truth, const Pass *pass, Err *err)
{
    Tune *tune = search->tune;
    TunePool pool;
    tune_pool_init(&pool, search->jobs, search->time_limit_s);
    bool is_going = true;
    int next = choose(search, pass);
    while (is_going && (next != TUNE_NONE || pool.busy > 0)) {
        while (is_going && next != TUNE_NONE && tune_pool_has_place(&pool)) {
            TuneScheme *scheme = &tune->schemes[next];
            const Task task = tune_search_task(search, LADDER_ERROR, truth, (size_t)next,
                                               tune_value(scheme->next));
            is_going = tune_pool_start(&pool, &task, (size_t)next, err);
            scheme->is_busy = is_going;
            next = choose(search, pass);
        }
        search->wait(pass->doing, search->context);
        size_t tag;
        LadderRun run;
        while (is_going && pool.busy > 0 && tune_pool_take(&pool, &tag, &run)) {
            tune->schemes[tag].is_busy = false;
            tune_take(tune, tag, tune->schemes[tag].next, &run);
        }
        next = choose(search, pass);
    }
    tune_pool_finish(&pool);
    return is_going;
}

static bool search_all(const TuneSearch *search, const Truth *truth, Err *err)
{
    Pass pass = {.doing = "searching", .limit_s = search->time_limit_s};
    for (size_t i = 0; i < search->tune->scheme_count; i++) {
        pass.is_in[i] = true;
    }
    return run_pass(search, truth, &pass, err);
}

// Goes on with the plain rows alone, where none of them has met the target: some users have a loop
// of their own and want nothing but numbers.
static bool search_plain(const TuneSearch *search, const Truth *truth, Err *err)
{
    Tune *tune = search->tune;
    Pass pass = {.doing = "searching plain rows",
                 .limit_s = fmin(PLAIN_LIMIT_S, search->time_limit_s)};
    for (size_t i = 0; i < tune->scheme_count; i++) {
        pass.is_in[i] = tune_is_plain_row(tune, search->scenario, i);
    }
    if (isfinite(best_cost(tune, &pass))) {
        return true;
    }
    for (size_t i = 0; i < tune->scheme_count; i++) {
        if (pass.is_in[i] && tune->schemes[i].fate == TUNE_DEARER) {
            tune->schemes[i].fate = TUNE_OPEN;
        }
    }
    return run_pass(search, truth, &pass, err);
}

// The finest setting of each scheme that is within the limit, where it has not been run: what can
// be had for that cost.
static bool search_within(const TuneSearch *search, const Truth *truth, Err *err)
{
    Tune *tune = search->tune;
    const double most = tune->cost == TUNE_STEPS ? (double)tune->limit.steps : tune->limit.time_s;
    TunePool pool;
    tune_pool_init(&pool, search->jobs, search->time_limit_s);
    bool is_going = true;
    for (size_t i = 0; i < tune->scheme_count && is_going; i++) {
        TuneScheme *scheme = &tune->schemes[i];
        int notch = scheme->first;
        while (tune_cost(tune, i, notch + 1) <= most && notch < scheme->next + 30 &&
               scheme_has_step(&scheme->scheme)) {
            notch++;
        }
        bool is_known = false;
        for (size_t k = 0; k < tune->trial_count; k++) {
            is_known = is_known || (tune->trials[k].scheme == i && tune->trials[k].notch == notch);
        }
        if (is_known || scheme->trials == 0) {
            continue;
        }
        const Task task = tune_search_task(search, LADDER_ERROR, truth, i, tune_value(notch));
        is_going = tune_pool_start(&pool, &task, i, err);
        size_t tag;
        LadderRun run;
        while (is_going && pool.busy > 0) {
            search->wait("looking at what the cost allows", search->context);
            if (tune_pool_take(&pool, &tag, &run)) {
                const TuneScheme kept = *scheme;
                tune_take(tune, tag, notch, &run);
                // a look aside: the search itself stays where it was
                scheme->fate = kept.fate;
                scheme->next = kept.next;
                scheme->pending = kept.pending;
                scheme->best = kept.best;
            }
        }
    }
    tune_pool_finish(&pool);
    return is_going;
}

static bool is_finalist(const Tune *tune, int scheme, double best)
{
    const TuneTrial *trial = tune_best(tune, scheme);
    return trial != NULL && tune_trial_cost(tune, trial) <= FINALIST * best;
}

// Times the finalists in turn, one run at a time, so that whatever slows the machine down slows
// all.
static bool time_finalists(const TuneSearch *search, const Truth *truth, Err *err)
{
    Tune *tune = search->tune;
    const TuneTrial *winner = tune_best(tune, tune->winner);
    const double best = winner != NULL ? tune_trial_cost(tune, winner) : INFINITY;
    TunePool pool;
    tune_pool_init(&pool, 1, search->time_limit_s);
    bool is_going = true;
    for (size_t round = 0; round < TUNE_REPEATS; round++) {
        for (int i = 0; i < (int)tune->scheme_count && is_going; i++) {
            TuneScheme *scheme = &tune->schemes[i];
            if (!is_finalist(tune, i, best)) {
                continue;
            }
            const Task task = tune_search_task(search, LADDER_TIMING, truth, (size_t)i,
                                               tune_best(tune, i)->value);
            is_going = tune_pool_start(&pool, &task, (size_t)i, err);
            size_t tag;
            LadderRun run;
            while (is_going && pool.busy > 0) {
                search->wait("timing the finalists", search->context);
                if (tune_pool_take(&pool, &tag, &run) && run.is_complete) {
                    scheme->processor_s[scheme->timed] = run.processor_s;
                    scheme->wall_s[scheme->timed++] = run.wall_s;
                }
            }
        }
    }
    tune_pool_finish(&pool);
    return is_going;
}

// Whether errors can be told from the truth's own at all.
static bool check_target(const Tune *tune, Err *err)
{
    const LadderTruth *truth = &tune->truth;
    if (truth->message[0] != '\0') {
        return err_set(err, ERR_SOLVER, "errors cannot be told: the reference is not certified: %s",
                       truth->message);
    }
    const double least = ERROR_CLEAR_OF_TRUTH * truth->uncertainty;
    return tune->target >= least ||
           err_set(err, ERR_USAGE,
                   "--error %.3g is below ten times the uncertainty of the reference, %.2g; "
                   "allowed: %.2g or more, or a reference.tolerance below that of the case",
                   tune->target, truth->uncertainty, least);
}

// All schemes at the step that is held; where none meets the target, the longest step that does.
static bool search_held(const TuneSearch *search, const Truth *truth, Err *err)
{
    Tune *tune = search->tune;
    bool is_done = tune_held_run(search, truth, err);
    tune_conclude(tune, search->scenario);
    if (is_done && !tune_is_met_held(tune)) {
        is_done = search_all(search, truth, err);
        tune_conclude(tune, search->scenario);
    }
    return is_done;
}

// The cheapest setting of all.
static bool search_cheapest(const TuneSearch *search, const Truth *truth, Err *err)
{
    Tune *tune = search->tune;
    bool is_done = search_all(search, truth, err) && search_plain(search, truth, err);
    if (is_done && (tune->limit.steps > 0 || tune->limit.time_s > 0.0)) {
        is_done = search_within(search, truth, err);
    }
    tune_conclude(tune, search->scenario);
    is_done = is_done && time_finalists(search, truth, err);
    tune_conclude(tune, search->scenario);
    return is_done;
}

bool tune_search_execute(const TuneSearch *search, Err *err)
{
    Tune *tune = search->tune;
    const TruthChild work = {.scenario = search->scenario,
                             .run_limit_s = search->time_limit_s,
                             .wait = search->wait,
                             .context = search->context};
    const double started_s = clock_now_s();
    Truth truth = {.trajectory = NULL};
    bool is_done = truth_child_make(&work, &truth, err);
    if (is_done) {
        tune->truth = ladder_truth_of(&truth, clock_now_s() - started_s);
    }
    is_done = is_done && check_target(tune, err) &&
              (tune->held_s > 0.0 ? search_held(search, &truth, err)
                                  : search_cheapest(search, &truth, err)) &&
              tune_linear_run(search, &truth, err);
    truth_finish(&truth);
    return is_done;
}
