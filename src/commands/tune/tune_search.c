// Searches for the cheapest setting of ODE that meets an error, and times the reference beside it.
//
// Uniform-cost search: of all schemes' next settings always the cheapest is run. A scheme ends
// where two neighbours meet the target, or where its next setting costs more than the best one
// found: then nothing on the grid that has not been run, or ruled out by order, can be cheaper.
#include "commands/tune/tune_search.h"
#include "base/clock.h"
#include "base/sorted.h"
#include "commands/tune/tune.h"
#include "commands/tune/tune_export.h"
#include "commands/tune/tune_linear.h"
#include "commands/tune/tune_model.h"
#include "commands/tune/tune_runs.h"
#include "measure/task.h"
#include "write/json_value.h"
#include "write/number.h"
#include "write/units.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>

// The cost of the reference for the error asked for, without ODE.
//
// Its error depends on reference.tolerance as a scheme's does on the step, so it is searched for in
// the same way, from loose to tight, two to a decade, until two neighbours meet the target.

// the loosest one that has an effect, and the others
static const double TOLERANCES[] = {3e-5, 1e-5, 3e-6,  1e-6,  3e-7,  1e-7,  3e-8,  1e-8,
                                    3e-9, 1e-9, 3e-10, 1e-10, 3e-11, 1e-11, 3e-12, 1e-12};

enum { TOLERANCE_COUNT = sizeof TOLERANCES / sizeof TOLERANCES[0] };

typedef struct Looking {
    Tune *tune;
    double least;            // tolerance of the truth
    size_t next;             // tolerance to be run
    bool is_busy;            // it is being run
    TuneReference candidate; // the last one, if it met the target
    bool is_done;            // so did the next tighter one
    double times_s[TUNE_REPEATS];
    size_t timed;
} Looking;

static bool choose_tolerance(void *owner, size_t *number)
{
    Looking *looking = owner;
    if (looking->is_busy || looking->is_done || looking->next == TOLERANCE_COUNT ||
        !(TOLERANCES[looking->next] > looking->least)) {
        return false;
    }
    looking->is_busy = true;
    *number = looking->next;
    return true;
}

static void apply_tolerance(void *owner, size_t number, Scenario *scenario)
{
    (void)owner;
    scenario->reference.tolerance = TOLERANCES[number];
}

static void take_error(void *owner, size_t number, const LadderRun *run)
{
    Looking *looking = owner;
    const Tune *tune = looking->tune;
    char reason[LADDER_MESSAGE_SIZE];
    const double error = tune_error(tune, run, reason);
    const bool meets = error + tune->truth.uncertainty <= tune->target;
    looking->is_busy = false;
    looking->next++;
    looking->is_done = meets && looking->candidate.tolerance > 0.0;
    if (!looking->is_done) {
        looking->candidate =
            meets ? (TuneReference){.tolerance = TOLERANCES[number], .error = error, .run = *run}
                  : (TuneReference){.tolerance = 0.0};
    }
}

static void apply_found(void *owner, size_t number, Scenario *scenario)
{
    (void)number;
    scenario->reference.tolerance = ((const Looking *)owner)->tune->reference.tolerance;
}

static void take_time(void *owner, size_t number, const LadderRun *run)
{
    (void)number;
    Looking *looking = owner;
    if (run->is_complete) {
        looking->times_s[looking->timed++] = run->processor_s;
    }
}

static bool time_found(const TuneSearch *search, Looking *looking, Err *err)
{
    const TuneRuns runs = {.doing = "timing the reference",
                           .count = TUNE_REPEATS,
                           .is_timing = true,
                           .is_reference = true,
                           .apply = apply_found,
                           .take = take_time,
                           .owner = looking};
    if (!tune_runs_make(search, &runs, err)) {
        return false;
    }
    sorted_make(looking->times_s, looking->timed);
    looking->tune->reference.processor_median_s =
        looking->timed > 0 ? sorted_median(looking->times_s, looking->timed) : NAN;
    return true;
}

// Searches for the loosest reference.tolerance that meets the target, the next tighter one as well,
// and times it. Finds none where the truth's own tolerance would be needed.
static bool tune_reference_run(const TuneSearch *search, Err *err)
{
    Tune *tune = search->tune;
    Looking looking = {.tune = tune, .least = search->scenario->reference.tolerance};
    const TuneRuns runs = {.doing = "running the reference",
                           .is_reference = true,
                           .apply = apply_tolerance,
                           .take = take_error,
                           .choose = choose_tolerance,
                           .owner = &looking};
    if (!tune_runs_make(search, &runs, err)) {
        return false;
    }
    if (!looking.is_done) {
        return true;
    }
    tune->reference = looking.candidate;
    return time_found(search, &looking, err);
}

void tune_reference_write(const TuneReport *report, const Style *style, Text *text)
{
    const Tune *tune = report->tune;
    const TuneReference *reference = &tune->reference;
    const TuneTrial *best = tune_best(tune, tune->winner);
    if (!(reference->tolerance > 0.0)) {
        return;
    }
    text_append(text,
                "\n%sWithout ODE%s\n\n"
                "  The reference meets the error, too, where no world of ODE is needed:\n"
                "  setting     reference, tolerance %s\n"
                "  error       %.3g\n"
                "  cost        %zu evaluations, %.4g ms of the processor",
                style->heading, style->end, number_shortest(reference->tolerance).text,
                reference->error, reference->run.evaluations,
                reference->processor_median_s * UNITS_MS);
    if (best != NULL) {
        text_append(text, ", %.3g of the setting's above",
                    reference->processor_median_s / tune_setting_time(tune, best));
    }
    text_append(text,
                "\n  in a case   run.backends=[reference]\n"
                "              reference.tolerance=%s\n",
                number_shortest(reference->tolerance).text);
}

json_t *tune_reference_object(const TuneReport *report)
{
    const TuneReference *reference = &report->tune->reference;
    if (!(reference->tolerance > 0.0)) {
        return json_null();
    }
    json_t *object = json_object();
    json_value_set(object, "tolerance", reference->tolerance);
    json_value_set(object, "error_max", reference->error);
    json_object_set_new(object, "evaluations",
                        json_integer((json_int_t)reference->run.evaluations));
    json_value_set(object, "processor_median_s", reference->processor_median_s);
    json_object_set_new(object, "hash", json_sprintf("%016" PRIx64, reference->run.hash));
    return object;
}

// steps of one run: some minutes
static const double STEPS_MOST = 1e8;

// rates are not exact: what costs less than this over the best is still run
static const double PRUNE_MARGIN = 1.3;

// s, of one run of a plain row: these may be slow, and the search must end
static const double PLAIN_LIMIT_S = 5.0;

// schemes dearer than this over the best by their trials are not timed
static const double FINALIST = 2.5;

static const double TOLERANCE_LEAST = 1e-9; // what the case file allows of run.tolerance

// One pass of the search: over which schemes, and how long a run may take.
typedef struct Pass {
    const TuneSearch *search;
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

static bool is_too_long(const Pass *pass, size_t scheme)
{
    const TuneSearch *search = pass->search;
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
static int tune_search_choose(const Pass *pass)
{
    Tune *tune = pass->search->tune;
    const double best = best_cost(tune, pass);
    int chosen = TUNE_NONE;
    double least = INFINITY;
    for (int i = 0; i < (int)tune->scheme_count; i++) {
        TuneScheme *scheme = &tune->schemes[i];
        if (!pass->is_in[i] || scheme->is_busy || scheme->outcome != TUNE_OPEN) {
            continue;
        }
        const double cost = tune_cost(tune, (size_t)i, scheme->next);
        const double margin = tune->cost == TUNE_TIME ? PRUNE_MARGIN : 1.0;
        // one that waits for its neighbour is judged by what it costs itself
        const double own = scheme->pending != TUNE_NONE
                               ? tune_trial_cost(tune, &tune->trials[scheme->pending])
                               : cost;
        if (own > margin * best) {
            scheme->outcome = TUNE_COSTLIER;
        } else if (is_too_long(pass, (size_t)i)) {
            scheme->outcome = TUNE_TOO_LONG;
        } else if (cost < least) {
            least = cost;
            chosen = i;
        }
    }
    return chosen;
}

static bool choose_next(void *owner, size_t *number)
{
    const Pass *pass = owner;
    const int chosen = tune_search_choose(pass);
    if (chosen != TUNE_NONE) {
        pass->search->tune->schemes[chosen].is_busy = true;
        *number = (size_t)chosen;
    }
    return chosen != TUNE_NONE;
}

static void apply_next(void *owner, size_t number, Scenario *scenario)
{
    const TuneScheme *scheme = &((const Pass *)owner)->search->tune->schemes[number];
    tune_apply(scheme, tune_value(scheme->next), scenario);
}

static void take_next(void *owner, size_t number, const LadderRun *run)
{
    Tune *tune = ((const Pass *)owner)->search->tune;
    tune->schemes[number].is_busy = false;
    tune_take(tune, number, tune->schemes[number].next, run);
}

// What a pass has before it.
static TuneLeft pass_left(const Pass *pass, bool is_reopened)
{
    const Tune *tune = pass->search->tune;
    TuneLeft left = {.best = best_cost(tune, pass),
                     .margin = tune->cost == TUNE_TIME ? PRUNE_MARGIN : 1.0,
                     .limit_s = pass->limit_s,
                     .is_reopened = is_reopened};
    memcpy(left.is_in, pass->is_in, sizeof left.is_in);
    return left;
}

static Pass plain_pass(const TuneSearch *search)
{
    Pass pass = {.search = search, .limit_s = fmin(PLAIN_LIMIT_S, search->time_limit_s)};
    for (size_t i = 0; i < search->tune->scheme_count; i++) {
        pass.is_in[i] = tune_is_plain_row(search->tune, search->scenario, i);
    }
    return pass;
}

// With the plain rows that come after it, where none of them has met the target by then.
static double tune_search_time_left(void *owner)
{
    const Pass *pass = owner;
    const Tune *tune = pass->search->tune;
    const TuneLeft own = pass_left(pass, false);
    double left_s = tune_left(tune, &own);
    if (pass->limit_s == pass->search->time_limit_s && tune->held_s == 0.0) {
        const Pass plain = plain_pass(pass->search);
        const TuneLeft next = pass_left(&plain, true);
        left_s += isfinite(next.best) ? 0.0 : tune_left(tune, &next);
    }
    return left_s;
}

static bool run_pass(Pass *pass, const char *doing, Err *err)
{
    const TuneRuns runs = {.doing = doing,
                           .apply = apply_next,
                           .take = take_next,
                           .owner = pass,
                           .choose = choose_next,
                           .left = tune_search_time_left};
    return tune_runs_make(pass->search, &runs, err);
}

static bool search_all(const TuneSearch *search, Err *err)
{
    Pass pass = {.search = search, .limit_s = search->time_limit_s};
    for (size_t i = 0; i < search->tune->scheme_count; i++) {
        pass.is_in[i] = true;
    }
    return run_pass(&pass, "searching", err);
}

// Goes on with the plain rows alone, where none of them has met the target: some users have a loop
// of their own and want nothing but numbers.
static bool search_plain(const TuneSearch *search, Err *err)
{
    Tune *tune = search->tune;
    Pass pass = plain_pass(search);
    if (isfinite(best_cost(tune, &pass))) {
        return true;
    }
    for (size_t i = 0; i < tune->scheme_count; i++) {
        if (pass.is_in[i] && tune->schemes[i].outcome == TUNE_COSTLIER) {
            tune->schemes[i].outcome = TUNE_OPEN;
        }
    }
    return run_pass(&pass, "searching plain rows", err);
}

// Settings that are run one after another.
typedef struct Settings {
    Tune *tune;
    size_t count;
    size_t schemes[SCHEME_MAX];
    int indices[SCHEME_MAX]; // on the grid
} Settings;

static void add_setting(Settings *settings, size_t scheme, int index)
{
    settings->schemes[settings->count] = scheme;
    settings->indices[settings->count++] = index;
}

static void apply_setting(void *owner, size_t number, Scenario *scenario)
{
    const Settings *settings = owner;
    const size_t i = number % settings->count;
    tune_apply(&settings->tune->schemes[settings->schemes[i]], tune_value(settings->indices[i]),
               scenario);
}

// The index of the finest setting of a scheme that is within the limit.
static int find_within(const Tune *tune, size_t scheme)
{
    const TuneScheme *owner = &tune->schemes[scheme];
    const double most = tune->cost == TUNE_STEPS ? (double)tune->limit.steps : tune->limit.time_s;
    int index = owner->first;
    while (tune_cost(tune, scheme, index + 1) <= most && index < owner->next + 30 &&
           scheme_has_step(&owner->scheme)) {
        index++;
    }
    return index;
}

static bool is_run(const Tune *tune, size_t scheme, int index)
{
    for (size_t i = 0; i < tune->trial_count; i++) {
        if (tune->trials[i].scheme == scheme && tune->trials[i].index == index) {
            return true;
        }
    }
    return false;
}

static void take_within(void *owner, size_t number, const LadderRun *run)
{
    const Settings *settings = owner;
    TuneScheme *scheme = &settings->tune->schemes[settings->schemes[number]];
    const TuneScheme kept = *scheme;
    tune_take(settings->tune, settings->schemes[number], settings->indices[number], run);
    // the search itself goes on as before
    scheme->outcome = kept.outcome;
    scheme->next = kept.next;
    scheme->pending = kept.pending;
    scheme->best = kept.best;
}

// The finest setting of each scheme that is within the limit, where it has not been run: what can
// be had for that cost.
static bool search_within(const TuneSearch *search, Err *err)
{
    const Tune *tune = search->tune;
    Settings settings = {.tune = search->tune};
    for (size_t i = 0; i < tune->scheme_count; i++) {
        const int index = find_within(tune, i);
        if (tune->schemes[i].trials > 0 && !is_run(tune, i, index)) {
            add_setting(&settings, i, index);
        }
    }
    const TuneRuns runs = {"looking at what the cost allows", settings.count, apply_setting,
                           take_within, .owner = &settings};
    return tune_runs_make(search, &runs, err);
}

static void take_timing(void *owner, size_t number, const LadderRun *run)
{
    const Settings *settings = owner;
    TuneScheme *scheme = &settings->tune->schemes[settings->schemes[number % settings->count]];
    if (run->is_complete) {
        scheme->processor_s[scheme->timed] = run->processor_s;
        scheme->wall_s[scheme->timed++] = run->wall_s;
    }
}

// Times the finalists in turn, one run at a time, so that whatever slows the machine down slows
// all.
static bool time_finalists(const TuneSearch *search, Err *err)
{
    Tune *tune = search->tune;
    const TuneTrial *winner = tune_best(tune, tune->winner);
    const double best = winner != NULL ? tune_trial_cost(tune, winner) : INFINITY;
    Settings finalists = {.tune = tune};
    for (size_t i = 0; i < tune->scheme_count; i++) {
        const TuneTrial *trial = tune_best(tune, (int)i);
        if (trial != NULL && tune_trial_cost(tune, trial) <= FINALIST * best) {
            add_setting(&finalists, i, trial->index);
        }
    }
    const TuneRuns runs = {"timing the finalists", TUNE_REPEATS * finalists.count,
                           apply_setting,          take_timing,
                           .owner = &finalists,    .is_timing = true};
    return tune_runs_make(search, &runs, err);
}

// Whether the target can be told from the reference's uncertainty.
static bool tune_search_check_target(const Tune *tune, Err *err)
{
    const LadderTruth *truth = &tune->truth;
    if (truth->message[0] != '\0') {
        return err_set(err, ERR_SOLVER,
                       "errors cannot be measured: the reference is not certified: %s",
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
static bool search_held(const TuneSearch *search, Err *err)
{
    Tune *tune = search->tune;
    bool is_done = tune_held_run(search, err);
    tune_conclude(tune, search->scenario);
    if (is_done && !tune_is_met_held(tune)) {
        is_done = search_all(search, err);
        tune_conclude(tune, search->scenario);
    }
    return is_done;
}

// The cheapest setting of all.
static bool search_cheapest(const TuneSearch *search, Err *err)
{
    Tune *tune = search->tune;
    bool is_done = search_all(search, err) && search_plain(search, err);
    if (is_done && (tune->limit.steps > 0 || tune->limit.time_s > 0.0)) {
        is_done = search_within(search, err);
    }
    tune_conclude(tune, search->scenario);
    is_done = is_done && time_finalists(search, err);
    tune_conclude(tune, search->scenario);
    return is_done && tune_reference_run(search, err);
}

static void tune_search_wait_for_truth(const char *doing, void *context)
{
    const TuneSearch *search = context;
    search->wait(doing, INFINITY, search->context);
}

bool tune_search_execute(const TuneSearch *asked, Err *err)
{
    Tune *tune = asked->tune;
    Truth truth = {.trajectory = NULL};
    TuneSearch search = *asked;
    search.truth = &truth;
    const TruthChild work = {.scenario = asked->scenario,
                             .run_limit_s = asked->time_limit_s,
                             .wait = tune_search_wait_for_truth,
                             .context = &search};
    const double started_s = clock_now_s();
    bool is_done = truth_child_make(&work, &truth, err);
    if (is_done) {
        truth.uncertainty = truth_uncertainty_of(&truth, asked->scenario, tune->of,
                                                 truth.is_limited ? truth.horizon_s : INFINITY,
                                                 (RunWatch){.progress = NULL});
        tune->truth = ladder_truth_of(&truth, clock_now_s() - started_s);
    }
    is_done = is_done && tune_search_check_target(tune, err) &&
              (tune->held_s > 0.0 ? search_held(&search, err) : search_cheapest(&search, err)) &&
              tune_linear_run(&search, err);
    const TuneReport report = {.scenario = search.scenario, .tune = tune};
    TuneMujoco mujoco;
    if (is_done && tune->asked[TUNE_FILE_MJCF] != TUNE_UNASKED && !tune->contact.is_limit &&
        tune_mujoco_find(&report, &mujoco)) {
        tune_model_run(&search, mujoco.step_s);
    }
    truth_finish(&truth);
    return is_done;
}
