// Makes, writes and reads baselines: the numbers of a case, how far each may move, and why.
//
// exact        whole numbers that no start beside changed: they may not move.
// rounding     |x - x0| <= max(10 max_i |x_i - x0|, floor), x_i of 16 starts beside the case's
//              own: every input rounded anew, and in every other one all speeds 1e-12 of their
//              scale off. Were a deviation of another compiler of the same distribution as those
//              of the speeds, so that for normal ones P(max of 8 < s/4) = (erf(0.25 / sqrt 2))^8 =
//              2e-6, ten times their largest would still be 2.5 s. They are a hundred times larger
//              where joints have play. Where two numbers are equal but for rounding, as of planets
//              all round a sun, speeds that are off decide always alike which is the larger:
//              starts without find what comes of the other.
// statistical  the ensemble spreads over more than 1e-4 of the number: what rounding does to it is
//              no longer small, and only its distribution can be held against another. So it is
//              then with every number of that run that is not exact.
#include "commands/check/baseline.h"
#include "base/descriptors.h"
#include "base/sorted.h"
#include "base/text.h"
#include "base/zeroed.h"
#include "casefile/casefile.h"
#include "commands/check/fingerprint.h"
#include "commands/check/setting_agrees.h"
#include "model/start.h"
#include "version.h"
#include "write/file.h"
#include "write/json_value.h"

#include <assert.h>
#include <inttypes.h>
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
    free(baseline->start.numbers);
    *baseline = (Baseline){.settings = NULL};
}

CheckStart baseline_rounding_start(unsigned member)
{
    return (CheckStart){member, member % 2 == 0 ? BASELINE_ROUNDING_SHARE : 0.0, member};
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
static void baseline_set_settings(Baseline *baseline, const Scenario *scenario)
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

void baseline_begin(Baseline *baseline, const Scenario *scenario)
{
    text_copy(baseline->version, sizeof baseline->version, JOINTPLAY_VERSION);
    text_copy(baseline->ode, sizeof baseline->ode, JOINTPLAY_ODE_VERSION);
    text_copy(baseline->ccd, sizeof baseline->ccd, JOINTPLAY_CCD_VERSION);
#if defined(__clang__)
    text_copy(baseline->compiler, sizeof baseline->compiler, __VERSION__);
#else
    text_copy(baseline->compiler, sizeof baseline->compiler, "gcc " __VERSION__);
#endif
    fingerprint_print(baseline->build);
    baseline_set_settings(baseline, scenario);
}

void baseline_set_head(Baseline *baseline, const Baseline *head, const CheckPlan *plan)
{
    text_copy(baseline->version, sizeof baseline->version, head->version);
    text_copy(baseline->ode, sizeof baseline->ode, head->ode);
    text_copy(baseline->ccd, sizeof baseline->ccd, head->ccd);
    text_copy(baseline->compiler, sizeof baseline->compiler, head->compiler);
    text_copy(baseline->build, sizeof baseline->build, head->build);
    baseline->plan = *plan;
    free(baseline->settings);
    baseline->setting_count = head->setting_count;
    baseline->settings = calloc(head->setting_count + 1, sizeof *baseline->settings);
    assert(baseline->settings != NULL);
    memcpy(baseline->settings, head->settings, head->setting_count * sizeof *head->settings);
}

void baseline_set_start(Baseline *baseline, const Scenario *scenario)
{
    const SettledStart *settled = &scenario->settled;
    if (settled->motion_count == 0) {
        return;
    }
    BaselineStart *start = &baseline->start;
    free(start->numbers);
    start->revolutions = settled->revolutions;
    start->period = settled->motions[0].period;
    start->count = start_number_count(&scenario->linkage);
    start->numbers = zeroed(start->count, sizeof *start->numbers);
    start_numbers(&scenario->linkage, start->numbers);
}

// Whether a setting says how a run is computed and not what of.
static bool is_of_computing(const char *key)
{
    return strncmp(key, "run.", strlen("run.")) == 0 || strncmp(key, "ode.", strlen("ode.")) == 0;
}

static bool is_of_one_case(const Baseline *baseline, const Baseline *now)
{
    size_t i = 0;
    size_t k = 0;
    for (;;) {
        while (i < baseline->setting_count && is_of_computing(baseline->settings[i].key)) {
            i++;
        }
        while (k < now->setting_count && is_of_computing(now->settings[k].key)) {
            k++;
        }
        if (i == baseline->setting_count || k == now->setting_count) {
            return i == baseline->setting_count && k == now->setting_count;
        }
        if (strcmp(baseline->settings[i].key, now->settings[k].key) != 0 ||
            !setting_agrees(baseline->settings[i].value, now->settings[k].value)) {
            return false;
        }
        i++;
        k++;
    }
}

bool baseline_start_scenario(const Baseline *baseline, const Baseline *now, Scenario *scenario)
{
    const BaselineStart *start = &baseline->start;
    if (start->revolutions == 0 || !scenario_lacks_start(scenario) ||
        start->count != start_number_count(&scenario->linkage) || !is_of_one_case(baseline, now)) {
        return false;
    }
    start_set_numbers(start->numbers, &scenario->linkage);
    scenario->settled.revolutions = start->revolutions;
    return true;
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

// Puts a number of an ensemble's member where the run has it. Returns false where there is none.
static bool take_place(CheckMeasure *member, const char *name, size_t place)
{
    const size_t at = baseline_find(member, name, place);
    if (at >= member->count) {
        return false;
    }
    const CheckMetric taken = member->metrics[place];
    member->metrics[place] = member->metrics[at];
    member->metrics[at] = taken;
    return true;
}

// Brings what an ensemble measured into the order of what the run itself did. A member may have
// more: where the run's own errors are rounding it has no order, and a start beside it has one.
static bool bring_into_order(const CheckMeasure *run, CheckMeasure *members, size_t member_count,
                             Err *err)
{
    for (size_t i = 0; i < member_count; i++) {
        for (size_t k = 0; k < run->count; k++) {
            if (!take_place(&members[i], run->metrics[k].name, k)) {
                return err_set(err, ERR_SOLVER,
                               "a perturbed start does not measure a number of the case's own: %s; "
                               "change the start or the length of the run a little",
                               run->metrics[k].name);
            }
        }
        members[i].count = run->count;
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

// A run of which one number cannot be predicted has none that can: what a few starts hardly moved
// may be far off in another that takes another course. Whole numbers that none of them moved stay
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

bool baseline_set_metrics(Baseline *baseline, const CheckMeasure *run, CheckMeasure *members,
                          size_t member_count, Err *err)
{
    if (!bring_into_order(run, members, member_count, err)) {
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
            // of another machine: the band of the starts beside holds
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

// Baselines as files: one metric a line, so that a change shows in a diff.

static const char FORMAT[] = "jointplay baseline 2";
static const char OF_OMEGA[] = "jointplay baseline 1";
static const double MEAN_AGREES = 1e-12; // of the largest number: rounding of a sum of 32

static void append_string(Text *text, const char *words)
{
    json_t *value = json_value_text(words);
    json_value_write(value, JSON_ENCODE_ANY, text);
    json_decref(value);
}

static void append_key(Text *text, const char *indent, const char *key)
{
    text_append(text, "%s", indent);
    append_string(text, key);
    text_append(text, ": ");
}

static void append_pair(Text *text, const char *key, const char *value, const char *end)
{
    append_key(text, "", key);
    append_string(text, value);
    text_append(text, "%s", end);
}

static void append_head(Text *text, const Baseline *baseline)
{
    text_append(text, "{\n  ");
    append_pair(text, "format", FORMAT, ",\n  ");
    append_pair(text, "case", baseline->case_path, ",\n  \"tool\": {");
    append_pair(text, "version", baseline->version, ", ");
    append_pair(text, "ode", baseline->ode, ", ");
    append_pair(text, "ccd", baseline->ccd, "},\n  ");
    append_pair(text, "compiler", baseline->compiler, ",\n  ");
    append_pair(text, "build", baseline->build, ",\n  \"truth\": ");
    const CheckPlan *plan = &baseline->plan;
    if (!plan->has_truth) {
        text_append(text, "null,\n");
        return;
    }
    text_append(text, "{\"uncertainty\": ");
    text_append_number(text, plan->uncertainty);
    text_append(text, ", \"horizon_s\": ");
    if (plan->is_limited) {
        text_append_number(text, plan->horizon_s);
    } else {
        text_append(text, "null");
    }
    text_append(text, "},\n");
}

static void append_start(Text *text, const BaselineStart *start)
{
    text_append(text, "  \"start\": {\"revolutions\": %zu, \"period\": %zu, \"numbers\": [",
                start->revolutions, start->period);
    for (size_t i = 0; i < start->count; i++) {
        text_append(text, "%s", i > 0 ? ", " : "");
        text_append_number(text, start->numbers[i]);
    }
    text_append(text, "]},\n");
}

static void append_sample(Text *text, const BaselineMetric *metric)
{
    text_append(text, ", \"mean\": ");
    text_append_number(text, metric->mean);
    text_append(text, ", \"sample\": [");
    for (size_t i = 0; i < metric->sample_count; i++) {
        text_append(text, "%s", i > 0 ? ", " : "");
        text_append_number(text, metric->sample[i]);
    }
    text_append(text, "]");
}

static void append_metric(Text *text, const BaselineMetric *metric)
{
    append_key(text, "    ", metric->name);
    text_append(text, "{\"value\": ");
    if (metric->kind == CHECK_HASH) {
        text_append(text, "\"%016" PRIx64 "\"", metric->hash);
    } else {
        text_append_number(text, metric->value);
    }
    text_append(text, ", \"band\": ");
    text_append_number(text, metric->band);
    if (metric->is_slow) {
        text_append(text, ", \"full\": true");
    }
    char why[BASELINE_WHY_SIZE + 16];
    snprintf(why, sizeof why, "%s: %s", BASELINE_BAND_WORDS[metric->band_kind], metric->why);
    text_append(text, ", ");
    append_pair(text, "why", why, "");
    if (metric->band_kind == BAND_STATISTICAL) {
        append_sample(text, metric);
    }
    text_append(text, "}");
}

bool baseline_json_write(const char *path, const Baseline *baseline, Err *err)
{
    Text text;
    text_init(&text);
    append_head(&text, baseline);
    if (baseline->start.revolutions > 0) {
        append_start(&text, &baseline->start);
    }
    text_append(&text, "  \"settings\": {");
    for (size_t i = 0; i < baseline->setting_count; i++) {
        text_append(&text, i > 0 ? ",\n    " : "\n    ");
        append_pair(&text, baseline->settings[i].key, baseline->settings[i].value, "");
    }
    text_append(&text, "\n  },\n  \"metrics\": {");
    for (size_t i = 0; i < baseline->count; i++) {
        text_append(&text, i > 0 ? ",\n" : "\n");
        append_metric(&text, &baseline->metrics[i]);
    }
    text_append(&text, "\n  }\n}\n");
    const bool is_written = file_write_text(FILE_BASELINE, path, text.data, err);
    text_finish(&text);
    return is_written;
}

// Fails with what is wrong, and where.
static bool baseline_fail(const char *where, const char *what, Err *err)
{
    return err_set(err, ERR_FILE, "%s: %s", where, what);
}

// Whether an object has those keys and no others; a key that begins with '?' may be missing.
static bool check_keys(const json_t *object, const char *where, const char *const *keys, Err *err)
{
    if (!json_is_object(object)) {
        return baseline_fail(where, "it is no object", err);
    }
    size_t found = 0;
    for (; *keys != NULL; keys++) {
        const bool may_miss = **keys == '?';
        const bool is_there = json_object_get(object, *keys + (may_miss ? 1 : 0)) != NULL;
        if (!is_there && !may_miss) {
            return err_set(err, ERR_FILE, "%s: '%s' is missing", where, *keys);
        }
        found += is_there ? 1 : 0;
    }
    return found == json_object_size(object) ||
           baseline_fail(where, "it has a key that means nothing", err);
}

static bool read_text(const json_t *object, const char *key, char *target, size_t size, Err *err)
{
    const char *words = json_string_value(json_object_get(object, key));
    if (words == NULL || strlen(words) >= size) {
        return err_set(err, ERR_FILE, "'%s' is no text, or too long a one", key);
    }
    text_copy(target, size, words);
    return true;
}

static bool baseline_read_number(const json_t *object, const char *where, const char *key,
                                 double *target, Err *err)
{
    const json_t *value = json_object_get(object, key);
    if (!json_is_number(value)) {
        return err_set(err, ERR_FILE, "%s: '%s' is no number", where, key);
    }
    *target = json_number_value(value);
    return true;
}

static bool read_truth(const json_t *root, CheckPlan *plan, Err *err)
{
    static const char *const KEYS[] = {"uncertainty", "horizon_s", NULL};
    const json_t *truth = json_object_get(root, "truth");
    *plan = (CheckPlan){.is_full = true};
    if (json_is_null(truth)) {
        return true;
    }
    if (!check_keys(truth, "truth", KEYS, err) ||
        !baseline_read_number(truth, "truth", "uncertainty", &plan->uncertainty, err)) {
        return false;
    }
    plan->has_truth = true;
    plan->is_limited = !json_is_null(json_object_get(truth, "horizon_s"));
    if (plan->is_limited &&
        !baseline_read_number(truth, "truth", "horizon_s", &plan->horizon_s, err)) {
        return false;
    }
    return (plan->uncertainty >= 0.0 && plan->horizon_s >= 0.0) ||
           baseline_fail("truth", "it holds a negative number", err);
}

static bool read_start(const json_t *root, BaselineStart *start, Err *err)
{
    static const char *const KEYS[] = {"revolutions", "period", "numbers", NULL};
    const json_t *object = json_object_get(root, "start");
    if (object == NULL) {
        return true;
    }
    double revolutions = 0.0;
    double period = 0.0;
    if (!check_keys(object, "start", KEYS, err) ||
        !baseline_read_number(object, "start", "revolutions", &revolutions, err) ||
        !baseline_read_number(object, "start", "period", &period, err)) {
        return false;
    }
    const json_t *numbers = json_object_get(object, "numbers");
    start->count = json_array_size(numbers);
    if (start->count == 0 || !(revolutions >= 1.0) || !(period >= 0.0)) {
        return baseline_fail("start", "it holds no numbers, or no revolutions", err);
    }
    start->revolutions = (size_t)revolutions;
    start->period = (size_t)period;
    start->numbers = zeroed(start->count, sizeof *start->numbers);
    for (size_t i = 0; i < start->count; i++) {
        const json_t *number = json_array_get(numbers, i);
        start->numbers[i] = json_number_value(number);
        if (!json_is_number(number) || !isfinite(start->numbers[i])) {
            return baseline_fail("start", "'numbers' is not a list of numbers", err);
        }
    }
    return true;
}

static bool read_settings(const json_t *root, Baseline *baseline, Err *err)
{
    json_t *settings = json_object_get(root, "settings");
    if (!json_is_object(settings) || json_object_size(settings) == 0) {
        return baseline_fail("settings", "there are none", err);
    }
    baseline->settings = calloc(json_object_size(settings), sizeof *baseline->settings);
    assert(baseline->settings != NULL);
    const char *key;
    json_t *value;
    json_object_foreach(settings, key, value)
    {
        BaselineSetting *setting = &baseline->settings[baseline->setting_count++];
        text_copy(setting->key, sizeof setting->key, key);
        if (!read_text(settings, key, setting->value, sizeof setting->value, err)) {
            return false;
        }
    }
    return true;
}

// "rounding: 10 x 2e-9, the most that 16 starts moved it" is a kind and its reason.
static bool read_why(const json_t *object, BaselineMetric *metric, Err *err)
{
    const char *why = json_string_value(json_object_get(object, "why"));
    for (int i = 0; why != NULL && i < BAND_KIND_COUNT; i++) {
        const size_t length = strlen(BASELINE_BAND_WORDS[i]);
        if (strncmp(why, BASELINE_BAND_WORDS[i], length) == 0 &&
            strncmp(why + length, ": ", 2) == 0) {
            metric->band_kind = (BandKind)i;
            text_copy(metric->why, sizeof metric->why, why + length + 2);
            return true;
        }
    }
    return baseline_fail(metric->name,
                         "its 'why' begins with none of exact:, rounding:, statistical:", err);
}

static bool baseline_read_hash(const json_t *object, BaselineMetric *metric, Err *err)
{
    const char *digits = json_string_value(json_object_get(object, "value"));
    if (digits == NULL || strlen(digits) != 16 || strspn(digits, "0123456789abcdef") != 16) {
        return baseline_fail(metric->name, "'value' is not 16 hexadecimal digits", err);
    }
    metric->hash = strtoull(digits, NULL, 16);
    return true;
}

// The sample must be that of its median and mean: an edit of one of its numbers shows, though no
// test would feel it.
static bool read_sample(const json_t *object, BaselineMetric *metric, Err *err)
{
    const json_t *sample = json_object_get(object, "sample");
    metric->sample_count = json_array_size(sample);
    if (metric->sample_count < 2 || metric->sample_count > BASELINE_SAMPLE_SIZE) {
        return baseline_fail(metric->name, "'sample' is no list of 2 to 32 numbers", err);
    }
    double mean = 0.0;
    double largest = 0.0;
    for (size_t i = 0; i < metric->sample_count; i++) {
        const json_t *value = json_array_get(sample, i);
        metric->sample[i] = json_number_value(value);
        if (!json_is_number(value) || (i > 0 && metric->sample[i] < metric->sample[i - 1])) {
            return baseline_fail(metric->name, "'sample' is not a list of numbers in rising order",
                                 err);
        }
        mean += metric->sample[i] / (double)metric->sample_count;
        largest = fmax(largest, fabs(metric->sample[i]));
    }
    if (!baseline_read_number(object, metric->name, "mean", &metric->mean, err)) {
        return false;
    }
    const bool is_whole = metric->value == sorted_median(metric->sample, metric->sample_count) &&
                          fabs(mean - metric->mean) <= MEAN_AGREES * largest;
    return is_whole ||
           baseline_fail(metric->name, "'sample' is not the one of 'value' and 'mean'", err);
}

static bool is_hash_name(const char *name)
{
    static const char END[] = "/hash";
    const size_t length = strlen(name);
    return length >= strlen(END) && strcmp(name + length - strlen(END), END) == 0;
}

static bool read_metric(const char *name, const json_t *object, BaselineMetric *metric, Err *err)
{
    static const char *const KEYS[] = {"value", "band", "why", "?full", "?mean", "?sample", NULL};
    text_copy(metric->name, sizeof metric->name, name);
    if (strlen(name) >= sizeof metric->name) {
        return baseline_fail(metric->name, "no metric has so long a name", err);
    }
    if (!check_keys(object, name, KEYS, err) || !read_why(object, metric, err) ||
        !baseline_read_number(object, name, "band", &metric->band, err)) {
        return false;
    }
    const json_t *value = json_object_get(object, "value");
    metric->kind = json_is_string(value)    ? CHECK_HASH
                   : json_is_integer(value) ? CHECK_COUNT
                                            : CHECK_REAL;
    const json_t *full = json_object_get(object, "full");
    metric->is_slow = full != NULL;
    if (full != NULL && !json_is_true(full)) {
        return baseline_fail(name, "'full' is true or not there", err);
    }
    if ((metric->kind == CHECK_HASH) != is_hash_name(name)) {
        return baseline_fail(
            name, "16 hexadecimal digits belong to what ends in /hash, and to that alone", err);
    }
    if (metric->kind == CHECK_HASH && metric->band_kind != BAND_EXACT) {
        return baseline_fail(name, "a hash is exact", err);
    }
    if (metric->band < 0.0) {
        return baseline_fail(name, "'band' is negative", err);
    }
    if (metric->band_kind == BAND_EXACT && metric->band != 0.0) {
        return baseline_fail(name, "'band' is not 0 though the number is exact", err);
    }
    const bool is_read = metric->kind == CHECK_HASH
                             ? baseline_read_hash(object, metric, err)
                             : baseline_read_number(object, name, "value", &metric->value, err);
    const bool has_sample =
        json_object_get(object, "sample") != NULL || json_object_get(object, "mean") != NULL;
    if (is_read && has_sample != (metric->band_kind == BAND_STATISTICAL)) {
        return baseline_fail(name, "a sample and its mean belong to what is statistical", err);
    }
    return is_read && (!has_sample || read_sample(object, metric, err));
}

static bool read_metrics(const json_t *root, Baseline *baseline, Err *err)
{
    json_t *metrics = json_object_get(root, "metrics");
    if (!json_is_object(metrics) || json_object_size(metrics) == 0) {
        return baseline_fail("metrics", "there are none", err);
    }
    baseline->metrics = calloc(json_object_size(metrics), sizeof *baseline->metrics);
    assert(baseline->metrics != NULL);
    const char *name;
    json_t *object;
    json_object_foreach(metrics, name, object)
    {
        if (!read_metric(name, object, &baseline->metrics[baseline->count++], err)) {
            return false;
        }
    }
    return true;
}

static bool read_root(const json_t *root, Baseline *baseline, Err *err)
{
    static const char *const KEYS[] = {"format", "case",   "tool",     "compiler", "build",
                                       "truth",  "?start", "settings", "metrics",  NULL};
    static const char *const TOOL_KEYS[] = {"version", "ode", "ccd", NULL};
    // those of programs that used GSL
    static const char *const FORMER_TOOL_KEYS[] = {"version", "ode", "ccd", "gsl", NULL};
    const char *format = json_string_value(json_object_get(root, "format"));
    if (format != NULL && strcmp(format, OF_OMEGA) == 0) {
        return err_set(err, ERR_FILE,
                       "its errors are of omega alone, and now an error is that of the whole "
                       "motion; bless again");
    }
    if (format == NULL || strcmp(format, FORMAT) != 0) {
        return err_set(err, ERR_FILE, "its format is '%.60s', and this program reads '%s'",
                       format != NULL ? format : "", FORMAT);
    }
    const json_t *tool = json_object_get(root, "tool");
    return check_keys(root, "the whole", KEYS, err) &&
           check_keys(tool, "tool",
                      json_object_get(tool, "gsl") != NULL ? FORMER_TOOL_KEYS : TOOL_KEYS, err) &&
           read_text(root, "case", baseline->case_path, sizeof baseline->case_path, err) &&
           read_text(tool, "version", baseline->version, sizeof baseline->version, err) &&
           read_text(tool, "ode", baseline->ode, sizeof baseline->ode, err) &&
           read_text(tool, "ccd", baseline->ccd, sizeof baseline->ccd, err) &&
           read_text(root, "compiler", baseline->compiler, sizeof baseline->compiler, err) &&
           read_text(root, "build", baseline->build, sizeof baseline->build, err) &&
           read_truth(root, &baseline->plan, err) && read_start(root, &baseline->start, err) &&
           read_settings(root, baseline, err) && read_metrics(root, baseline, err);
}

bool baseline_json_read(const char *path, Baseline *baseline, Err *err)
{
    *baseline = (Baseline){.settings = NULL};
    const char *reason;
    FILE *stream = descriptors_open_file(path, &reason);
    if (stream == NULL) {
        return err_set(err, ERR_FILE, "there is no baseline %s: %s; --bless makes one", path,
                       reason);
    }
    json_error_t fault;
    json_t *root = json_loadf(stream, JSON_REJECT_DUPLICATES, &fault);
    fclose(stream);
    Err own = {0};
    const bool is_read = root != NULL
                             ? read_root(root, baseline, &own)
                             : err_set(&own, ERR_FILE, "line %d: %s", fault.line, fault.text);
    json_decref(root);
    if (!is_read) {
        baseline_finish(baseline);
        err_set(err, ERR_FILE, "the baseline %s is not one of this program, or damaged: %s", path,
                own.text);
    }
    return is_read;
}
