// What does a setting cost, on a machine that does other things as well?
//
// Times of single runs are noise; work is not:
//     work = N + E / 20 + S / 4,   N world steps, E evaluations of contact forces, S samples
// and a scheme's rate, s of the processor per unit of work, is the least of its runs. Cost = work *
// rate.
#include "commands/tune/tune.h"

#include <math.h>

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

static double rate_of(const Tune *tune, size_t scheme)
{
    const double own = least_rate(tune, (int)scheme);
    const double all = least_rate(tune, TUNE_NONE);
    return isinf(own) ? all : fmin(own, RATE_SPREAD * all);
}

static bool is_timed(const Tune *tune, const TuneTrial *trial)
{
    const TuneScheme *owner = &tune->schemes[trial->scheme];
    return owner->best != TUNE_NONE && trial == &tune->trials[owner->best] &&
           isfinite(owner->processor_least_s);
}

// The time of a run, s: the least where it was timed, or what its work comes to.
static double time_of(const Tune *tune, const TuneTrial *trial)
{
    if (is_timed(tune, trial)) {
        return tune->schemes[trial->scheme].processor_least_s;
    }
    // one that chooses its step makes a reference first, which is no work of world steps
    const bool has_step = scheme_has_step(&tune->schemes[trial->scheme].scheme);
    return has_step && trial->run.is_complete
               ? rate_of(tune, trial->scheme) *
                     work_of(tune, (double)trial->run.steps, (double)trial->run.evaluations)
               : trial->run.processor_s;
}

double tune_trial_cost(const Tune *tune, const TuneTrial *trial)
{
    return tune->cost == TUNE_LENGTH  ? 1.0 / trial->value
           : tune->cost == TUNE_STEPS ? (double)trial->run.steps
                                      : time_of(tune, trial);
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
    return finest == NULL ? 0.0
                          : rate_of(tune, scheme) * work_of(tune, steps_at(tune, finest, index),
                                                            (double)finest->run.evaluations);
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
           (limit->time_s == 0.0 || time_of(tune, trial) <= limit->time_s);
}
