// How is a baseline written so that people can read its changes, and read so that nothing wrong in
// it passes?
#include "commands/check/baseline_json.h"

#include "base/sorted.h"
#include "base/text.h"
#include "write/file.h"
#include "write/json_value.h"

#include <assert.h>
#include <errno.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

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
static bool fail(const char *where, const char *what, Err *err)
{
    return err_set(err, ERR_FILE, "%s: %s", where, what);
}

// Whether an object has those keys and no others; a key that begins with '?' may be missing.
static bool check_keys(const json_t *object, const char *where, const char *const *keys, Err *err)
{
    if (!json_is_object(object)) {
        return fail(where, "it is no object", err);
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
    return found == json_object_size(object) || fail(where, "it has a key that means nothing", err);
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

static bool read_number(const json_t *object, const char *where, const char *key, double *target,
                        Err *err)
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
        !read_number(truth, "truth", "uncertainty", &plan->uncertainty, err)) {
        return false;
    }
    plan->has_truth = true;
    plan->is_limited = !json_is_null(json_object_get(truth, "horizon_s"));
    if (plan->is_limited && !read_number(truth, "truth", "horizon_s", &plan->horizon_s, err)) {
        return false;
    }
    return (plan->uncertainty >= 0.0 && plan->horizon_s >= 0.0) ||
           fail("truth", "it holds a negative number", err);
}

static bool read_settings(const json_t *root, Baseline *baseline, Err *err)
{
    json_t *settings = json_object_get(root, "settings");
    if (!json_is_object(settings) || json_object_size(settings) == 0) {
        return fail("settings", "there are none", err);
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

// "rounding: 10 x 2e-9, the most that 8 starts moved it" is a kind and its reason.
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
    return fail(metric->name, "its 'why' begins with none of exact:, rounding:, statistical:", err);
}

static bool read_hash(const json_t *object, BaselineMetric *metric, Err *err)
{
    const char *digits = json_string_value(json_object_get(object, "value"));
    if (digits == NULL || strlen(digits) != 16 || strspn(digits, "0123456789abcdef") != 16) {
        return fail(metric->name, "'value' is not 16 hexadecimal digits", err);
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
        return fail(metric->name, "'sample' is no list of 2 to 32 numbers", err);
    }
    double mean = 0.0;
    double largest = 0.0;
    for (size_t i = 0; i < metric->sample_count; i++) {
        const json_t *value = json_array_get(sample, i);
        metric->sample[i] = json_number_value(value);
        if (!json_is_number(value) || (i > 0 && metric->sample[i] < metric->sample[i - 1])) {
            return fail(metric->name, "'sample' is not a list of numbers in rising order", err);
        }
        mean += metric->sample[i] / (double)metric->sample_count;
        largest = fmax(largest, fabs(metric->sample[i]));
    }
    if (!read_number(object, metric->name, "mean", &metric->mean, err)) {
        return false;
    }
    const bool is_whole = metric->value == sorted_median(metric->sample, metric->sample_count) &&
                          fabs(mean - metric->mean) <= MEAN_AGREES * largest;
    return is_whole || fail(metric->name, "'sample' is not the one of 'value' and 'mean'", err);
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
        return fail(metric->name, "no metric has so long a name", err);
    }
    if (!check_keys(object, name, KEYS, err) || !read_why(object, metric, err) ||
        !read_number(object, name, "band", &metric->band, err)) {
        return false;
    }
    const json_t *value = json_object_get(object, "value");
    metric->kind = json_is_string(value)    ? CHECK_HASH
                   : json_is_integer(value) ? CHECK_COUNT
                                            : CHECK_REAL;
    const json_t *full = json_object_get(object, "full");
    metric->is_slow = full != NULL;
    if (full != NULL && !json_is_true(full)) {
        return fail(name, "'full' is true or not there", err);
    }
    if ((metric->kind == CHECK_HASH) != is_hash_name(name)) {
        return fail(name, "16 hexadecimal digits belong to what ends in /hash, and to that alone",
                    err);
    }
    if (metric->kind == CHECK_HASH && metric->band_kind != BAND_EXACT) {
        return fail(name, "a hash is exact", err);
    }
    if (metric->band < 0.0) {
        return fail(name, "'band' is negative", err);
    }
    if (metric->band_kind == BAND_EXACT && metric->band != 0.0) {
        return fail(name, "'band' is not 0 though the number is exact", err);
    }
    const bool is_read = metric->kind == CHECK_HASH
                             ? read_hash(object, metric, err)
                             : read_number(object, name, "value", &metric->value, err);
    const bool has_sample =
        json_object_get(object, "sample") != NULL || json_object_get(object, "mean") != NULL;
    if (is_read && has_sample != (metric->band_kind == BAND_STATISTICAL)) {
        return fail(name, "a sample and its mean belong to what is statistical", err);
    }
    return is_read && (!has_sample || read_sample(object, metric, err));
}

static bool read_metrics(const json_t *root, Baseline *baseline, Err *err)
{
    json_t *metrics = json_object_get(root, "metrics");
    if (!json_is_object(metrics) || json_object_size(metrics) == 0) {
        return fail("metrics", "there are none", err);
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
    static const char *const KEYS[] = {"format", "case",     "tool",    "compiler", "build",
                                       "truth",  "settings", "metrics", NULL};
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
           read_truth(root, &baseline->plan, err) && read_settings(root, baseline, err) &&
           read_metrics(root, baseline, err);
}

bool baseline_json_read(const char *path, Baseline *baseline, Err *err)
{
    *baseline = (Baseline){.settings = NULL};
    FILE *stream = fopen(path, "r");
    if (stream == NULL) {
        return err_set(err, ERR_FILE, "there is no baseline %s: %s; --bless makes one", path,
                       strerror(errno));
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
