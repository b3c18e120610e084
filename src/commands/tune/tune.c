// Which setting is to be tried next, and what do the trials say?
//
// Values of the grid: the R10 series of ISO 3, v(n) = 10^(-n/10) in preferred numbers. A trial at
// index n with error e > X rules out those m that would need a higher order than p:
//     m - n <= (10 / p) log10(e / (SLACK X))
// with p above any order that the stepping has. What is left is tried from coarse to fine, so that
// the first two neighbours that meet X are the cheapest of the scheme on the grid, however unevenly
// the errors fall.
#include "commands/tune/tune.h"

#include "base/sorted.h"

#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { STEPS_A_DECADE = 10 };

static const double PREFERRED[STEPS_A_DECADE] = {1.0,  8.0, 6.3, 5.0, 4.0,
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
static const double SAME = 1.01;

// a decade finer must take a third off the error, by its median, once a run takes as long as this,
// s
static const double STALL_GAIN = 0.67;
static const double STALL_S = 0.5;

double tune_value(int index)
{
    const int within = ((index % STEPS_A_DECADE) + STEPS_A_DECADE) % STEPS_A_DECADE;
    const int decade = (index - within) / STEPS_A_DECADE + (within > 0 ? 1 : 0);
    char digits[64];
    // from its decimal digits, so that a reader of them gets the same number
    snprintf(digits, sizeof digits, "%.4ge%d", PREFERRED[within], -decade);
    return strtod(digits, NULL);
}

int tune_index_below(double value)
{
    int index = (int)floor(-STEPS_A_DECADE * log10(value)) - 1;
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
    tune->samples = scenario_sample_count(scenario);
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
    const double error = error_of_run(&run->error, tune->truth.is_limited);
    const char *why = NULL;
    if (!run->is_complete) {
        why = run->message;
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
    const double ahead = STEPS_A_DECADE / order * log10(error / (SLACK * tune->target));
    return ahead > 1.0 ? (int)floor(ahead) : 1;
}

// Whether the trials of the last decade are hardly better than those of the decade before.
static bool has_stalled(const Tune *tune, const TuneTrial *last)
{
    double before[STEPS_A_DECADE];
    double since[STEPS_A_DECADE];
    size_t before_count = 0;
    size_t since_count = 0;
    for (size_t i = 0; i < tune->trial_count; i++) {
        const TuneTrial *trial = &tune->trials[i];
        const int back = last->index - trial->index;
        if (trial->scheme != last->scheme || !isfinite(trial->error) || back < 0) {
            continue;
        }
        if (back < STEPS_A_DECADE && since_count < STEPS_A_DECADE) {
            since[since_count++] = trial->error;
        } else if (back < 2 * STEPS_A_DECADE && before_count < STEPS_A_DECADE) {
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

void tune_take(Tune *tune, size_t scheme, int index, const LadderRun *run)
{
    const int number = (int)tune->trial_count;
    const TuneTrial *trial = add_trial(tune, scheme, index, tune_value(index), run);
    TuneScheme *owner = &tune->schemes[scheme];
    // the first that meets the target waits for its finer neighbour
    if (trial->meets && owner->pending != TUNE_NONE) {
        owner->best = owner->pending;
        owner->outcome = TUNE_MEETS;
    } else {
        owner->pending = trial->meets ? number : TUNE_NONE;
        owner->next = index + (trial->meets ? 1 : indices_ahead(tune, owner, trial->error));
        owner->outcome = !trial->meets && has_stalled(tune, trial) ? TUNE_STALLED : owner->outcome;
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
static int choose(const Tune *tune, const Scenario *scenario, bool is_plain)
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
            if (pass == 1 && trial->error <= SAME * least &&
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
    tune->winner = choose(tune, scenario, false);
    tune->plain = choose(tune, scenario, true);
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
