// How far may each number of a case move, and why that far?
//
// exact        whole numbers that no start beside changed: they may not move.
// rounding     |x - x0| <= max(10 max_i |x_i - x0|, floor), x_i of 8 starts beside the case's own:
//              every input rounded anew and all speeds 1e-12 of their scale off. Were a deviation
//              of another compiler of the same distribution as those of the ensemble, so that for
//              normal ones P(max of 8 < s/4) = (erf(0.25 / sqrt 2))^8 = 2e-6, ten times their
//              largest would still be 2.5 s. They are a hundred times larger where joints have
//              play.
// statistical  the ensemble spreads over more than 1e-4 of the number: what rounding does to it is
//              no longer small, and only its distribution can be held against another. So it is
//              then with every number of that run that is not exact.
#include "commands/check/baseline.h"

#include "base/sorted.h"
#include "casefile/casefile.h"
#include "version.h"

#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// of speeds of 10 m/s some 1e-11 m/s: a gap is rounded to 3e-17 m, which a speed of 3e-14 m/s over
// a millisecond makes as well
const double BASELINE_ROUNDING_SHARE = 1e-12;
const double BASELINE_SAMPLE_SHARE = 1e-9;

static const double BAND_FACTOR = 10.0; // see above
// of the number itself: a hundredth of the smallest change of a spike that anyone would care for
static const double SPREAD_LIMIT = 1e-4;
enum { SAMPLE_SEED = 100 }; // members of the two ensembles have no start in common

const char *const BASELINE_BAND_WORDS[BAND_KIND_COUNT] = {
    [BAND_EXACT] = "exact",
    [BAND_ROUNDING] = "rounding",
    [BAND_STATISTICAL] = "statistical",
};

void baseline_finish(Baseline *baseline)
{
    free(baseline->settings);
    free(baseline->metrics);
    *baseline = (Baseline){.settings = NULL};
}

CheckStart baseline_rounding_start(unsigned member)
{
    return (CheckStart){member, BASELINE_ROUNDING_SHARE, member};
}

CheckStart baseline_sample_start(unsigned member)
{
    return (CheckStart){SAMPLE_SEED + member, BASELINE_SAMPLE_SHARE, 0};
}

static void set_setting(BaselineSetting *target, const CasefileSetting *setting)
{
    Text text;
    text_init(&text);
    if (setting->number_count > 0 && setting->kind != CASEFILE_WORD) {
        for (size_t i = 0; i < setting->number_count; i++) {
            text_append(&text, "%s", i > 0 ? ", " : "");
            text_append_number(&text, setting->numbers[i]);
        }
        text_append(&text, "%s%s", setting->unit[0] != '\0' ? " " : "", setting->unit);
    } else {
        text_append(&text, "%s", setting->text);
    }
    text_copy(target->key, sizeof target->key, setting->key);
    text_copy(target->value, sizeof target->value, text.data);
    text_finish(&text);
}

// Those that the scenario uses, but for its title.
static void set_settings(Baseline *baseline, const Scenario *scenario)
{
    baseline->settings = calloc(casefile_setting_count(scenario), sizeof *baseline->settings);
    assert(baseline->settings != NULL);
    CasefileSetting setting;
    CasefileWalk walk = casefile_walk(scenario);
    while (casefile_next(&walk, &setting)) {
        if (setting.applies && strcmp(setting.key, "title") != 0) {
            set_setting(&baseline->settings[baseline->setting_count++], &setting);
        }
    }
}

void baseline_set_head(Baseline *baseline, const Scenario *scenario, const CheckPlan *plan)
{
    text_copy(baseline->version, sizeof baseline->version, JOINTPLAY_VERSION);
    text_copy(baseline->ode, sizeof baseline->ode, JOINTPLAY_ODE_VERSION);
    text_copy(baseline->ccd, sizeof baseline->ccd, JOINTPLAY_CCD_VERSION);
#if defined(__clang__)
    text_copy(baseline->compiler, sizeof baseline->compiler, __VERSION__);
#else
    text_copy(baseline->compiler, sizeof baseline->compiler, "gcc " __VERSION__);
#endif
    build_print(baseline->build);
    baseline->plan = *plan;
    set_settings(baseline, scenario);
}

size_t baseline_find(const CheckMeasure *measure, const char *name, size_t near)
{
    if (near < measure->count && strcmp(measure->metrics[near].name, name) == 0) {
        return near;
    }
    size_t i = 0;
    while (i < measure->count && strcmp(measure->metrics[i].name, name) != 0) {
        i++;
    }
    return i;
}

// Checks that an ensemble measured what the run itself did, in the same order.
static bool check_same(const CheckMeasure *run, const CheckMeasure *members, size_t member_count,
                       Err *err)
{
    for (size_t i = 0; i < member_count; i++) {
        for (size_t k = 0; k < run->count; k++) {
            const bool is_there = k < members[i].count &&
                                  strcmp(members[i].metrics[k].name, run->metrics[k].name) == 0;
            if (!is_there || members[i].count != run->count) {
                return err_set(
                    err, ERR_SOLVER,
                    "a perturbed start does not measure the same numbers as the case's own: %s; "
                    "change the start or the length of the run a little",
                    run->metrics[k].name);
            }
        }
    }
    return true;
}

static double largest_deviation(const CheckMeasure *members, size_t member_count, size_t metric,
                                double value)
{
    double largest = 0.0;
    for (size_t i = 0; i < member_count; i++) {
        largest = fmax(largest, fabs(members[i].metrics[metric].value - value));
    }
    return largest;
}

static void set_band(BaselineMetric *metric, const CheckMetric *measured, double deviation,
                     size_t member_count)
{
    // steps that a solver chooses by itself have a floor, and so no exact count
    if (measured->kind != CHECK_REAL && deviation == 0.0 && measured->floor == 0.0) {
        metric->band_kind = BAND_EXACT;
        snprintf(metric->why, sizeof metric->why, "a whole number that %zu starts left alone",
                 member_count);
        return;
    }
    const double most = fmax(SPREAD_LIMIT * measured->scale, measured->floor);
    metric->band_kind = deviation > most ? BAND_STATISTICAL : BAND_ROUNDING;
    const double measured_band = BAND_FACTOR * deviation;
    metric->band = fmax(measured_band, measured->floor);
    if (measured_band >= measured->floor) {
        snprintf(metric->why, sizeof metric->why, "%.0f x %.2g, the most that %zu starts moved it",
                 BAND_FACTOR, deviation, member_count);
    } else {
        snprintf(metric->why, sizeof metric->why, "what rounding does; %zu starts moved it %.2g",
                 member_count, deviation);
    }
}

// Whether two metrics are of one run: of one backend, to the end or to the horizon.
static bool are_of_one_run(const char *name, const char *other)
{
    const size_t length = strcspn(name, "/");
    return length == strcspn(other, "/") && strncmp(name, other, length) == 0;
}

// A run of which one number cannot be predicted has none that can: what 8 starts hardly moved may
// be far off in a ninth that takes another course. Whole numbers that none of them moved stay
// exact; steps and evaluations that a solver chose anew do not make another course.
static void spread_doubt(BaselineMetric *metrics, size_t count)
{
    // the metrics of a run stand together
    size_t behind;
    for (size_t first = 0; first < count; first = behind) {
        bool is_doubtful = false;
        for (behind = first;
             behind < count && are_of_one_run(metrics[first].name, metrics[behind].name);
             behind++) {
            is_doubtful = is_doubtful || (metrics[behind].band_kind == BAND_STATISTICAL &&
                                          metrics[behind].kind != CHECK_EFFORT);
        }
        for (size_t i = first; is_doubtful && i < behind; i++) {
            if (metrics[i].band_kind == BAND_ROUNDING) {
                metrics[i].band_kind = BAND_STATISTICAL;
            }
        }
    }
}

bool baseline_set_metrics(Baseline *baseline, const CheckMeasure *run, const CheckMeasure *members,
                          size_t member_count, Err *err)
{
    if (!check_same(run, members, member_count, err)) {
        return false;
    }
    free(baseline->metrics);
    baseline->metrics = calloc(run->count + 1, sizeof *baseline->metrics);
    assert(baseline->metrics != NULL);
    baseline->count = run->count;
    for (size_t i = 0; i < run->count; i++) {
        const CheckMetric *measured = &run->metrics[i];
        BaselineMetric *metric = &baseline->metrics[i];
        text_copy(metric->name, sizeof metric->name, measured->name);
        metric->kind = measured->kind;
        metric->is_slow = measured->is_slow;
        metric->value = measured->value;
        metric->hash = measured->hash;
        if (measured->kind == CHECK_HASH) {
            snprintf(metric->why, sizeof metric->why, "of this build alone");
            continue;
        }
        const double deviation = largest_deviation(members, member_count, i, measured->value);
        set_band(metric, measured, deviation, member_count);
    }
    spread_doubt(baseline->metrics, baseline->count);
    return true;
}

// The digits that a sorted sample is kept with: nine, or as many as tell apart a thousandth of its
// range.
static int sample_digits(const double *sample, size_t count)
{
    enum { LEAST_DIGITS = 9, MOST_DIGITS = 17 };
    static const double SHARE = 1e-3;
    const double range = sample[count - 1] - sample[0];
    const double size = fmax(fabs(sample[0]), fabs(sample[count - 1]));
    int digits = LEAST_DIGITS;
    while (range > 0.0 && digits < MOST_DIGITS && pow(10.0, 1 - digits) * size > SHARE * range) {
        digits++;
    }
    return digits;
}

static void round_sample(double *sample, size_t count)
{
    const int digits = sample_digits(sample, count);
    for (size_t k = 0; k < count; k++) {
        char words[32];
        snprintf(words, sizeof words, "%.*g", digits, sample[k]);
        sample[k] = strtod(words, NULL);
    }
}

void baseline_snap(const BaselineMetric *metric, double *values, size_t count)
{
    // the rounded sample may ask for a digit more than the one that it was rounded from
    const int digits = sample_digits(metric->sample, metric->sample_count) - 1;
    const double rounding = 0.5 * pow(10.0, 1 - digits);
    for (size_t i = 0; i < count; i++) {
        double nearest = metric->sample[0];
        for (size_t k = 1; k < metric->sample_count; k++) {
            const double other = metric->sample[k];
            nearest = fabs(other - values[i]) < fabs(nearest - values[i]) ? other : nearest;
        }
        if (fabs(nearest - values[i]) <= rounding * fabs(nearest)) {
            values[i] = nearest;
        }
    }
}

// The numbers of a sample, in ascending order, and their mean.
static bool fill_sample(BaselineMetric *metric, size_t number, const CheckMeasure *members,
                        size_t member_count, Err *err)
{
    metric->sample_count = member_count;
    metric->mean = 0.0;
    for (size_t k = 0; k < member_count; k++) {
        const size_t index = baseline_find(&members[k], metric->name, number);
        if (index == members[k].count) {
            return err_set(
                err, ERR_SOLVER,
                "a perturbed start does not measure %s; change the start or the length of "
                "the run a little",
                metric->name);
        }
        metric->sample[k] = members[k].metrics[index].value;
    }
    sorted_make(metric->sample, member_count);
    round_sample(metric->sample, member_count);
    for (size_t k = 0; k < member_count; k++) {
        metric->mean += metric->sample[k] / (double)member_count;
    }
    return true;
}

static bool set_samples(Baseline *baseline, const CheckMeasure *members, size_t member_count,
                        double rate, RankTest *test, Err *err)
{
    for (size_t i = 0; i < baseline->count; i++) {
        BaselineMetric *metric = &baseline->metrics[i];
        if (metric->band_kind != BAND_STATISTICAL) {
            continue;
        }
        if (!fill_sample(metric, i, members, member_count, err)) {
            return false;
        }
        const double range = metric->sample[member_count - 1] - metric->sample[0];
        const double shift = rank_test_shift(test, metric->sample, member_count, rate);
        if (!isfinite(shift) || range <= members[0].metrics[i].floor) {
            // too few values for a rank test, or so close together that it would find the rounding
            // of another machine: the band of the 8 starts holds
            metric->band_kind = BAND_ROUNDING;
            continue;
        }
        metric->value = sorted_median(metric->sample, member_count);
        metric->band = shift;
        snprintf(metric->why, sizeof metric->why,
                 "not to be predicted: %zu starts, rank test; the band is a shift it tells",
                 member_count);
    }
    return true;
}

bool baseline_set_sample(Baseline *baseline, const CheckMeasure *members, size_t member_count,
                         double rate, Err *err)
{
    assert(member_count > 0 && member_count <= BASELINE_SAMPLE_SIZE);
    RankTest test = {.count = 0};
    const bool is_set = set_samples(baseline, members, member_count, rate, &test, err);
    rank_test_finish(&test);
    return is_set;
}
