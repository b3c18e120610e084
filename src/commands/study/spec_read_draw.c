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

// Deviations from the mean to the limits of a normal distribution within a tolerance.
static const double TOLERANCE_DEVIATIONS = 3.0;
// Between limits with less of a normal distribution than this no value is right to 6 digits.
static const double NORMAL_SHARE_MIN = 1e-10;

static const char WAYS[] = "tolerance, {uniform: [low, high]}, {log-uniform: [low, high]}, "
                           "{normal: {mean, deviation}}, {triangular: {low, mode, high}}";

static bool is_tolerance(const Node *node)
{
    return node->kind == NODE_SCALAR && strcmp(node->text, "tolerance") == 0;
}

// The limits of the tolerance that the case gives to the key.
static bool take_tolerance(const Reading *reading, const Node *node)
{
    Variable *variable = reading->variable;
    const Scenario *base = reading->spec->base;
    const ToleratedLength *length = NULL;
    if (reading->key.row->type == SCHEMA_TOLERATED) {
        length = schema_field_const(reading->key.row, base, reading->key.index);
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

static bool check_limits(const Reading *reading, const Node *node)
{
    const Variable *variable = reading->variable;
    return variable->low < variable->high ||
           spec_read_refuse(reading, node, "low below high",
                            "the lower limit is not below the upper limit of %s", variable->key);
}

bool spec_read_uniform(Reading *reading, const Node *node)
{
    reading->variable->kind = VARIABLE_UNIFORM;
    if (is_tolerance(node)) {
        return take_tolerance(reading, node);
    }
    const Node *low = node->kind == NODE_LIST ? node->first : NULL;
    const Node *high = low != NULL ? low->next : NULL;
    if (high == NULL || high->next != NULL) {
        return spec_read_refuse(reading, node, "[low, high]", "the limits of %s are two values",
                                reading->variable->key);
    }
    return spec_read_number(reading, low, true, &reading->variable->low) &&
           spec_read_number(reading, high, true, &reading->variable->high) &&
           check_limits(reading, node);
}

bool spec_read_log_uniform(Reading *reading, const Node *node)
{
    if (is_tolerance(node)) {
        return spec_read_refuse(reading, node, "[low, high]", "log-uniform takes no tolerance");
    }
    if (!spec_read_uniform(reading, node)) {
        return false;
    }
    reading->variable->kind = VARIABLE_LOG_UNIFORM;
    return reading->variable->low > 0.0 ||
           spec_read_refuse(reading, node->first, "limits above 0",
                            "there is no logarithm of %.60s", node->first->text);
}

static bool check_normal(const Reading *reading, const Node *node)
{
    const Variable *variable = reading->variable;
    if (!(variable->deviation > 0.0)) {
        return spec_read_refuse(reading, spec_read_child(node, "deviation"), "a deviation above 0",
                                "%s does not vary", variable->key);
    }
    const double low = (variable->low - variable->centre) / variable->deviation;
    const double high = (variable->high - variable->centre) / variable->deviation;
    return check_limits(reading, node) &&
           (normal_between(low, high) >= NORMAL_SHARE_MIN ||
            spec_read_refuse(reading, node, "limits within 6 deviations of the mean",
                             "the limits of %s contain almost none of the distribution",
                             variable->key));
}

bool spec_read_normal(Reading *reading, const Node *node)
{
    Variable *variable = reading->variable;
    variable->kind = VARIABLE_NORMAL;
    if (is_tolerance(node)) {
        if (!take_tolerance(reading, node)) {
            return false;
        }
        variable->centre = 0.5 * (variable->low + variable->high);
        variable->deviation = 0.5 * (variable->high - variable->low) / TOLERANCE_DEVIATIONS;
        return true;
    }
    variable->low = -INFINITY;
    variable->high = INFINITY;
    return spec_keys_read(reading, SPEC_NORMAL, node) && check_normal(reading, node);
}

bool spec_read_triangular(Reading *reading, const Node *node)
{
    Variable *variable = reading->variable;
    variable->kind = VARIABLE_TRIANGULAR;
    if (!spec_keys_read(reading, SPEC_TRIANGULAR, node) || !check_limits(reading, node)) {
        return false;
    }
    return (variable->low <= variable->centre && variable->centre <= variable->high) ||
           spec_read_refuse(reading, spec_read_child(node, "mode"), "low <= mode <= high",
                            "the mode of %s lies outside its limits", variable->key);
}

static bool read_distribution(Reading *reading, const Node *node)
{
    const Variable *variable = reading->variable;
    if (is_tolerance(node)) {
        return spec_read_uniform(reading, node);
    }
    if (node->kind != NODE_MAP || node->first == NULL || node->first->next != NULL) {
        return spec_read_refuse(reading, node, WAYS, "%s needs one distribution", variable->key);
    }
    return spec_keys_read(reading, SPEC_DISTRIBUTION, node) &&
           (!variable->is_whole || variable->kind == VARIABLE_UNIFORM ||
            spec_read_refuse(reading, node, "{uniform: [low, high]}",
                             "whole numbers such as %s are drawn from a uniform distribution",
                             variable->key));
}

static bool read_key(Reading *reading, const Node *value)
{
    if (!spec_read_variable(reading, value)) {
        return false;
    }
    reading->variable->is_drawn = true;
    if (reading->variable->is_word) {
        return source_error(&reading->source, keys_span(value), "a list of them under vary",
                            reading->err, "%s takes words, which cannot be drawn",
                            reading->variable->key);
    }
    return read_distribution(reading, value);
}

bool spec_read_draws(Reading *reading, const Node *keys)
{
    return spec_read_each(reading, keys, read_key) &&
           (keys->first != NULL ||
            spec_read_refuse(reading, keys, "a key with its distribution", "nothing is drawn"));
}
