// Which values does a key take one after another?
//
//     KEY: value    KEY: [value, value]    KEY: {from: value, to: value, count: 8, scale: log}
#include "commands/study/spec_read.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double COUNT_MAX = 9007199254740992.0; // 2^53: as many as a study may have runs

static bool add_word(const Reading *reading, const Node *node, Variable *variable)
{
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

static bool add_number(const Reading *reading, const ProbeKey *key, const Node *node,
                       Variable *variable)
{
    double number;
    if (!spec_read_number(reading, key, node, true, variable, &number)) {
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

// A list, or a single value, which is a list of one. A place [x, y] is a value and no list.
static bool read_list(const Reading *reading, const ProbeKey *key, const Node *node,
                      Variable *variable)
{
    const bool is_one = node->kind == NODE_SCALAR;
    size_t count = 0;
    for (const Node *item = is_one ? node : node->first; item != NULL;
         item = is_one ? NULL : item->next) {
        count++;
    }
    if (count == 0 || count > SPEC_VALUE_MAX) {
        return spec_read_refuse(
            reading, node, "1 to 1000 values, or a range {from, to, count}",
            count == 0 ? "the list of %s is empty" : "the list of %s is too long", variable->key);
    }
    variable->kind = VARIABLE_LIST;
    if (variable->is_word) {
        variable->words = calloc(count, sizeof *variable->words);
    } else {
        variable->numbers = calloc(count, sizeof *variable->numbers);
    }
    assert(variable->words != NULL || variable->numbers != NULL);
    for (const Node *item = is_one ? node : node->first; item != NULL;
         item = is_one ? NULL : item->next) {
        // the names of schemes are looked at when all keys are known
        const bool is_scheme = key->row == NULL;
        if (!is_scheme && !probe_check(reading->probe, &reading->source, key, item, reading->err)) {
            return false;
        }
        if (variable->is_word ? !add_word(reading, item, variable)
                              : !add_number(reading, key, item, variable)) {
            return false;
        }
    }
    return true;
}

static bool check_range(const Reading *reading, const Node *range, const Node *from,
                        const Variable *variable)
{
    const bool is_log = variable->kind == VARIABLE_LOGARITHMIC;
    if (!(variable->low < variable->high)) {
        return spec_read_refuse(reading, range, "from below to", "the range of %s is empty",
                                variable->key);
    }
    if (is_log && !(variable->low > 0.0)) {
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

static bool read_range(const Reading *reading, const ProbeKey *key, const Node *node,
                       Variable *variable)
{
    enum { FROM, TO, COUNT, SCALE, PART_COUNT };
    static const char *const PARTS[PART_COUNT] = {"from", "to", "count", "scale"};
    static const char *const SCALES[] = {"linear", "log", NULL};
    static const char EXAMPLE[] = "{from: VALUE, to: VALUE, count: 8}, and scale: log";
    const Node *parts[PART_COUNT];
    size_t scale = 0;
    if (variable->is_word) {
        return spec_read_refuse(reading, node, "a list [..]",
                                "the values of %s are no numbers and have no range", variable->key);
    }
    if (!keys_sort(&reading->source, node, PARTS, PART_COUNT, parts, reading->err) ||
        !spec_read_has_all(reading, node, PARTS, parts, COUNT + 1, EXAMPLE) ||
        !spec_read_number(reading, key, parts[FROM], true, variable, &variable->low) ||
        !spec_read_number(reading, key, parts[TO], true, variable, &variable->high) ||
        !spec_read_whole(reading, parts[COUNT], "a range's count", 2.0, COUNT_MAX,
                         &variable->count) ||
        (parts[SCALE] != NULL && !spec_read_word(reading, parts[SCALE], "scale", SCALES, &scale))) {
        return false;
    }
    variable->kind = scale == 1 ? VARIABLE_LOGARITHMIC : VARIABLE_LINEAR;
    return check_range(reading, node, parts[FROM], variable);
}

// Whether a key says how the bodies hang together: with another value the columns, which are those
// of the first run, would hold what is of other bodies.
static bool is_of_structure(const ProbeKey *key)
{
    return key->row != NULL &&
           (key->row->type == SCHEMA_JOINT_NAME || key->row->type == SCHEMA_BETWEEN);
}

static bool read_key(Reading *reading, const Node *value)
{
    ProbeKey key = {0};
    Variable *variable = spec_read_variable(reading, value, &key);
    if (variable == NULL) {
        return false;
    }
    const bool is_fixed =
        key.row != NULL && (key.row->type == SCHEMA_TEXT || key.row->type == SCHEMA_BACKENDS ||
                            !schema_is_setting(key.row));
    if (is_fixed) {
        return source_error(&reading->source, keys_span(value),
                            key.row->type == SCHEMA_BACKENDS ? "scheme: [reference, auto/1e-4]"
                                                             : "any other key",
                            reading->err, "%s cannot vary", variable->key);
    }
    if (is_of_structure(&key)) {
        return source_error(
            &reading->source, keys_span(value), "a study of its own for each value", reading->err,
            "%s cannot vary, for the columns of a study are those of one mechanism", variable->key);
    }
    return value->kind == NODE_MAP ? read_range(reading, &key, value, variable)
                                   : read_list(reading, &key, value, variable);
}

bool spec_read_vary(Reading *reading, const Node *vary)
{
    if (!keys_check_map(&reading->source, vary, reading->err)) {
        return false;
    }
    for (const Node *value = vary->first; value != NULL; value = value->next) {
        if (!keys_check_single(&reading->source, vary, value, reading->err) ||
            !read_key(reading, value)) {
            return false;
        }
    }
    return true;
}
