// The keys of a study file, and how a mapping is read by the rows of their table.
//
// One row a key drives reading, messages, `help study` and docs/study-format.md. What stands under
// keys of the case (set, vary, draw.keys) is read by functions.
#include "base/text.h"
#include "casefile/quantity.h"
#include "commands/study/metrics.h"
#include "commands/study/spec.h"

#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

enum { PAGE_WIDTH = 80, INDENT = 8 };

static const double EXACT_MAX = 9007199254740992.0; // 2^53: whole numbers up to it are exact

static const char *const METHODS[] = {[DRAW_RANDOM] = "random",
                                      [DRAW_LATIN_HYPERCUBE] = "latin-hypercube",
                                      [DRAW_SOBOL] = "sobol",
                                      NULL};
static const char *const DIRECTIONS[] = {
    [FOLLOW_FORWARD] = "forward", [FOLLOW_BACKWARD] = "backward", [FOLLOW_BOTH] = "both", NULL};
static const char *const SETTLES[] = {
    [SETTLE_NEIGHBOURS] = "neighbours", [SETTLE_EACH] = "each", NULL};
static const char *const SCALES[] = {"linear", "log", NULL};
static const char *const FLAGS[] = {"false", "true", NULL};

#define AT(member) .offset = offsetof(Spec, member)
#define IN(member) .offset = offsetof(Variable, member)

const SpecKey SPEC_KEYS[] = {
    {SPEC_TOP, "title", SPEC_KEY_LINE, AT(title), .doc = "The question of the study, for people"},
    {SPEC_TOP, "case", SPEC_KEY_PART, true, .read = spec_read_case,
     .value = "the path of a case file, relative to the study file",
     .doc = "The case; with the values of set it must be valid by itself"},
    {SPEC_TOP, "set", SPEC_KEY_PART, .read = spec_read_set, .value = "KEY: value, ...",
     .doc = "Values of keys of the case for every run, as --set gives them"},
    {SPEC_TOP, "vary", SPEC_KEY_PART, .read = spec_read_vary,
     .value = "KEY: value, KEY: [value, value], KEY: {from: value, to: value, count: 8}, ...",
     .doc = "A grid: every combination of all values is run. KEY is a key of the case, or scheme: "
            "the way to run it by the names of 'jointplay compare'"},
    {SPEC_TOP, "follow", SPEC_KEY_PART, .read = spec_read_follow,
     .value = "KEY under vary, or {key: KEY, direction: both}",
     .doc = "Each run starts in the settled motion of the run before it along this key"},
    {SPEC_TOP, "settle", SPEC_KEY_CHOICE, AT(settle), .words = SETTLES, .what = "settle",
     .doc =
         "Whether runs without a truth start in the settled motion of a neighbour, of which each "
         "tenth is found by itself, or each run finds its own"},
    {SPEC_TOP, "draw", SPEC_KEY_MAP, .of = SPEC_DRAW, .doc = "Random values"},
    {SPEC_TOP, "limits", SPEC_KEY_MAP, .of = SPEC_LIMITS, .doc = "Limits of one run"},
    {SPEC_TOP, "truth", SPEC_KEY_FLAG, AT(has_truth), .words = FLAGS, .what = "truth",
     .doc = "Whether each run is compared with the certified reference for its values; false where "
            "the reference makes the runs"},
    {SPEC_TOP, "growth", SPEC_KEY_FLAG, AT(has_growth), .words = FLAGS, .what = "growth",
     .doc = "Whether each row has the growth of a small change in a revolution, which takes the "
            "reference up to 30 revolutions more"},

    // a run of four months is a slip of the pen, and a process takes 1 ms to start
    {SPEC_LIMITS, "time", SPEC_KEY_LIMIT, AT(limits.time_s), .low = 1e-3, .high = 1e7,
     .dimension = DIMENSION_TIME, .what = "the time", .doc = "Wall time"},
    // the program starts with no less, and no machine has a millionth of the most
    {SPEC_LIMITS, "memory", SPEC_KEY_LIMIT, AT(limits.memory_bytes), .low = 1e7, .high = 1e15,
     .dimension = DIMENSION_MEMORY, .what = "the memory", .doc = "Address space"},

    {SPEC_DRAW, "count", SPEC_KEY_WHOLE, true, AT(draws), .low = 1.0, .high = EXACT_MAX,
     .what = "the count of draws", .doc = "Draws, each of which is run at every point of the grid"},
    {SPEC_DRAW, "keys", SPEC_KEY_PART, true, .read = spec_read_draws,
     .value = "KEY: tolerance, KEY: {distribution: ...}, ...",
     .doc = "Keys of the case that take numbers, with a distribution each"},
    {SPEC_DRAW, "method", SPEC_KEY_CHOICE, AT(method), .words = METHODS, .what = "method",
     .doc = "latin-hypercube takes one value from each of `count` equal shares of a distribution; "
            "sobol "
            "makes count times (keys + 2) runs, from which the study's end says what part of each "
            "result's variance each key is for"},
    {SPEC_DRAW, "seed", SPEC_KEY_WHOLE, AT(seed), .low = 0.0, .high = EXACT_MAX, .what = "the seed",
     .doc = "The same seed gives the same values on every machine"},

    {SPEC_FOLLOW, "key", SPEC_KEY_PART, true, .read = spec_read_follow_key,
     .value = "a key under vary that takes numbers", .doc = "Whose values follow one another"},
    {SPEC_FOLLOW, "direction", SPEC_KEY_CHOICE, AT(direction), .words = DIRECTIONS,
     .what = "the direction",
     .doc = "In the order of the values, against it, or both, with a column direction, which shows "
            "hysteresis"},

    {SPEC_RANGE, "from", SPEC_KEY_VALUE, true, IN(low), .doc = "The first number"},
    {SPEC_RANGE, "to", SPEC_KEY_VALUE, true, IN(high), .doc = "The last number, above the first"},
    {SPEC_RANGE, "count", SPEC_KEY_WHOLE, true, IN(count), .low = 2.0, .high = EXACT_MAX,
     .what = "a range's count", .doc = "Numbers, both ends included"},
    {SPEC_RANGE, "scale", SPEC_KEY_CHOICE, IN(kind), .low = VARIABLE_LINEAR, .words = SCALES,
     .what = "scale", .doc = "Even steps, or even steps of the logarithm"},

    {SPEC_DISTRIBUTION, "uniform", SPEC_KEY_PART, .read = spec_read_uniform,
     .value = "[low, high], or tolerance",
     .doc = "Uniform between the limits, or between those of the tolerance that the case gives"},
    {SPEC_DISTRIBUTION, "log-uniform", SPEC_KEY_PART, .read = spec_read_log_uniform,
     .value = "[low, high]", .doc = "The same in the logarithm"},
    {SPEC_DISTRIBUTION, "normal", SPEC_KEY_PART, .read = spec_read_normal,
     .value = "{mean, deviation, low, high}, or tolerance",
     .doc = "Normal, truncated at the limits; of a tolerance, the mean is in the middle and the "
            "limits are 3 deviations away"},
    {SPEC_DISTRIBUTION, "triangular", SPEC_KEY_PART, .read = spec_read_triangular,
     .value = "{low, mode, high}", .doc = "Triangular, most often at the mode"},

    {SPEC_NORMAL, "mean", SPEC_KEY_VALUE, true, IN(centre), .doc = "Mean before the truncation"},
    {SPEC_NORMAL, "deviation", SPEC_KEY_DIFFERENCE, true, IN(deviation),
     .doc = "Standard deviation before the truncation"},
    {SPEC_NORMAL, "low", SPEC_KEY_VALUE, IN(low), .doc = "Lower limit"},
    {SPEC_NORMAL, "high", SPEC_KEY_VALUE, IN(high), .doc = "Upper limit"},

    {SPEC_TRIANGULAR, "low", SPEC_KEY_VALUE, true, IN(low), .doc = "Lower limit"},
    {SPEC_TRIANGULAR, "mode", SPEC_KEY_VALUE, true, IN(centre), .doc = "The most frequent value"},
    {SPEC_TRIANGULAR, "high", SPEC_KEY_VALUE, true, IN(high), .doc = "Upper limit"},
};
const size_t SPEC_KEY_COUNT = sizeof SPEC_KEYS / sizeof *SPEC_KEYS;
#undef AT

const SpecGroupRow SPEC_GROUPS[SPEC_GROUP_COUNT] = {
    [SPEC_TOP] = {"", "case: with the path of a case file, relative to the study file"},
    [SPEC_LIMITS] = {"limits", ""},
    [SPEC_DRAW] = {"draw", "count: 1000, and keys: with a distribution each"},
    [SPEC_FOLLOW] = {"follow", "key: with a key under vary, such as key: drive.speed"},
    [SPEC_RANGE] = {"vary.KEY", "{from: VALUE, to: VALUE, count: 8}, and scale: log"},
    [SPEC_DISTRIBUTION] = {"draw.keys.KEY", ""},
    [SPEC_NORMAL] = {"draw.keys.KEY.normal", "{mean: VALUE, deviation: VALUE}, and low: and high:"},
    [SPEC_TRIANGULAR] = {"draw.keys.KEY.triangular", "{low: VALUE, mode: VALUE, high: VALUE}"},
};

Spec spec_default(void)
{
    // minutes of a chaotic case end in a row that says so, and the two cores of a small machine
    // with 4 GB go on
    return (Spec){
        .draws = 1,
        .method = DRAW_LATIN_HYPERCUBE,
        .seed = 1,
        .has_truth = true,
        .limits = {.time_s = 60.0, .memory_bytes = 2000000000},
    };
}

// Appends what a key takes, in words.
//
// What a key takes, in words.
static void spec_key_allowed(const SpecKey *key, Text *text)
{
    switch (key->type) {
    case SPEC_KEY_LINE:
        text_append(text, "text on one line, at most %d bytes", SPEC_TEXT_SIZE - 1);
        break;
    case SPEC_KEY_WHOLE:
        text_append(text, "a whole number from %.0f to %.0f", key->low, key->high);
        break;
    case SPEC_KEY_LIMIT:
        text_append(text, "none, or %g to %g %s", key->low, key->high, units_si(key->dimension));
        break;
    case SPEC_KEY_FLAG:
    case SPEC_KEY_CHOICE:
        for (size_t i = 0; key->words[i] != NULL; i++) {
            text_append(text, "%s%s", i > 0 ? ", " : "", key->words[i]);
        }
        break;
    case SPEC_KEY_VALUE:
    case SPEC_KEY_DIFFERENCE:
        text_append(text, "a value of KEY");
        break;
    case SPEC_KEY_MAP:
        text_append(text, "a mapping of the keys below");
        break;
    case SPEC_KEY_PART:
        text_append(text, "%s", key->value);
        break;
    }
}

static const char EXAMPLE[] = "title: Which map and step for which speed?\n"
                              "case: ../paper/impact-k66.yaml\n"
                              "set: {run.revolutions: 0.2}\n"
                              "vary:\n"
                              "  drive.speed: {from: 100 rpm, to: 1500 rpm, count: 15}\n"
                              "  scheme: [direct/plain/textbook, direct/staggered/impulse]\n"
                              "  run.step: {from: 0.3 us, to: 30 us, count: 8, scale: log}\n"
                              "draw:\n"
                              "  count: 100\n"
                              "  keys:\n"
                              "    contact.restitution: {uniform: [0.85, 0.95]}\n"
                              "limits: {time: 60 s, memory: 2 GB}\n";

static const char RULES[] =
    "A study file has the rules of a case file: quantities have their unit, unknown and doubled "
    "keys "
    "are errors. It has vary, draw, or both; a key of the case may appear in only one of set, vary "
    "and draw, with its whole path, such as joints.crank-coupler.hole.";

static void spec_table_describe_default(const SpecKey *key, Text *text)
{
    const Spec spec = spec_default();
    const void *value = (const char *)&spec + key->offset;
    if (key->is_required) {
        text_append(text, "required");
    } else if (key->type == SPEC_KEY_FLAG) {
        text_append(text, "%s", key->words[*(const bool *)value ? 1 : 0]);
    } else if (key->type == SPEC_KEY_CHOICE) {
        // of a range: the first word
        text_append(text, "%s", key->words[key->group < SPEC_RANGE ? *(const int *)value : 0]);
    } else if (key->type == SPEC_KEY_WHOLE) {
        text_append(text, "%.0f", (double)*(const uint64_t *)value);
    } else if (key->dimension == DIMENSION_TIME) {
        text_append(text, "%g s", *(const double *)value);
    } else if (key->dimension == DIMENSION_MEMORY) {
        text_append(text, "%g GB", 1e-9 * (double)*(const size_t *)value);
    } else {
        text_append(text, "none");
    }
}

// Appends words in lines that fit the page, indented.
static void append_folded(const Text *words, Text *text)
{
    Text folded;
    text_init(&folded);
    text_append(&folded, "%s", words->data);
    text_fold(&folded, PAGE_WIDTH - INDENT);
    for (const char *line = folded.data; *line != '\0'; line += *line == '\n' ? 1 : 0) {
        const int length = (int)strcspn(line, "\n");
        text_append(text, "%*s%.*s\n", INDENT, "", length, line);
        line += length;
    }
    text_finish(&folded);
}

static void describe_key(const SpecKey *key, bool is_markdown, Text *text)
{
    const char *group = SPEC_GROUPS[key->group].path;
    const char *dot = group[0] != '\0' ? "." : "";
    Text words;
    text_init(&words);
    if (is_markdown) {
        spec_key_allowed(key, &words);
        Text usual;
        text_init(&usual);
        spec_table_describe_default(key, &usual);
        if (strcmp(usual.data, "none") != 0) {
            text_append(&words, key->is_required ? "; %s" : "; default %s", usual.data);
        }
        text_finish(&usual);
        text_append(text, "- `%s%s%s` (%s): %s\n", group, dot, key->name, words.data, key->doc);
    } else {
        text_append(&words, "%s: ", key->doc);
        spec_key_allowed(key, &words);
        text_append(&words, key->is_required ? "; " : "; default: ");
        spec_table_describe_default(key, &words);
        text_append(text, "    %s%s%s\n", group, dot, key->name);
        append_folded(&words, text);
    }
    text_finish(&words);
}

void spec_describe(bool is_markdown, Text *text)
{
    if (is_markdown) {
        text_append(text,
                    "# The study file\n\nThis page is generated from the program's own table of "
                    "keys. [Studies](studies.md) has an example and explains how to use them.\n\n"
                    "%s\n\n",
                    RULES);
    } else {
        text_append(text, "A study file\n\n%s\n\n%s\n", RULES, EXAMPLE);
    }
    if (!is_markdown) {
        text_fold(text, PAGE_WIDTH);
    }
    for (size_t i = 0; i < SPEC_KEY_COUNT; i++) {
        describe_key(&SPEC_KEYS[i], is_markdown, text);
    }
    text_append(text, is_markdown ? "\n## The columns of its runs\n\nA column for each key under "
                                    "vary and draw, then:\n\n"
                                  : "\nThe columns of its runs: one for each key under vary and "
                                    "draw, then\n\n");
    metrics_describe(is_markdown, text);
}

// Reads a mapping by the rows of its keys.

enum { KEY_MAX = 10 }; // of one group

static bool refuse_range(const Reading *reading, const SpecKey *key, const Node *value,
                         const char *allowed)
{
    return spec_read_refuse(reading, value, allowed, "%s is out of range: %.60s", key->what,
                            value->text);
}

static bool read_whole(const Reading *reading, const SpecKey *key, const Node *value,
                       const char *allowed, uint64_t *target)
{
    size_t number = 0;
    Complaint complaint;
    if (!spec_read_single(reading, value, key->what, allowed)) {
        return false;
    }
    if (!quantity_integer(value->text, &number, &complaint)) {
        return spec_read_refuse(reading, value, allowed, "%s", complaint.text);
    }
    if (!((double)number >= key->low && (double)number <= key->high)) {
        return refuse_range(reading, key, value, allowed);
    }
    *target = number;
    return true;
}

static bool spec_table_read_limit(const Reading *reading, const SpecKey *key, const Node *value,
                                  const char *allowed, void *target)
{
    Complaint complaint;
    double limit = 0.0;
    if (!spec_read_single(reading, value, key->what, allowed)) {
        return false;
    }
    if (strcmp(value->text, "none") != 0) {
        if (!quantity_parse(value->text, key->dimension, &limit, &complaint)) {
            return spec_read_refuse(reading, value, complaint.allowed, "%s", complaint.text);
        }
        if (!(limit >= key->low && limit <= key->high)) {
            return refuse_range(reading, key, value, allowed);
        }
    }
    if (key->dimension == DIMENSION_MEMORY) {
        *(size_t *)target = (size_t)limit;
    } else {
        *(double *)target = limit;
    }
    return true;
}

static bool read_choice(const Reading *reading, const SpecKey *key, const Node *value,
                        const char *allowed, int *target)
{
    const char *word = value->kind == NODE_SCALAR ? value->text : "";
    size_t count = 0;
    for (; key->words[count] != NULL; count++) {
        if (strcmp(key->words[count], word) == 0) {
            *target = (int)key->low + (int)count;
            return true;
        }
    }
    const char *nearest = text_nearest(word, key->words, count);
    return spec_read_refuse(reading, value, allowed, "'%.40s' is no choice for %s%s%s%s", word,
                            key->what, nearest != NULL ? "; did you mean '" : "",
                            nearest != NULL ? nearest : "", nearest != NULL ? "'?" : "");
}

static bool spec_table_read_line(const Reading *reading, const SpecKey *key, const Node *value,
                                 const char *allowed, char *target)
{
    if (value->kind != NODE_SCALAR || strlen(value->text) >= SPEC_TEXT_SIZE) {
        return spec_read_refuse(reading, value, allowed, "%s is not one line of text", key->name);
    }
    text_copy(target, SPEC_TEXT_SIZE, value->text);
    return true;
}

static bool read_by_type(Reading *reading, const SpecKey *key, const Node *value,
                         const char *allowed)
{
    const bool is_of_variable = key->group >= SPEC_RANGE;
    void *target =
        (is_of_variable ? (char *)reading->variable : (char *)reading->spec) + key->offset;
    int choice = 0;
    switch (key->type) {
    case SPEC_KEY_LINE:
        return spec_table_read_line(reading, key, value, allowed, target);
    case SPEC_KEY_FLAG:
        if (!read_choice(reading, key, value, allowed, &choice)) {
            return false;
        }
        *(bool *)target = choice == 1;
        return true;
    case SPEC_KEY_WHOLE:
        return read_whole(reading, key, value, allowed, target);
    case SPEC_KEY_CHOICE:
        return read_choice(reading, key, value, allowed, target);
    case SPEC_KEY_LIMIT:
        return spec_table_read_limit(reading, key, value, allowed, target);
    case SPEC_KEY_VALUE:
    case SPEC_KEY_DIFFERENCE:
        // a difference is in no range of the key's
        return spec_read_number(reading, value, key->type == SPEC_KEY_VALUE, target);
    case SPEC_KEY_MAP:
        return spec_keys_read(reading, key->of, value);
    case SPEC_KEY_PART:
        return key->read(reading, value);
    }
    return false;
}

static bool spec_table_read_value(Reading *reading, const SpecKey *key, const Node *value)
{
    Text allowed;
    text_init(&allowed);
    spec_key_allowed(key, &allowed);
    const bool is_read = read_by_type(reading, key, value, allowed.data);
    text_finish(&allowed);
    return is_read;
}

bool spec_keys_read(Reading *reading, SpecGroup group, const Node *map)
{
    const SpecKey *keys[KEY_MAX];
    const char *names[KEY_MAX] = {NULL};
    const Node *values[KEY_MAX];
    size_t count = 0;
    for (size_t i = 0; i < SPEC_KEY_COUNT; i++) {
        if (SPEC_KEYS[i].group == group) {
            assert(count < KEY_MAX);
            keys[count] = &SPEC_KEYS[i];
            names[count++] = SPEC_KEYS[i].name;
        }
    }
    if (!keys_sort(&reading->source, map, names, count, values, reading->err)) {
        return false;
    }
    for (size_t i = 0; i < count; i++) {
        if (keys[i]->is_required && values[i] == NULL) {
            return source_error(&reading->source, keys_span(map), SPEC_GROUPS[group].example,
                                reading->err, "%s is missing", names[i]);
        }
    }
    bool is_read = true;
    for (size_t i = 0; i < count && is_read; i++) {
        is_read = values[i] == NULL || spec_table_read_value(reading, keys[i], values[i]);
    }
    return is_read;
}
