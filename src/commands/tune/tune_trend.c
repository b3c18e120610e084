// Finds the order with which the errors of one scheme fall, and what it rules out.
//
//     p = log(e1 / e2) / log(v1 / v2)      of errors e1, e2 at the values v1 > v2
// Two such orders, one after the other over three trials, have to agree. An error at a value v
// beyond the last one is then at least
//     e2 (v / v2)^(p + m) / MISS,   m = max(MARGIN, 2 |p' - p|)
#include "commands/tune/tune_trend.h"

#include <limits.h>
#include <math.h>

// settings between two trials: an error taken as a maximum over samples scatters by some
// hundredths, which over one setting would be an order of .2
static const int SETTINGS_APART = 3;

// errors above this no longer follow the step
static const double ERROR_MOST = 1.0;

// two orders that differ by more, or one that is lower, are none
static const double TREND_AGREEMENT = 0.25;
static const double TREND_LEAST = 0.5;

// by how much a later order may be higher, and an error below the trend
static const double MARGIN = 0.05;
static const double MISS = 1.1;

// of orders that agree this well the next error is known to some hundredths
static const double EVEN = 0.1;

static const double TREND_STEPS_A_DECADE = 10.0; // of the grid, tune_value

// The finest trial of a scheme with an error that follows the step, at an index or a coarser one.
static const TuneTrial *trial_before(const Tune *tune, size_t scheme, int index)
{
    const TuneTrial *finest = NULL;
    for (size_t i = 0; i < tune->trial_count; i++) {
        const TuneTrial *trial = &tune->trials[i];
        if (trial->scheme == scheme && trial->index <= index && trial->error > 0.0 &&
            trial->error < ERROR_MOST && (finest == NULL || trial->index > finest->index)) {
            finest = trial;
        }
    }
    return finest;
}

static double order_between(const TuneTrial *coarse, const TuneTrial *fine)
{
    return log(coarse->error / fine->error) / log(coarse->value / fine->value);
}

TuneTrend tune_trend_of(const Tune *tune, size_t scheme)
{
    // the finest first
    const TuneTrial *trials[4] = {NULL};
    int index = INT_MAX;
    size_t count = 0;
    while (count < 4 && (trials[count] = trial_before(tune, scheme, index)) != NULL) {
        index = trials[count++]->index - SETTINGS_APART;
    }
    if (count < 3) {
        return (TuneTrend){.is_known = false};
    }
    const double first = order_between(trials[2], trials[1]);
    const double last = order_between(trials[1], trials[0]);
    const double spread = fabs(last - first);
    const double before = count == 4 ? order_between(trials[3], trials[2]) : NAN;
    return (TuneTrend){
        .is_known = fmin(first, last) >= TREND_LEAST && spread <= TREND_AGREEMENT,
        .order = fmax(first, last),
        .spread = spread,
        .is_even = fmax(first, last) - before <= EVEN && before - fmin(first, last) <= EVEN &&
                   spread <= EVEN,
    };
}

int tune_trend_ahead(const Tune *tune, TuneTrend trend, double error)
{
    const double order = trend.order + fmax(MARGIN, 2.0 * trend.spread);
    const double ahead = TREND_STEPS_A_DECADE / order * log10(error / (MISS * tune->target));
    return ahead > 1.0 ? (int)ceil(ahead) : 1;
}

bool tune_trend_may_precede(const Tune *tune, TuneTrend trend, double error)
{
    return error * pow(10.0, trend.order / TREND_STEPS_A_DECADE) <= MISS * tune->target;
}

bool tune_trend_confirms(const Tune *tune, size_t scheme)
{
    const TuneTrend trend = tune_trend_of(tune, scheme);
    return tune->schemes[scheme].scheme.stepping == ODE_PLAIN && trend.is_known && trend.is_even;
}
