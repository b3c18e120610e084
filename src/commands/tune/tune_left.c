// How long will a search still take?
//
// Of a scheme with the errors e1, e2 at the values v1 > v2 the target is met at
//     v = v2 (target / e2)^(1/p),   p = log(e1 / e2) / log(v1 / v2)
// and the settings from its next one to v, and one more that confirms it, are still to be run,
// unless they cost more than the best that meets the target, or than the best that is to be
// expected.
#include "commands/tune/tune_left.h"

#include <math.h>

static const double ORDER_AT_FIRST = 1.0; // of one error alone
static const double ORDER_LEAST = 0.5;    // what falls more slowly has stalled, or will fall
static const double ORDER_MOST = 6.0;
static const double STEPS_A_DECADE = 10.0; // of the grid, tune_value
static const double FINER_MOST = 60.0;     // of them: six decades

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
    return fine->index + (int)ceil(fmin(STEPS_A_DECADE * decades, FINER_MOST)) + 1;
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
