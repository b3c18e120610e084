// How is a mapping of a study file read by the rows of its keys?
#include "base/text.h"
#include "casefile/quantity.h"
#include "commands/study/spec_read.h"

#include <assert.h>
#include <string.h>

enum { KEY_MAX = 8 }; // of one group

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

static bool read_limit(const Reading *reading, const SpecKey *key, const Node *value,
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

static bool read_line(const Reading *reading, const SpecKey *key, const Node *value,
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
        return read_line(reading, key, value, allowed, target);
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
        return read_limit(reading, key, value, allowed, target);
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

static bool read_value(Reading *reading, const SpecKey *key, const Node *value)
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
        is_read = values[i] == NULL || read_value(reading, keys[i], values[i]);
    }
    return is_read;
}
