// Which values does a key take one after another?
//
//     KEY: value    KEY: [value, value]    KEY: {from: value, to: value, count: 8, scale: log}
#include "commands/study/spec_read.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static bool add_word(const Reading *reading, const Node *node)
{
    Variable *variable = reading->variable;
    Text text;
    text_init(&text);
    if (node->kind == NODE_SCALAR) {
        text_append(&text, "%s", node->text);
    } else {
        spec_read_write(node, &text);
    }
    bool is_good = text.length < RECORD_WORD_SIZE ||
                   spec_read_refuse(reading, node, "at most 63 bytes", "this value is too long");
    for (size_t i = 0; is_good && i < variable->count; i++) {
        is_good =
            strcmp(variable->words[i], text.data) != 0 ||
            spec_read_refuse(reading, node, "each value once", "'%s' is listed twice", text.data);
    }
    if (is_good) {
        text_copy(variable->words[variable->count++], RECORD_WORD_SIZE, text.data);
    }
    text_finish(&text);
    return is_good;
}

static bool add_number(Reading *reading, const Node *node)
{
    Variable *variable = reading->variable;
    double number;
    if (!spec_read_number(reading, node, true, &number)) {
        return false;
    }
    for (uint64_t i = 0; i < variable->count; i++) {
        if (variable->numbers[i] == number) {
            return spec_read_refuse(reading, node, "each value once", "'%.60s' is listed twice",
                                    node->text);
        }
    }
    variable->numbers[variable->count++] = number;
    return true;
}

// A list, or a single value, which is a list of one. A point [x, y] is a value and no list.
static bool read_list(Reading *reading, const Node *list)
{
    Variable *variable = reading->variable;
    size_t count = 0;
    for (const Node *item = spec_read_first(list); item != NULL;
         item = spec_read_next(list, item)) {
        count++;
    }
    if (count == 0 || count > SPEC_VALUE_MAX) {
        return spec_read_refuse(
            reading, list, "1 to 1000 values, or a range {from, to, count}",
            count == 0 ? "the list of %s is empty" : "the list of %s is too long", variable->key);
    }
    variable->kind = VARIABLE_LIST;
    if (variable->is_word) {
        variable->words = calloc(count, sizeof *variable->words);
    } else {
        variable->numbers = calloc(count, sizeof *variable->numbers);
    }
    assert(variable->words != NULL || variable->numbers != NULL);
    // the names of schemes are looked at when all keys are known
    const bool is_scheme = reading->key.row == NULL;
    bool is_read = true;
    for (const Node *item = spec_read_first(list); is_read && item != NULL;
         item = spec_read_next(list, item)) {
        is_read = (is_scheme || probe_check(reading->probe, &reading->source, &reading->key, item,
                                            reading->err)) &&
                  (variable->is_word ? add_word(reading, item) : add_number(reading, item));
    }
    return is_read;
}

static bool read_range(Reading *reading, const Node *range)
{
    Variable *variable = reading->variable;
    if (variable->is_word) {
        return spec_read_refuse(reading, range, "a list [..]",
                                "the values of %s are not numbers and have no range",
                                variable->key);
    }
    variable->kind = VARIABLE_LINEAR;
    if (!spec_keys_read(reading, SPEC_RANGE, range)) {
        return false;
    }
    const bool is_log = variable->kind == VARIABLE_LOGARITHMIC;
    if (!(variable->low < variable->high)) {
        return spec_read_refuse(reading, range, "from below to", "the range of %s is empty",
                                variable->key);
    }
    if (is_log && !(variable->low > 0.0)) {
        const Node *from = spec_read_child(range, "from");
        return spec_read_refuse(reading, from, "from above 0, or scale: linear",
                                "there is no logarithm of %.60s", from->text);
    }
    // the first two are nearest to one another
    const double steps = (double)variable->count - 1.0;
    const double gap =
        is_log ? variable->low * (pow(variable->high / variable->low, 1.0 / steps) - 1.0)
               : (variable->high - variable->low) / steps;
    if (variable->is_whole && !(gap >= 1.0)) {
        return spec_read_refuse(reading, range, "steps of 1 or more",
                                "the range of %s has more values than whole numbers",
                                variable->key);
    }
    return true;
}

static bool read_key(Reading *reading, const Node *value)
{
    if (!spec_read_variable(reading, value)) {
        return false;
    }
    const SchemaRow *row = reading->key.row; // NULL for the scheme
    const char *key = reading->variable->key;
    if (row != NULL &&
        (row->type == SCHEMA_TEXT || row->type == SCHEMA_BACKENDS || !schema_is_setting(row))) {
        return source_error(&reading->source, keys_span(value),
                            row->type == SCHEMA_BACKENDS ? "scheme: [reference, auto/1e-4]"
                                                         : "any other key",
                            reading->err, "%s cannot vary", key);
    }
    // with other bodies the columns, which are those of the first run, would hold what is of others
    if (row != NULL && (row->type == SCHEMA_JOINT_NAME || row->type == SCHEMA_BETWEEN)) {
        return source_error(
            &reading->source, keys_span(value), "a separate study for each value", reading->err,
            "%s cannot vary, because a study has the columns of one mechanism", key);
    }
    return value->kind == NODE_MAP ? read_range(reading, value) : read_list(reading, value);
}

bool spec_read_vary(Reading *reading, const Node *vary)
{
    reading->vary = vary;
    return spec_read_each(reading, vary, read_key);
}
