// What does a value mean, and is it in its range?
#include "casefile/store.h"

#include "base/printable.h"
#include "casefile/expect.h"
#include "casefile/torque_table.h"

#include <float.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

static const double PIN_RADIUS = 5e-3; // m, where only the radial clearance is given: the paper's

static const double ROUNDING = 1e-9; // of a radial clearance, and far below a nanometre

// Whatever a store function needs to know.
typedef struct Target {
    const Entries *entries;
    const Entry *entry;
    char path[SCHEMA_PATH_SIZE]; // of the key, for messages
    void *field;
    Err *err;
} Target;

void store_describe(const Entries *entries, const SchemaRow *row, Text *text)
{
    if (row->type != SCHEMA_BODY_NAME && row->type != SCHEMA_JOINT_NAME) {
        schema_describe(row, true, text);
        return;
    }
    const EntryNames *names =
        &entries->names[row->type == SCHEMA_JOINT_NAME ? SCHEMA_JOINT : SCHEMA_BODY];
    for (size_t i = 0; i < names->count; i++) {
        text_append(text, "%s%s", i > 0 ? ", " : "", names->names[i]);
    }
}

// Refuses a node with what its row takes.
__attribute__((format(printf, 3, 4))) static bool refuse(const Target *target, Span span,
                                                         const char *format, ...)
{
    char message[QUANTITY_TEXT_SIZE];
    va_list arguments;
    va_start(arguments, format);
    shorten_list(message, sizeof message, format, arguments);
    va_end(arguments);
    Text allowed;
    text_init(&allowed);
    store_describe(target->entries, target->entry->row, &allowed);
    source_error(target->entry->source, span, allowed.data, target->err, "%s", message);
    text_finish(&allowed);
    return false;
}

// A node that is one value; a missing one is shown at its key.
static bool check_scalar(const Target *target, const Node *node)
{
    const SchemaRow *row = target->entry->row;
    const bool is_scalar = node->kind == NODE_SCALAR;
    if (is_scalar && (node->text[0] != '\0' || row->type == SCHEMA_TEXT)) {
        return true;
    }
    const Span span = is_scalar && node->key != NULL ? node->key->span : node->span;
    return refuse(target, span, is_scalar ? "%s has no value" : "%s takes a single value",
                  target->path);
}

// The row's range in words, such as "above 0 and up to 1 s".
static void describe_range(const SchemaRow *row, char allowed[QUANTITY_TEXT_SIZE])
{
    const char *unit = row->plain_unit == NULL ? units_si(row->dimension) : "";
    const char *blank = unit[0] != '\0' ? " " : "";
    snprintf(allowed, QUANTITY_TEXT_SIZE,
             row->low_is_open ? "above %g and up to %g%s%s" : "%g to %g%s%s", row->low, row->high,
             blank, unit);
}

static bool check_range(const Target *target, const Node *node, double value)
{
    const SchemaRow *row = target->entry->row;
    if (value <= row->high && (row->low_is_open ? value > row->low : value >= row->low)) {
        return true;
    }
    char allowed[QUANTITY_TEXT_SIZE];
    describe_range(row, allowed);
    return source_error(target->entry->source, node->span, allowed, target->err,
                        "%s is out of range: %.60s", target->path, node->text);
}

bool store_read(const SchemaRow *row, const char *text, StoredNumber *number, Complaint *complaint)
{
    size_t whole = 0;
    bool is_read = false;
    *number = (StoredNumber){.value = 0.0};
    switch (row->type) {
    case SCHEMA_INTEGER:
        is_read = quantity_integer(text, &whole, complaint);
        number->value = (double)whole; // exact: it is at most 2^53
        return is_read;
    case SCHEMA_STIFFNESS:
        return quantity_stiffness(text, &number->value, &number->exponent, complaint);
    case SCHEMA_SPAN:
        return quantity_span(text, &number->value, &number->is_in_turns, complaint);
    case SCHEMA_TOLERATED:
        is_read = quantity_tolerated(text, &number->length, complaint);
        number->value = number->length.nominal;
        return is_read;
    default:
        return quantity_parse(text, row->dimension, &number->value, complaint);
    }
}

// One number, from its node or from one of a pair, in the range of its row.
static bool read_number(const Target *target, const Node *node, StoredNumber *number)
{
    const SchemaRow *row = target->entry->row;
    Complaint complaint;
    if (!check_scalar(target, node)) {
        return false;
    }
    if (store_read(row, node->text, number, &complaint)) {
        return check_range(target, node, number->value);
    }
    const bool is_special = row->type == SCHEMA_INTEGER || row->type == SCHEMA_STIFFNESS ||
                            row->type == SCHEMA_SPAN || row->type == SCHEMA_TOLERATED;
    // a size with a tolerance is a fair thing to try
    const char *sign = is_special                         ? NULL
                       : strstr(node->text, "+-") != NULL ? "+-"
                       : strstr(node->text, "±") != NULL  ? "±"
                                                          : NULL;
    if (sign != NULL) {
        return source_error(target->entry->source, node->span, "a value without tolerance",
                            target->err, "%s takes no tolerance (%s)", target->path, sign);
    }
    if (row->type == SCHEMA_INTEGER) {
        char range[QUANTITY_TEXT_SIZE];
        describe_range(row, range);
        snprintf(complaint.allowed, sizeof complaint.allowed, "a whole number, %.64s", range);
    }
    return source_error(target->entry->source, node->span, complaint.allowed, target->err, "%s",
                        complaint.text);
}

// A number of any kind, or the word that stands for 0.
static bool store_number(const Target *target, Scenario *scenario)
{
    const Node *node = target->entry->node;
    const SchemaRow *row = target->entry->row;
    const char *word = row->zero_word;
    StoredNumber number = {.value = 0.0};
    const bool is_word = word != NULL && node->kind == NODE_SCALAR && strcmp(node->text, word) == 0;
    if (word != NULL && !is_word && node->kind == NODE_SCALAR &&
        strcspn(node->text, "0123456789") > 1) {
        return refuse(target, node->span, "'%.40s' is no choice for %s", node->text, target->path);
    }
    if (!is_word && !read_number(target, node, &number)) {
        return false;
    }
    switch (row->type) {
    case SCHEMA_INTEGER:
        *(size_t *)target->field = (size_t)number.value;
        break;
    case SCHEMA_TOLERATED:
        if (!(number.length.nominal + number.length.lower > 0.0)) {
            return source_error(target->entry->source, node->span,
                                "a tolerance smaller than the length", target->err,
                                "with its tolerance %s falls to 0 or below", target->path);
        }
        *(ToleratedLength *)target->field = number.length;
        break;
    case SCHEMA_STIFFNESS:
        scenario->contact.stiffness = number.value;
        scenario->contact.exponent = number.exponent;
        break;
    case SCHEMA_SPAN:
        scenario->run.report_from = number.value;
        scenario->run.is_report_from_in_turns = number.is_in_turns;
        break;
    case SCHEMA_RADIAL_CLEARANCE:
        ((Clearance *)target->field)->pin_radius = PIN_RADIUS;
        ((Clearance *)target->field)->hole_radius = PIN_RADIUS + number.value;
        break;
    default: // SCHEMA_ALONG is moved once the links are known
        *(double *)target->field = row->type == SCHEMA_DIAMETER ? 0.5 * number.value : number.value;
    }
    return true;
}

// Finds the number of a word in the row's list.
static bool find_word(const Target *target, const Node *node, int *number)
{
    if (!check_scalar(target, node)) {
        return false;
    }
    const char *const *words = target->entry->row->words;
    size_t count = 0;
    for (; words[count] != NULL; count++) {
        if (strcmp(words[count], node->text) == 0) {
            *number = (int)count;
            return true;
        }
    }
    const char *nearest = text_nearest(node->text, words, count);
    return refuse(target, node->span, "'%.40s' is no choice for %s%s%s%s", node->text, target->path,
                  nearest != NULL ? "; did you mean '" : "", nearest != NULL ? nearest : "",
                  nearest != NULL ? "'?" : "");
}

static bool store_backends(const Target *target, RunOptions *run)
{
    const Node *node = target->entry->node;
    const bool is_list = node->kind == NODE_LIST;
    RunOptions read = {0};
    for (const Node *item = is_list ? node->first : node; item != NULL;
         item = is_list ? item->next : NULL) {
        int number = 0;
        if (!find_word(target, item, &number)) {
            return false;
        }
        for (size_t i = 0; i < read.backend_count; i++) {
            if (read.backends[i] == (BackendKind)number) {
                return source_error(target->entry->source, item->span, "each backend once",
                                    target->err, "'%s' is listed twice", item->text);
            }
        }
        read.backends[read.backend_count++] = (BackendKind)number;
    }
    if (read.backend_count == 0) {
        return source_error(target->entry->source, node->span, "at least one backend", target->err,
                            "the list %s is empty", target->path);
    }
    memcpy(run->backends, read.backends, sizeof read.backends);
    run->backend_count = read.backend_count;
    return true;
}

static bool store_text(const Target *target, char *field, size_t size)
{
    const Node *node = target->entry->node;
    if (!check_scalar(target, node)) {
        return false;
    }
    if (strlen(node->text) >= size) {
        char allowed[QUANTITY_TEXT_SIZE];
        snprintf(allowed, sizeof allowed, "at most %zu bytes", size - 1);
        return source_error(target->entry->source, node->span, allowed, target->err,
                            "%s is too long: %zu bytes", target->path, strlen(node->text));
    }
    text_copy(field, size, node->text);
    return true;
}

// The two items of a list of two; false for anything else.
static bool find_pair(const Node *node, const Node *pair[2])
{
    pair[0] = node->kind == NODE_LIST ? node->first : NULL;
    pair[1] = pair[0] != NULL ? pair[0]->next : NULL;
    return pair[1] != NULL && pair[1]->next == NULL;
}

static bool store_vector(const Target *target)
{
    const Node *node = target->entry->node;
    const SchemaRow *row = target->entry->row;
    StoredNumber x = {.value = 0.0};
    StoredNumber y = x;
    const bool is_word = row->default_words != NULL && node->kind == NODE_SCALAR &&
                         strcmp(node->text, row->default_words) == 0;
    const Node *pair[2];
    if (!is_word && row->default_words != NULL && node->kind == NODE_SCALAR &&
        text_nearest(node->text, &row->default_words, 1) != NULL) {
        return refuse(target, node->span, "'%.40s' is no place; did you mean '%s'?", node->text,
                      row->default_words);
    }
    if (!is_word && !find_pair(node, pair)) {
        return refuse(target, node->span, "%s takes %s", target->path,
                      row->dimension == DIMENSION_SPEED ? "two speeds" : "a place");
    }
    if (!is_word && (!read_number(target, pair[0], &x) || !read_number(target, pair[1], &y))) {
        return false;
    }
    *(Vec2 *)target->field = (Vec2){x.value, y.value};
    return true;
}

// A direction of any length, kept as one of length 1.
static bool store_direction(const Target *target)
{
    const Node *node = target->entry->node;
    const Node *item = node->kind == NODE_LIST ? node->first : NULL;
    double parts[3] = {0.0, 0.0, 0.0};
    int count = 0;
    for (; item != NULL && count < 3; item = item->next) {
        StoredNumber number;
        if (!read_number(target, item, &number)) {
            return false;
        }
        parts[count++] = number.value;
    }
    const Vec3 along = {parts[0], parts[1], parts[2]};
    if (count < 3 || item != NULL || !(vec3_length(along) > 0.0)) {
        return refuse(target, node->span, "%s takes a direction of three numbers, not all 0",
                      target->path);
    }
    *(Vec3 *)target->field = vec3_scale(1.0 / vec3_length(along), along);
    return true;
}

// Finds the number of a body or joint that the case names; the ground where it may stand.
static bool find_name(const Target *target, const Node *node, SchemaFamily family,
                      bool may_be_ground, int *number)
{
    if (!check_scalar(target, node)) {
        return false;
    }
    *number = entries_number(target->entries, family, node->text);
    if (*number < 0 && !(may_be_ground && strcmp(node->text, "ground") == 0)) {
        return entries_refuse_name(target->entries, target->entry->source, family, may_be_ground,
                                   node->text, node->span, target->err);
    }
    return true; // the ground is LINKAGE_GROUND, which is what an unknown name has
}

static bool store_between(const Target *target, int *body_a, int *body_b)
{
    const Node *node = target->entry->node;
    const Node *pair[2];
    if (!find_pair(node, pair)) {
        return refuse(target, node->span, "%s takes the two bodies of the %s", target->path,
                      SCHEMA_FAMILIES[target->entry->row->family].what);
    }
    if (!find_name(target, pair[0], SCHEMA_BODY, true, body_a) ||
        !find_name(target, pair[1], SCHEMA_BODY, true, body_b)) {
        return false;
    }
    return *body_a != *body_b ||
           source_error(target->entry->source, pair[1]->span, "two different bodies", target->err,
                        "%s names %s twice", target->path, pair[1]->text);
}

// A pin at the wall is at the wall, though the difference of two radii is rounded.
static void seat_pin(Clearance *clearance)
{
    const double radial = clearance->hole_radius - clearance->pin_radius;
    const double start = vec2_length(clearance->start);
    if (start > radial && start <= radial * (1.0 + ROUNDING)) {
        clearance->start = vec2_scale(radial / start * (1.0 - DBL_EPSILON), clearance->start);
    }
}

bool store_value(const Entries *entries, const Entry *entry, Scenario *scenario, Err *err)
{
    Target target = {.entries = entries, .entry = entry, .err = err};
    schema_path(entry->row, entries_name(entries, entry->row, entry->index), target.path);
    target.field = schema_field(entry->row, scenario, entry->index);
    Joint *joint;
    Spring *spring;
    switch (entry->row->type) {
    case SCHEMA_CHOICE:
        return find_word(&target, entry->node, target.field); // an enumeration is an int
    case SCHEMA_BACKENDS:
        return store_backends(&target, &scenario->run);
    case SCHEMA_TEXT:
        return store_text(&target, target.field, SCENARIO_TITLE_SIZE);
    case SCHEMA_VECTOR:
    case SCHEMA_ANCHOR: // moved to its body's frame once the bodies are placed
        if (!store_vector(&target)) {
            return false;
        }
        if (entry->row->family == SCHEMA_JOINT) {
            seat_pin(&scenario->linkage.joints[entry->index].clearance);
        }
        return true;
    case SCHEMA_DIRECTION:
        return store_direction(&target);
    case SCHEMA_BETWEEN:
        // there are more joints than springs: the address of either is formed for its own alone
        if (entry->row->family == SCHEMA_SPRING) {
            spring = &scenario->linkage.springs[entry->index];
            return store_between(&target, &spring->body_a, &spring->body_b);
        }
        joint = &scenario->linkage.joints[entry->index];
        return store_between(&target, &joint->body_a, &joint->body_b);
    case SCHEMA_BODY_NAME:
        return find_name(&target, entry->node, SCHEMA_BODY, false, target.field);
    case SCHEMA_JOINT_NAME:
        return find_name(&target, entry->node, SCHEMA_JOINT, false, target.field);
    case SCHEMA_TORQUE:
        return torque_table_store(entry, target.field, err);
    case SCHEMA_EXPECT:
        return expect_store(entries, entry, scenario, err);
    default:
        return store_number(&target, scenario);
    }
}
