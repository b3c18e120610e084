// The state of a search for the cheapest setting: its grid, its trials, costs and time left.
//
// Values of the grid: the R10 series of ISO 3, v(n) = 10^(-n/10) in preferred numbers. A trial at
// index n with error e > X rules out those m that would need a higher order than p:
//     m - n <= (10 / p) log10(e / (SLACK X))
// with p above any order that the stepping has. What is left is tried from coarse to fine, so that
// the first two neighbours that meet X are the cheapest of the scheme on the grid, however unevenly
// the errors fall.
#include "commands/tune/tune.h"
#include "base/shell.h"
#include "base/sorted.h"
#include "casefile/input.h"
#include "write/number.h"
#include "write/units.h"

#include <assert.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// The cost of a setting on a machine that does other things as well.
//
// Times of single runs are noise; work is not:
//     work = N + E / 20 + S / 4,   N world steps, E evaluations of contact forces, S samples
// and a scheme's rate, s of the processor per unit of work, is the least of its runs. Cost = work *
// rate.

// what else a run does beside world steps, in steps of some 1.3 us, as measured
static const double WORK_OF_EVALUATION = 0.05;
static const double WORK_OF_SAMPLE = 0.25;

// with more than this multiple of its samples' work a run is mostly steps
static const double TELLING_WORK = 3.0;

// no scheme takes longer for its work than this times what the fastest takes for its own
static const double RATE_SPREAD = 2.5;

static double work_of(const Tune *tune, double steps, double evaluations)
{
    return steps + WORK_OF_EVALUATION * evaluations + WORK_OF_SAMPLE * (double)tune->samples;
}

// The least time per unit of work among the runs of a scheme, or of all (TUNE_NONE), s: whatever
// else the machine does only adds to it. Of a scheme's own, runs that mostly set up and sample are
// left out.
static double least_rate(const Tune *tune, int scheme)
{
    double least = INFINITY;
    for (size_t i = 0; i < tune->trial_count; i++) {
        const LadderRun *run = &tune->trials[i].run;
        const double work = work_of(tune, (double)run->steps, (double)run->evaluations);
        const bool is_telling = work > TELLING_WORK * WORK_OF_SAMPLE * (double)tune->samples;
        if (run->is_complete &&
            (scheme == TUNE_NONE || ((int)tune->trials[i].scheme == scheme && is_telling))) {
            least = fmin(least, run->processor_s / work);
        }
    }
    return least;
}

static double tune_rate_of(const Tune *tune, size_t scheme)
{
    const double own = least_rate(tune, (int)scheme);
    const double all = least_rate(tune, TUNE_NONE);
    return isinf(own) ? all : fmin(own, RATE_SPREAD * all);
}

static bool tune_cost_is_timed(const Tune *tune, const TuneTrial *trial)
{
    const TuneScheme *owner = &tune->schemes[trial->scheme];
    return owner->best != TUNE_NONE && trial == &tune->trials[owner->best] &&
           isfinite(owner->processor_least_s);
}

// The time of a run, s: the least where it was timed, or what its work comes to.
static double tune_time_of(const Tune *tune, const TuneTrial *trial)
{
    if (tune_cost_is_timed(tune, trial)) {
        return tune->schemes[trial->scheme].processor_least_s;
    }
    // one that chooses its step makes a reference first, which is no work of world steps
    const bool has_step = scheme_has_step(&tune->schemes[trial->scheme].scheme);
    return has_step && trial->run.is_complete
               ? tune_rate_of(tune, trial->scheme) *
                     work_of(tune, (double)trial->run.steps, (double)trial->run.evaluations)
               : trial->run.processor_s;
}

double tune_trial_cost(const Tune *tune, const TuneTrial *trial)
{
    return tune->cost == TUNE_LENGTH  ? 1.0 / trial->value
           : tune->cost == TUNE_STEPS ? (double)trial->run.steps
                                      : tune_time_of(tune, trial);
}

// The finest trial of a scheme that ended whole, or NULL. What is unstable, and so has no error,
// costs what it likes: many a finer step costs less.
static const TuneTrial *find_finest(const Tune *tune, size_t scheme)
{
    const TuneTrial *finest = NULL;
    for (size_t i = 0; i < tune->trial_count; i++) {
        const TuneTrial *trial = &tune->trials[i];
        if (trial->scheme == scheme && trial->run.is_complete && isfinite(trial->error) &&
            (finest == NULL || trial->index > finest->index)) {
            finest = trial;
        }
    }
    return finest;
}

// World steps of a setting, at the least: from a tolerance they cannot be known.
static double steps_at(const Tune *tune, const TuneTrial *finest, int index)
{
    const bool has_step = scheme_has_step(&tune->schemes[finest->scheme].scheme);
    return (double)finest->run.steps * (has_step ? finest->value / tune_value(index) : 1.0);
}

double tune_time(const Tune *tune, size_t scheme, int index)
{
    const TuneTrial *finest = find_finest(tune, scheme);
    if (finest != NULL && !scheme_has_step(&tune->schemes[scheme].scheme)) {
        return finest->run.processor_s;
    }
    return finest == NULL
               ? 0.0
               : tune_rate_of(tune, scheme) *
                     work_of(tune, steps_at(tune, finest, index), (double)finest->run.evaluations);
}

double tune_cost(const Tune *tune, size_t scheme, int index)
{
    if (tune->cost == TUNE_LENGTH) {
        return 1.0 / tune_value(index);
    }
    const TuneTrial *finest = find_finest(tune, scheme);
    if (tune->cost == TUNE_TIME || finest == NULL) {
        return tune_time(tune, scheme, index);
    }
    return steps_at(tune, finest, index);
}

bool tune_is_within(const Tune *tune, const TuneTrial *trial)
{
    const TuneLimit *limit = &tune->limit;
    return (limit->steps == 0 || trial->run.steps <= limit->steps) &&
           (limit->time_s == 0.0 || tune_time_of(tune, trial) <= limit->time_s);
}

enum { TUNE_STEPS_A_DECADE = 10 };

static const double PREFERRED[TUNE_STEPS_A_DECADE] = {1.0,  8.0, 6.3, 5.0, 4.0,
                                                      3.15, 2.5, 2.0, 1.6, 1.25};

// the coarsest step: this many in a run or in a turn of the drive, whichever is shorter
static const double COARSEST_STEPS = 20.0;

// the coarsest tolerance, over the target: chosen steps aim below it, and mostly get there
static const double COARSEST_TOLERANCE = 6.0;

// what the case file allows of run.tolerance
static const double TOLERANCE_MOST = 0.1;

// errors may be below the trend by this factor
static const double SLACK = 4.0;

// orders that no stepping exceeds between one trial and the next, contacts coming and going
static const double ORDER_PLAIN = 2.0;
static const double ORDER_STAGGERED = 6.0;

// of settings this close in cost the first in the list: noise must not choose
static const double TIE = 1.1;

// errors this close are the same
static const double EQUAL_ERROR_RATIO = 1.01;

// a decade finer must take a third off the error, by its median, once a run takes as long as this,
// s
static const double STALL_GAIN = 0.67;
static const double STALL_S = 0.5;

// a run that takes longer than this, s, is worth others before it that may rule it out
static const double DEAR_S = 0.25;

// settings between runs that an order is to be observed from
static const int PROBE_LEAST = 3;

double tune_value(int index)
{
    const int within = ((index % TUNE_STEPS_A_DECADE) + TUNE_STEPS_A_DECADE) % TUNE_STEPS_A_DECADE;
    const int decade = (index - within) / TUNE_STEPS_A_DECADE + (within > 0 ? 1 : 0);
    char digits[64];
    // from its decimal digits, so that a reader of them gets the same number
    snprintf(digits, sizeof digits, "%.4ge%d", PREFERRED[within], -decade);
    return strtod(digits, NULL);
}

int tune_index_below(double value)
{
    int index = (int)floor(-TUNE_STEPS_A_DECADE * log10(value)) - 1;
    while (tune_value(index) > value) {
        index++;
    }
    return index;
}

static int first_index(const Scenario *scenario, const Scheme *scheme, double target)
{
    if (!scheme_has_step(scheme)) {
        return tune_index_below(fmin(TOLERANCE_MOST, COARSEST_TOLERANCE * target));
    }
    const double duration_s = scenario_duration(scenario);
    const double turn_s = drive_is_steady(&scenario->linkage.driver)
                              ? linkage_period(&scenario->linkage)
                              : duration_s;
    return tune_index_below(fmin(duration_s, turn_s) / COARSEST_STEPS);
}

static void add_scheme(Tune *tune, const Scenario *scenario, const Scheme *scheme)
{
    TuneScheme *added = &tune->schemes[tune->scheme_count++];
    *added = (TuneScheme){
        .scheme = *scheme,
        .pending = TUNE_NONE,
        .best = TUNE_NONE,
        .least = TUNE_NONE,
        .wall_median_s = NAN,
        .processor_median_s = NAN,
        .processor_least_s = NAN,
        .first = first_index(scenario, scheme, tune->target),
    };
    added->next = added->first;
    if (!scheme_has_step(scheme)) {
        snprintf(added->scheme.name, sizeof added->scheme.name, "auto");
    }
}

Tune *tune_create(const Scenario *scenario, const Scheme *schemes, size_t scheme_count,
                  double target)
{
    Tune *tune = calloc(1, sizeof *tune);
    assert(tune != NULL);
    tune->target = target;
    tune->of = scenario->run.tolerance_of;
    tune->samples = scenario_sample_count(scenario);
    tune->dear_s = DEAR_S;
    tune->winner = tune->plain = tune->within = TUNE_NONE;
    tune->held = tune->held_plain = tune->linear = tune->row = TUNE_NONE;
    bool has_chosen = false;
    for (size_t i = 0; i < scheme_count; i++) {
        const bool is_chosen = !scheme_has_step(&schemes[i]);
        if (schemes[i].backend == BACKEND_ODE && !(is_chosen && has_chosen)) {
            add_scheme(tune, scenario, &schemes[i]);
            has_chosen = has_chosen || is_chosen;
        }
    }
    return tune;
}

void tune_destroy(Tune *tune)
{
    if (tune != NULL) {
        free(tune->trials);
        free(tune->model.text);
        free(tune);
    }
}

void tune_apply(const TuneScheme *scheme, double value, Scenario *scenario)
{
    Scheme setting = scheme->scheme;
    if (!scheme_has_step(&setting)) {
        setting.tolerance = value;
    }
    scheme_apply(&setting, value, scenario);
}

bool tune_is_plain_row(const Tune *tune, const Scenario *scenario, size_t scheme)
{
    const Scheme *data = &tune->schemes[scheme].scheme;
    return scheme_has_step(data) && scenario_has_clearance(scenario) &&
           data->stepping == ODE_PLAIN && data->solver == ODE_DIRECT;
}

double tune_error(const Tune *tune, const LadderRun *run, char reason[LADDER_MESSAGE_SIZE])
{
    const double error = error_of_kind(&run->error, tune->of, tune->truth.is_limited);
    const char *why = NULL;
    if (!run->is_complete) {
        why = run->message;
    } else if (run->error.is_known && isnan(error)) {
        why = "has no error of what was asked: only its motion is known";
    } else if (!run->error.is_known || !isfinite(error)) {
        why = "has no error: its numbers are not finite";
    } else {
        why = error_is_unstable(&run->error, tune->truth.is_limited);
    }
    snprintf(reason, LADDER_MESSAGE_SIZE, "%s", why != NULL ? why : "");
    return why != NULL ? NAN : error;
}

// How many indices further an error can meet the target at best.
static int indices_ahead(const Tune *tune, const TuneScheme *scheme, double error)
{
    const Scheme *data = &scheme->scheme;
    const bool is_first_order = scheme_has_step(data) && data->stepping == ODE_PLAIN;
    const double order = !scheme_has_step(data) ? 1.0
                         : is_first_order       ? ORDER_PLAIN
                                                : ORDER_STAGGERED;
    if (isnan(error)) {
        return 1;
    }
    const double ahead = TUNE_STEPS_A_DECADE / order * log10(error / (SLACK * tune->target));
    return ahead > 1.0 ? (int)floor(ahead) : 1;
}

// Whether the trials of the last decade are hardly better than those of the decade before.
static bool has_stalled(const Tune *tune, const TuneTrial *last)
{
    double before[TUNE_STEPS_A_DECADE];
    double since[TUNE_STEPS_A_DECADE];
    size_t before_count = 0;
    size_t since_count = 0;
    for (size_t i = 0; i < tune->trial_count; i++) {
        const TuneTrial *trial = &tune->trials[i];
        const int back = last->index - trial->index;
        if (trial->scheme != last->scheme || !isfinite(trial->error) || back < 0) {
            continue;
        }
        if (back < TUNE_STEPS_A_DECADE && since_count < TUNE_STEPS_A_DECADE) {
            since[since_count++] = trial->error;
        } else if (back < 2 * TUNE_STEPS_A_DECADE && before_count < TUNE_STEPS_A_DECADE) {
            before[before_count++] = trial->error;
        }
    }
    if (last->run.processor_s < STALL_S || before_count == 0 || since_count == 0) {
        return false;
    }
    sorted_make(before, before_count);
    sorted_make(since, since_count);
    // one that came near may have missed by chance
    return since[0] > SLACK * tune->target &&
           !(sorted_median(since, since_count) < STALL_GAIN * sorted_median(before, before_count));
}

// Keeps a run as a trial of its scheme.
static TuneTrial *add_trial(Tune *tune, size_t scheme, int index, double value,
                            const LadderRun *run)
{
    if (tune->trial_count == tune->trial_room) {
        tune->trial_room = 2 * tune->trial_room + 64;
        tune->trials = realloc(tune->trials, tune->trial_room * sizeof *tune->trials);
        assert(tune->trials != NULL);
    }
    const int number = (int)tune->trial_count++;
    TuneTrial *trial = &tune->trials[number];
    *trial = (TuneTrial){.scheme = scheme, .index = index, .value = value, .run = *run};
    trial->error = tune_error(tune, run, trial->reason);
    trial->meets = trial->error + tune->truth.uncertainty <= tune->target;
    TuneScheme *owner = &tune->schemes[scheme];
    owner->trials++;
    if (isfinite(trial->error) &&
        (owner->least == TUNE_NONE || trial->error < tune->trials[owner->least].error)) {
        owner->least = number;
    }
    return trial;
}

// The order with which the errors of one scheme have been seen to fall, and what it rules out.
//
//     p = log(e1 / e2) / log(v1 / v2)      of errors e1, e2 at the values v1 > v2
// Two such orders, one after the other over three trials, have to agree. An error at a value v
// beyond the last one is then at least
//     e2 (v / v2)^(p + m) / MISS,   m = max(MARGIN, 2 |p' - p|)

typedef struct Trend {
    bool is_known;
    double order;  // error ~ step^order
    double spread; // 1: by how much the two orders differ that it is taken from
    bool is_even;  // whether a third order before them agrees as well
} Trend;

// settings between two trials: an error taken as a maximum over samples scatters by some
// hundredths, which over one setting would be an order of .2
static const int SETTINGS_APART = 3;

// errors above this no longer follow the step
static const double TRIAL_ERROR_MOST = 1.0;

// two orders that differ by more, or one that is lower, are none
static const double TREND_AGREEMENT = 0.25;
static const double TREND_LEAST = 0.5;

// by how much a later order may be higher, and an error below the trend
static const double MARGIN = 0.05;
static const double MISS = 1.1;

// of orders that agree this well the next error is known to some hundredths
static const double EVEN = 0.1;

// The finest trial of a scheme with an error that follows the step, at an index or a coarser one.
static const TuneTrial *trial_before(const Tune *tune, size_t scheme, int index)
{
    const TuneTrial *finest = NULL;
    for (size_t i = 0; i < tune->trial_count; i++) {
        const TuneTrial *trial = &tune->trials[i];
        if (trial->scheme == scheme && trial->index <= index && trial->error > 0.0 &&
            trial->error < TRIAL_ERROR_MOST && (finest == NULL || trial->index > finest->index)) {
            finest = trial;
        }
    }
    return finest;
}

static double order_between(const TuneTrial *coarse, const TuneTrial *fine)
{
    return log(coarse->error / fine->error) / log(coarse->value / fine->value);
}

// Of the finest trials of a scheme.
static Trend trend_of(const Tune *tune, size_t scheme)
{
    // the finest first
    const TuneTrial *trials[4] = {NULL};
    int index = INT_MAX;
    size_t count = 0;
    while (count < 4 && (trials[count] = trial_before(tune, scheme, index)) != NULL) {
        index = trials[count++]->index - SETTINGS_APART;
    }
    if (count < 3) {
        return (Trend){.is_known = false};
    }
    const double first = order_between(trials[2], trials[1]);
    const double last = order_between(trials[1], trials[0]);
    const double spread = fabs(last - first);
    const double before = count == 4 ? order_between(trials[3], trials[2]) : NAN;
    return (Trend){
        .is_known = fmin(first, last) >= TREND_LEAST && spread <= TREND_AGREEMENT,
        .order = fmax(first, last),
        .spread = spread,
        .is_even = fmax(first, last) - before <= EVEN && before - fmin(first, last) <= EVEN &&
                   spread <= EVEN,
    };
}

// How many settings further than one with an error the target can be met at the earliest, if the
// errors go on as they fell.
static int trend_ahead(const Tune *tune, Trend trend, double error)
{
    const double order = trend.order + fmax(MARGIN, 2.0 * trend.spread);
    const double ahead = TUNE_STEPS_A_DECADE / order * log10(error / (MISS * tune->target));
    return ahead > 1.0 ? (int)ceil(ahead) : 1;
}

// Whether the setting before one with an error can meet the target.
static bool trend_may_precede(const Tune *tune, Trend trend, double error)
{
    return error * pow(10.0, trend.order / TUNE_STEPS_A_DECADE) <= MISS * tune->target;
}

// Whether the errors of plain steps fall so evenly that the setting behind one that meets the
// target does, too. Of other stepping, whose errors are small, chance has its share in them.
static bool trend_confirms(const Tune *tune, size_t scheme)
{
    const Trend trend = trend_of(tune, scheme);
    return tune->schemes[scheme].scheme.stepping == ODE_PLAIN && trend.is_known && trend.is_even;
}

// Whether a setting takes so long that runs before it which may rule it out are worth theirs.
static bool is_dear(const Tune *tune, size_t scheme, int index)
{
    return scheme_has_step(&tune->schemes[scheme].scheme) &&
           tune_time(tune, scheme, index) > tune->dear_s;
}

// The index to go to from a trial that misses the target. Where that is a long run, by the order
// that was observed, or where none was yet, half way, to observe one.
static int index_after(const Tune *tune, TuneScheme *owner, const TuneTrial *trial)
{
    const int ahead = indices_ahead(tune, owner, trial->error);
    const size_t scheme = trial->scheme;
    if (isnan(trial->error) || !is_dear(tune, scheme, trial->index + ahead)) {
        return trial->index + ahead;
    }
    const Trend trend = trend_of(tune, scheme);
    const int by_order = trend.is_known ? trend_ahead(tune, trend, trial->error) : 0;
    owner->is_by_order = owner->is_by_order || by_order > ahead;
    return trial->index + (trend.is_known            ? (int)fmax(ahead, by_order)
                           : ahead > 2 * PROBE_LEAST ? ahead / 2
                                                     : ahead);
}

static bool has_trial(const Tune *tune, size_t scheme, int index)
{
    bool is_run = false;
    for (size_t i = 0; i < tune->trial_count && !is_run; i++) {
        is_run = tune->trials[i].scheme == scheme && tune->trials[i].index == index;
    }
    return is_run;
}

// Whether the setting before a trial that meets the target was ruled out by order, and by this
// trial's error should not have been.
static bool goes_back(const Tune *tune, const TuneTrial *trial)
{
    return tune->schemes[trial->scheme].is_by_order &&
           !has_trial(tune, trial->scheme, trial->index - 1) &&
           trend_may_precede(tune, trend_of(tune, trial->scheme), trial->error);
}

static void end_scheme(TuneScheme *owner, int best)
{
    owner->best = best;
    owner->outcome = TUNE_MEETS;
}

// The first that meets the target waits for its finer neighbour, but where the errors of long runs
// fall so evenly that there is no need to.
static void take_first(const Tune *tune, TuneScheme *owner, int number)
{
    const TuneTrial *trial = &tune->trials[number];
    owner->pending = number;
    owner->is_going_back = goes_back(tune, trial);
    owner->next = trial->index + (owner->is_going_back ? -1 : 1);
    if (!owner->is_going_back && is_dear(tune, trial->scheme, owner->next) &&
        trend_confirms(tune, trial->scheme)) {
        owner->is_by_order = true;
        end_scheme(owner, number);
    }
}

// One before the first that met the target.
static void take_back(const Tune *tune, TuneScheme *owner, int number)
{
    const TuneTrial *trial = &tune->trials[number];
    const TuneTrial *pending = &tune->trials[owner->pending];
    if (trial->meets) {
        owner->pending = number;
        owner->next = trial->index - 1;
        if (!goes_back(tune, trial)) {
            end_scheme(owner, number);
        }
        return;
    }
    owner->is_going_back = false;
    owner->next = pending->index + 1;
    if (has_trial(tune, pending->scheme, owner->next)) {
        end_scheme(owner, owner->pending);
    }
}

void tune_take(Tune *tune, size_t scheme, int index, const LadderRun *run)
{
    const int number = (int)tune->trial_count;
    const TuneTrial *trial = add_trial(tune, scheme, index, tune_value(index), run);
    TuneScheme *owner = &tune->schemes[scheme];
    if (owner->is_going_back) {
        take_back(tune, owner, number);
    } else if (trial->meets && owner->pending != TUNE_NONE) {
        end_scheme(owner, owner->pending);
    } else if (trial->meets) {
        take_first(tune, owner, number);
    } else {
        owner->pending = TUNE_NONE;
        owner->next = index_after(tune, owner, trial);
        owner->outcome = has_stalled(tune, trial) ? TUNE_STALLED : owner->outcome;
    }
}

void tune_hold(Tune *tune, double step_s)
{
    assert(tune->trial_count == 0);
    tune->held_s = step_s;
    tune->cost = TUNE_LENGTH;
    size_t kept = 0;
    for (size_t i = 0; i < tune->scheme_count; i++) {
        if (scheme_has_step(&tune->schemes[i].scheme)) {
            tune->schemes[kept++] = tune->schemes[i];
        }
    }
    tune->scheme_count = kept;
    int below = tune_index_below(step_s);
    below += tune_value(below) < step_s ? 0 : 1;
    for (size_t i = 0; i < kept; i++) {
        tune->schemes[i].first = tune->schemes[i].next = below;
    }
}

void tune_take_held(Tune *tune, size_t scheme, const LadderRun *run)
{
    // it comes before all indices of a later search
    add_trial(tune, scheme, tune->schemes[scheme].first - 1, tune->held_s, run);
}

bool tune_is_met_held(const Tune *tune)
{
    return tune->held != TUNE_NONE && tune->trials[tune->held].meets;
}

const TuneTrial *tune_best(const Tune *tune, int scheme)
{
    return scheme == TUNE_NONE || tune->schemes[scheme].best == TUNE_NONE
               ? NULL
               : &tune->trials[tune->schemes[scheme].best];
}

// The cheapest among all schemes, or the plain rows alone; of those as cheap the first.
static int tune_choose(const Tune *tune, const Scenario *scenario, bool is_plain)
{
    double least = INFINITY;
    for (int pass = 0; pass < 2; pass++) {
        for (int i = 0; i < (int)tune->scheme_count; i++) {
            const TuneTrial *best = tune_best(tune, i);
            if (best == NULL || (is_plain && !tune_is_plain_row(tune, scenario, (size_t)i))) {
                continue;
            }
            const double cost = tune_trial_cost(tune, best);
            if (pass == 1 && cost <= (tune->cost == TUNE_TIME ? TIE : 1.0) * least) {
                return i;
            }
            least = fmin(least, cost);
        }
    }
    return TUNE_NONE;
}

static double median_of(const double *values, size_t count)
{
    double sorted[TUNE_REPEATS];
    memcpy(sorted, values, count * sizeof *sorted);
    sorted_make(sorted, count);
    return sorted_median(sorted, count);
}

// The trial of the least error at the step that is held, of all schemes or of plain rows alone; of
// equal ones the first in the list.
static int choose_held(const Tune *tune, const Scenario *scenario, bool is_plain)
{
    double least = INFINITY;
    int chosen = TUNE_NONE;
    for (int pass = 0; pass < 2; pass++) {
        for (int i = 0; i < (int)tune->trial_count; i++) {
            const TuneTrial *trial = &tune->trials[i];
            if (trial->value != tune->held_s || !isfinite(trial->error) ||
                (is_plain && !tune_is_plain_row(tune, scenario, trial->scheme))) {
                continue;
            }
            if (pass == 1 && trial->error <= EQUAL_ERROR_RATIO * least &&
                (chosen == TUNE_NONE || trial->scheme < tune->trials[chosen].scheme)) {
                chosen = i;
            }
            least = fmin(least, trial->error);
        }
    }
    return chosen;
}

void tune_conclude(Tune *tune, const Scenario *scenario)
{
    for (size_t i = 0; i < tune->scheme_count; i++) {
        TuneScheme *scheme = &tune->schemes[i];
        if (scheme->timed > 0) {
            scheme->wall_median_s = median_of(scheme->wall_s, scheme->timed);
            scheme->processor_median_s = median_of(scheme->processor_s, scheme->timed);
            scheme->processor_least_s = INFINITY;
            for (size_t k = 0; k < scheme->timed; k++) {
                scheme->processor_least_s = fmin(scheme->processor_least_s, scheme->processor_s[k]);
            }
        }
    }
    tune->winner = tune_choose(tune, scenario, false);
    tune->plain = tune_choose(tune, scenario, true);
    tune->held = choose_held(tune, scenario, false);
    tune->held_plain = choose_held(tune, scenario, true);
    tune->within = TUNE_NONE;
    for (int i = 0; i < (int)tune->trial_count; i++) {
        const TuneTrial *trial = &tune->trials[i];
        if (isfinite(trial->error) && tune_is_within(tune, trial) &&
            (tune->within == TUNE_NONE || trial->error < tune->trials[tune->within].error)) {
            tune->within = i;
        }
    }
}

// The time that a search will still take.
//
// Of a scheme with the errors e1, e2 at the values v1 > v2 the target is met at
//     v = v2 (target / e2)^(1/p),   p = log(e1 / e2) / log(v1 / v2)
// and the settings from its next one to v, and one more that confirms it, are still to be run,
// unless they cost more than the best that meets the target, or than the best that is to be
// expected.

static const double ORDER_AT_FIRST = 1.0; // of one error alone
static const double ORDER_LEAST = 0.5;    // what falls more slowly has stalled, or will fall
static const double ORDER_MOST = 6.0;
static const double TUNE_LEFT_STEPS_A_DECADE = 10.0; // of the grid, tune_value
static const double FINER_MOST = 60.0;               // of them: six decades

// The finest trial of a scheme with an error, above an index; NULL where there is none.
static const TuneTrial *find_trial(const Tune *tune, size_t scheme, int below)
{
    const TuneTrial *finest = NULL;
    for (size_t i = 0; i < tune->trial_count; i++) {
        const TuneTrial *trial = &tune->trials[i];
        if (trial->scheme == scheme && trial->index < below && trial->error > 0.0 &&
            (finest == NULL || trial->index > finest->index)) {
            finest = trial;
        }
    }
    return finest;
}

// The index of the last setting of a scheme that has to be run.
static int last_index(const Tune *tune, size_t scheme)
{
    const TuneScheme *owner = &tune->schemes[scheme];
    const TuneTrial *fine = find_trial(tune, scheme, owner->next + 1);
    if (fine == NULL) {
        return owner->next;
    }
    const TuneTrial *coarse = find_trial(tune, scheme, fine->index);
    double order = ORDER_AT_FIRST;
    if (coarse != NULL) {
        order = log(coarse->error / fine->error) / log(coarse->value / fine->value);
        order = fmin(fmax(order, ORDER_LEAST), ORDER_MOST);
    }
    const double decades = log10(fmax(fine->error / tune->target, 1.0)) / order;
    return fine->index + (int)ceil(fmin(TUNE_LEFT_STEPS_A_DECADE * decades, FINER_MOST)) + 1;
}

static bool goes_on(const TuneScheme *scheme, const TuneLeft *left)
{
    return scheme->trials > 0 && (scheme->outcome == TUNE_OPEN ||
                                  (left->is_reopened && scheme->outcome == TUNE_COSTLIER));
}

// The cost of the best setting that is to be expected.
static double expected_best(const Tune *tune, const TuneLeft *left)
{
    double best = left->best;
    for (size_t i = 0; i < tune->scheme_count; i++) {
        if (left->is_in[i] && goes_on(&tune->schemes[i], left)) {
            const int last = last_index(tune, i);
            if (tune_time(tune, i, last) <= left->limit_s) {
                best = fmin(best, tune_cost(tune, i, last));
            }
        }
    }
    return best;
}

// How much longer than the processor's time runs take by the clock, where other work goes on beside
// them: 1 on an idle machine.
static double slowness(const Tune *tune)
{
    double wall_s = 0.0;
    double processor_s = 0.0;
    for (size_t i = 0; i < tune->trial_count; i++) {
        wall_s += tune->trials[i].run.wall_s;
        processor_s += tune->trials[i].run.processor_s;
    }
    return processor_s > 0.0 ? fmax(1.0, wall_s / processor_s) : 1.0;
}

double tune_left(const Tune *tune, const TuneLeft *left)
{
    const double most = left->margin * expected_best(tune, left);
    double left_s = 0.0;
    for (size_t i = 0; i < tune->scheme_count; i++) {
        const bool is_going = left->is_in[i] && goes_on(&tune->schemes[i], left);
        const int last = is_going ? last_index(tune, i) : 0;
        for (int index = tune->schemes[i].next; is_going && index <= last; index++) {
            const double time_s = tune_time(tune, i, index);
            if (time_s > left->limit_s || tune_cost(tune, i, index) > most) {
                break;
            }
            left_s += time_s;
        }
    }
    return slowness(tune) * left_s;
}

// A setting in words.

// The collider, where it is another than the case's.
static void write_collider(const TuneReport *report, const Scheme *scheme, const char *separator,
                           Text *text)
{
    if (scheme->collider != report->scenario->ode.collider) {
        text_append(text, "%sode.collider=%s", separator, OPTIONS_ODE_COLLIDERS[scheme->collider]);
    }
}

void tune_setting_keys(const TuneReport *report, const TuneTrial *trial, const char *separator,
                       Text *text)
{
    const Scheme *scheme = &report->tune->schemes[trial->scheme].scheme;
    if (!scheme_has_step(scheme)) {
        text_append(text, "run.step=auto%s", separator);
        if (report->tune->of != TOLERANCE_OF_MOTION) {
            text_append(text, "run.tolerance-of=%s%s", OPTIONS_TOLERANCES_OF[report->tune->of],
                        separator);
        }
        text_append(text, "run.tolerance=");
        text_append(text, "%s", number_shortest(trial->value).text);
        write_collider(report, scheme, separator, text);
        return;
    }
    text_append(text, "run.step=");
    text_append(text, "%s", number_shortest(trial->value).text);
    text_append(text, " s%sode.solver=%s%sode.stepping=%s", separator,
                OPTIONS_ODE_SOLVERS[scheme->solver], separator,
                OPTIONS_ODE_STEPPINGS[scheme->stepping]);
    if (scenario_has_clearance(report->scenario)) {
        text_append(text, "%sode.map=%s", separator, OPTIONS_ODE_MAPS[scheme->map]);
    }
    write_collider(report, scheme, separator, text);
}

bool tune_setting_replaces(const char *override)
{
    static const char *const KEYS[] = {"run.step",   "run.tolerance", "run.backends",
                                       "ode.solver", "ode.stepping",  "ode.map"};
    const size_t length = strcspn(override, "=");
    for (size_t i = 0; i < sizeof KEYS / sizeof KEYS[0]; i++) {
        if (strlen(KEYS[i]) == length && strncmp(KEYS[i], override, length) == 0) {
            return true;
        }
    }
    return false;
}

void tune_setting_command(const TuneReport *report, const TuneTrial *trial, const char *separator,
                          Text *text)
{
    text_append(text, "jointplay run ");
    const char *path = scenario_path(report->scenario);
    shell_append_path(text, strcmp(path, INPUT_STDIN) == 0 ? "-" : path);
    for (size_t i = 0; i < report->override_count; i++) {
        if (!tune_setting_replaces(report->overrides[i])) {
            text_append(text, "%s--set ", separator);
            shell_append_word(text, report->overrides[i]);
        }
    }
    // with the reference, which the error is against
    const bool is_ideal = !scenario_has_clearance(report->scenario);
    text_append(text, "%s--set run.backends=%s", separator,
                is_ideal && scenario_has_closed_form(report->scenario)
                    ? "'[analytic, reference, ode]'"
                    : "'[reference, ode]'");
    // the program's own words, which hold no quote
    char between[TUNE_SEPARATOR_SIZE + 16];
    snprintf(between, sizeof between, "'%s--set '", separator);
    text_append(text, "%s--set '", separator);
    tune_setting_keys(report, trial, between, text);
    text_append(text, "'");
}

void tune_setting_words(const TuneReport *report, const TuneTrial *trial, Text *text)
{
    const Scheme *scheme = &report->tune->schemes[trial->scheme].scheme;
    if (scheme_has_step(scheme)) {
        text_append(text, "%s, step %.4g us", scheme->name, trial->value * UNITS_US);
    } else {
        text_append(text, "%s, step chosen for a tolerance of %.3g", scheme->name, trial->value);
    }
}

static bool tune_setting_is_timed(const Tune *tune, const TuneTrial *trial)
{
    return trial == tune_best(tune, (int)trial->scheme) &&
           isfinite(tune->schemes[trial->scheme].processor_median_s);
}

double tune_setting_time(const Tune *tune, const TuneTrial *trial)
{
    return tune_setting_is_timed(tune, trial) ? tune->schemes[trial->scheme].processor_median_s
                                              : trial->run.processor_s;
}

static void write_cost(const Tune *tune, const TuneTrial *trial, Text *text)
{
    const TuneScheme *scheme = &tune->schemes[trial->scheme];
    text_append(text, "%zu world steps, %.4g ms of the processor", trial->run.steps,
                tune_setting_time(tune, trial) * UNITS_MS);
    if (tune_setting_is_timed(tune, trial)) {
        text_append(text, ", %.4g ms by the clock (medians of %zu runs taken in turn)",
                    scheme->wall_median_s * UNITS_MS, scheme->timed);
    } else {
        text_append(text, " (one run)");
    }
}

void tune_setting_write(const TuneReport *report, const TuneTrial *trial, Text *text)
{
    text_append(text, "  setting     ");
    tune_setting_words(report, trial, text);
    text_append(text, "\n  error       %.3g\n  cost        ", trial->error);
    write_cost(report->tune, trial, text);
    text_append(text, "\n  in a case   ");
    tune_setting_keys(report, trial, "\n              ", text);
    // lines of their own, a setting each: so far in that no line is broken, which may be in a name
    text_append(text, "\n  run it\n    ");
    tune_setting_command(report, trial, " \\\n      ", text);
    text_append(text, "\n");
}
