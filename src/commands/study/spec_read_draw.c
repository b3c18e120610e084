// How are the values of a key distributed that are drawn?
//
//     KEY: tolerance                        uniform within the tolerance that the case gives
//     KEY: {uniform: [low, high]}           KEY: {log-uniform: [low, high]}
//     KEY: {normal: tolerance}              KEY: {normal: {mean: , deviation: , low: , high: }}
//     KEY: {triangular: {low: , mode: , high: }}
#include "commands/study/normal.h"
#include "commands/study/spec_read.h"

#include <math.h>
#include <string.h>

static const double DRAWS_MAX = 9007199254740992.0; // 2^53: as many as a study may have runs
static const double SEED_MAX = 9007199254740992.0;  // every whole number up to it is exact

// Of a normal distribution within a tolerance: its limits are so many deviations from its mean.
static const double TOLERANCE_DEVIATIONS = 3.0;
// Between limits with less of a normal distribution than this nothing is right to 6 digits any
// more.
static const double NORMAL_SHARE_MIN = 1e-10;

static const char WAYS[] = "tolerance, {uniform: [low, high]}, {log-uniform: [low, high]}, "
                           "{normal: {mean, deviation}}, {triangular: {low, mode, high}}";

// What a distribution is read with.
typedef struct Drawing {
    const Reading *reading;
    const ProbeKey *key;
    Variable *variable;
} Drawing;

static bool read_number(const Drawing *drawing, const Node *node, double *number)
{
    return spec_read_number(drawing->reading, drawing->key, node, true, drawing->variable, number);
}

static bool is_tolerance(const Node *node)
{
    return node->kind == NODE_SCALAR && strcmp(node->text, "tolerance") == 0;
}

// The limits of the tolerance that the case gives to the key.
static bool take_tolerance(const Drawing *drawing, const Node *node)
{
    const Reading *reading = drawing->reading;
    Variable *variable = drawing->variable;
    const Scenario *base = reading->spec->base;
    const ToleratedLength *length = NULL;
    if (drawing->key->row->type == SCHEMA_TOLERATED) {
        length = schema_field_const(drawing->key->row, base, drawing->key->index);
    }
    if (length == NULL || !(length->lower < length->upper)) {
        return spec_read_refuse(
            reading, node,
            length != NULL ? "a tolerance in the case such as 108 +- 0.3 mm, or "
                             "{uniform: [low, high]}"
                           : "{uniform: [low, high]}; lengths of a four-bar alone have "
                             "tolerances",
            "%s has no tolerance in %s", variable->key, reading->spec->case_path);
    }
    text_copy(variable->unit, sizeof variable->unit, units_si(DIMENSION_LENGTH));
    variable->low = length->nominal + length->lower;
    variable->high = length->nominal + length->upper;
    return true;
}

static bool check_limits(const Drawing *drawing, const Node *node)
{
    const Variable *variable = drawing->variable;
    return variable->low < variable->high ||
           spec_read_refuse(drawing->reading, node, "low below high",
                            "nothing lies between the limits of %s", variable->key);
}

static bool read_uniform(const Drawing *drawing, const Node *node)
{
    drawing->variable->kind = VARIABLE_UNIFORM;
    if (is_tolerance(node)) {
        return take_tolerance(drawing, node);
    }
    const Node *low = node->kind == NODE_LIST ? node->first : NULL;
    const Node *high = low != NULL ? low->next : NULL;
    if (high == NULL || high->next != NULL) {
        return spec_read_refuse(drawing->reading, node, "[low, high]",
                                "the limits of %s are two values", drawing->variable->key);
    }
    return read_number(drawing, low, &drawing->variable->low) &&
           read_number(drawing, high, &drawing->variable->high) && check_limits(drawing, node);
}

static bool read_log_uniform(const Drawing *drawing, const Node *node)
{
    if (is_tolerance(node)) {
        return spec_read_refuse(drawing->reading, node, "[low, high]",
                                "a tolerance is no range of sizes");
    }
    if (!read_uniform(drawing, node)) {
        return false;
    }
    drawing->variable->kind = VARIABLE_LOG_UNIFORM;
    return drawing->variable->low > 0.0 ||
           spec_read_refuse(drawing->reading, node->first, "limits above 0",
                            "there is no logarithm of %.60s", node->first->text);
}

static bool check_normal(const Drawing *drawing, const Node *node, const Node *deviation)
{
    const Variable *variable = drawing->variable;
    if (!(variable->deviation > 0.0)) {
        return spec_read_refuse(drawing->reading, deviation, "a deviation above 0",
                                "%s does not vary", variable->key);
    }
    const double low = (variable->low - variable->centre) / variable->deviation;
    const double high = (variable->high - variable->centre) / variable->deviation;
    return check_limits(drawing, node) &&
           (normal_between(low, high) >= NORMAL_SHARE_MIN ||
            spec_read_refuse(drawing->reading, node, "limits within 6 deviations of the mean",
                             "the limits of %s leave next to nothing of the distribution",
                             variable->key));
}

static bool read_normal(const Drawing *drawing, const Node *node)
{
    enum { MEAN, DEVIATION, LOW, HIGH, PART_COUNT };
    static const char *const PARTS[PART_COUNT] = {"mean", "deviation", "low", "high"};
    static const char EXAMPLE[] = "{mean: VALUE, deviation: VALUE}, and low: and high:";
    const Reading *reading = drawing->reading;
    Variable *variable = drawing->variable;
    const Node *parts[PART_COUNT];
    variable->kind = VARIABLE_NORMAL;
    if (is_tolerance(node)) {
        if (!take_tolerance(drawing, node)) {
            return false;
        }
        variable->centre = 0.5 * (variable->low + variable->high);
        variable->deviation = 0.5 * (variable->high - variable->low) / TOLERANCE_DEVIATIONS;
        return true;
    }
    variable->low = -INFINITY;
    variable->high = INFINITY;
    if (!keys_sort(&reading->source, node, PARTS, PART_COUNT, parts, reading->err) ||
        !spec_read_has_all(reading, node, PARTS, parts, DEVIATION + 1, EXAMPLE) ||
        !read_number(drawing, parts[MEAN], &variable->centre) ||
        // as a difference it is in no range of the key's
        !spec_read_number(reading, drawing->key, parts[DEVIATION], false, variable,
                          &variable->deviation) ||
        (parts[LOW] != NULL && !read_number(drawing, parts[LOW], &variable->low)) ||
        (parts[HIGH] != NULL && !read_number(drawing, parts[HIGH], &variable->high))) {
        return false;
    }
    return check_normal(drawing, node, parts[DEVIATION]);
}

static bool read_triangular(const Drawing *drawing, const Node *node)
{
    enum { LOW, MODE, HIGH, PART_COUNT };
    static const char *const PARTS[PART_COUNT] = {"low", "mode", "high"};
    static const char EXAMPLE[] = "{low: VALUE, mode: VALUE, high: VALUE}";
    const Reading *reading = drawing->reading;
    Variable *variable = drawing->variable;
    const Node *parts[PART_COUNT];
    variable->kind = VARIABLE_TRIANGULAR;
    if (!keys_sort(&reading->source, node, PARTS, PART_COUNT, parts, reading->err) ||
        !spec_read_has_all(reading, node, PARTS, parts, PART_COUNT, EXAMPLE) ||
        !read_number(drawing, parts[LOW], &variable->low) ||
        !read_number(drawing, parts[MODE], &variable->centre) ||
        !read_number(drawing, parts[HIGH], &variable->high) || !check_limits(drawing, node)) {
        return false;
    }
    return (variable->low <= variable->centre && variable->centre <= variable->high) ||
           spec_read_refuse(reading, parts[MODE], "low <= mode <= high",
                            "the mode of %s lies outside its limits", variable->key);
}

static bool read_distribution(const Drawing *drawing, const Node *node)
{
    enum { WAY_COUNT = 4 };
    static const char *const NAMES[WAY_COUNT] = {"uniform", "log-uniform", "normal", "triangular"};
    static bool (*const READERS[WAY_COUNT])(const Drawing *, const Node *) = {
        read_uniform, read_log_uniform, read_normal, read_triangular};
    const Reading *reading = drawing->reading;
    if (is_tolerance(node)) {
        return read_uniform(drawing, node);
    }
    if (node->kind != NODE_MAP || node->first == NULL || node->first->next != NULL) {
        return spec_read_refuse(reading, node, WAYS, "%s needs one distribution",
                                drawing->variable->key);
    }
    const Node *ways[WAY_COUNT];
    if (!keys_sort(&reading->source, node, NAMES, WAY_COUNT, ways, reading->err)) {
        return false;
    }
    for (size_t i = 0; i < WAY_COUNT; i++) {
        if (ways[i] != NULL && !READERS[i](drawing, ways[i])) {
            return false;
        }
    }
    return !drawing->variable->is_whole || drawing->variable->kind == VARIABLE_UNIFORM ||
           spec_read_refuse(reading, node, "{uniform: [low, high]}",
                            "whole numbers such as %s are drawn evenly", drawing->variable->key);
}

static bool read_key(Reading *reading, const Node *value)
{
    ProbeKey key = {0};
    Variable *variable = spec_read_variable(reading, value, &key);
    if (variable == NULL) {
        return false;
    }
    variable->is_drawn = true;
    if (variable->is_word) {
        return source_error(&reading->source, keys_span(value), "a list of them under vary",
                            reading->err, "%s takes words, which cannot be drawn", variable->key);
    }
    const Drawing drawing = {reading, &key, variable};
    return read_distribution(&drawing, value);
}

bool spec_read_draw(Reading *reading, const Node *draw)
{
    enum { COUNT, KEYS, METHOD, SEED, PART_COUNT };
    static const char *const PARTS[PART_COUNT] = {"count", "keys", "method", "seed"};
    static const char *const METHODS[] = {
        [DRAW_RANDOM] = "random", [DRAW_LATIN_HYPERCUBE] = "latin-hypercube", NULL};
    Spec *spec = reading->spec;
    const Node *parts[PART_COUNT];
    size_t method = DRAW_LATIN_HYPERCUBE;
    if (!keys_sort(&reading->source, draw, PARTS, PART_COUNT, parts, reading->err) ||
        !spec_read_has_all(reading, draw, PARTS, parts, KEYS + 1,
                           "count: 1000, and keys: with a distribution each") ||
        !spec_read_whole(reading, parts[COUNT], "the count of draws", 1.0, DRAWS_MAX,
                         &spec->draws) ||
        (parts[METHOD] != NULL &&
         !spec_read_word(reading, parts[METHOD], "method", METHODS, &method)) ||
        (parts[SEED] != NULL &&
         !spec_read_whole(reading, parts[SEED], "the seed", 0.0, SEED_MAX, &spec->seed)) ||
        !keys_check_map(&reading->source, parts[KEYS], reading->err)) {
        return false;
    }
    spec->method = (DrawMethod)method;
    if (parts[KEYS]->first == NULL) {
        return spec_read_refuse(reading, parts[KEYS], "a key with its distribution",
                                "nothing is drawn");
    }
    for (const Node *value = parts[KEYS]->first; value != NULL; value = value->next) {
        if (!keys_check_single(&reading->source, parts[KEYS], value, reading->err) ||
            !read_key(reading, value)) {
            return false;
        }
    }
    return true;
}
