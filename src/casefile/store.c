// What does a value mean, and is it in its range?
#include "casefile/store.h"

#include "casefile/quantity.h"

#include <stdio.h>
#include <string.h>

static const double PIN_RADIUS = 5e-3; // m, where only the radial clearance is given: the paper's

// Whatever a store function needs to know.
typedef struct Target {
    const Entry *entry;
    char path[SCHEMA_PATH_SIZE]; // of the key, for messages
    void *field;
    Err *err;
} Target;

static bool complain_at(const Target *target, const Node *node, const Complaint *complaint)
{
    return source_error(target->entry->source, node->span, complaint->allowed, target->err, "%s",
                        complaint->text);
}

// What the row takes, in words.
static void describe_allowed(const SchemaRow *row, char *text, size_t size)
{
    if (row->words != NULL) {
        size_t length = 0;
        text[0] = '\0';
        for (size_t i = 0; row->words[i] != NULL && length < size; i++) {
            const char *separator = i > 0 ? ", " : "";
            length +=
                (size_t)snprintf(text + length, size - length, "%s%s", separator, row->words[i]);
        }
    } else if (row->type == SCHEMA_TEXT) {
        snprintf(text, size, "text on one line");
    } else if (row->type == SCHEMA_INTEGER) {
        snprintf(text, size, "a whole number such as 100");
    } else {
        snprintf(text, size, "%s such as %s", units_dimension_name(row->dimension),
                 units_example(row->dimension));
    }
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
    char allowed[QUANTITY_TEXT_SIZE];
    describe_allowed(row, allowed, sizeof allowed);
    return source_error(target->entry->source, span, allowed, target->err,
                        is_scalar ? "%s has no value" : "%s takes a single value", target->path);
}

static bool check_range(const Target *target, const Node *node, double value)
{
    const SchemaRow *row = target->entry->row;
    if (value <= row->high && (row->low_is_open ? value > row->low : value >= row->low)) {
        return true;
    }
    if (row->low == row->high) {
        char only[QUANTITY_TEXT_SIZE];
        snprintf(only, sizeof only, "%g", row->low);
        return source_error(target->entry->source, node->span, only, target->err, "%s: %s",
                            target->path, row->doc);
    }
    const char *unit = units_si(row->dimension);
    const char *blank = unit[0] != '\0' ? " " : "";
    char allowed[QUANTITY_TEXT_SIZE];
    snprintf(allowed, sizeof allowed,
             row->low_is_open ? "above %g and up to %g%s%s" : "%g to %g%s%s", row->low, row->high,
             blank, unit);
    return source_error(target->entry->source, node->span, allowed, target->err,
                        "%s is out of range: %.60s", target->path, node->text);
}

static bool store_number(const Target *target, double scale)
{
    const Node *node = target->entry->node;
    Complaint complaint;
    double value;
    if (!check_scalar(target, node)) {
        return false;
    }
    if (!quantity_parse(node->text, target->entry->row->dimension, &value, &complaint)) {
        // a size with a tolerance is a fair thing to try
        const char *sign = strstr(node->text, "+-") != NULL  ? "+-"
                           : strstr(node->text, "±") != NULL ? "±"
                                                             : NULL;
        if (sign != NULL) {
            return source_error(target->entry->source, node->span, "a value without tolerance",
                                target->err, "%s takes no tolerance (%s)", target->path, sign);
        }
        return complain_at(target, node, &complaint);
    }
    if (!check_range(target, node, value)) {
        return false;
    }
    *(double *)target->field = scale * value;
    return true;
}

static bool store_tolerated(const Target *target)
{
    const Node *node = target->entry->node;
    Complaint complaint;
    ToleratedLength length;
    if (!check_scalar(target, node)) {
        return false;
    }
    if (!quantity_tolerated(node->text, &length, &complaint)) {
        return complain_at(target, node, &complaint);
    }
    if (!check_range(target, node, length.nominal)) {
        return false;
    }
    if (!(length.nominal + length.lower > 0.0)) {
        return source_error(target->entry->source, node->span,
                            "a tolerance smaller than the length", target->err,
                            "with its tolerance %s falls to 0 or below", target->path);
    }
    *(ToleratedLength *)target->field = length;
    return true;
}

static bool store_integer(const Target *target)
{
    const Node *node = target->entry->node;
    Complaint complaint;
    size_t value;
    if (!check_scalar(target, node)) {
        return false;
    }
    if (!quantity_integer(node->text, &value, &complaint)) {
        return complain_at(target, node, &complaint);
    }
    if (!check_range(target, node, (double)value)) {
        return false;
    }
    *(size_t *)target->field = value;
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
    char hint[LINKAGE_NAME_SIZE + 24] = "";
    if (nearest != NULL) {
        snprintf(hint, sizeof hint, "; did you mean '%s'?", nearest);
    }
    char allowed[QUANTITY_TEXT_SIZE];
    describe_allowed(target->entry->row, allowed, sizeof allowed);
    return source_error(target->entry->source, node->span, allowed, target->err,
                        "'%.40s' is no choice for %s%s", node->text, target->path, hint);
}

static bool store_choice(const Target *target)
{
    int number;
    if (!find_word(target, target->entry->node, &number)) {
        return false;
    }
    memcpy(target->field, &number, sizeof number); // every enumeration here has the size of int
    return true;
}

static bool store_backends(const Target *target, RunOptions *run)
{
    const Node *node = target->entry->node;
    const Node *item = node->kind == NODE_LIST ? node->first : node;
    if (item == NULL) {
        return source_error(target->entry->source, node->span, "at least one backend", target->err,
                            "the list %s is empty", target->path);
    }
    BackendKind backends[BACKEND_COUNT];
    size_t count = 0;
    for (; item != NULL; item = node->kind == NODE_LIST ? item->next : NULL) {
        int number;
        if (!find_word(target, item, &number)) {
            return false;
        }
        for (size_t i = 0; i < count; i++) {
            if (backends[i] == (BackendKind)number) {
                return source_error(target->entry->source, item->span, "each backend once",
                                    target->err, "'%s' is listed twice", item->text);
            }
        }
        backends[count++] = (BackendKind)number;
    }
    memcpy(run->backends, backends, count * sizeof backends[0]);
    run->backend_count = count;
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

static bool store_stiffness(const Target *target, ContactOptions *contact)
{
    const Node *node = target->entry->node;
    Complaint complaint;
    double stiffness;
    double exponent;
    if (!check_scalar(target, node)) {
        return false;
    }
    if (!quantity_stiffness(node->text, &stiffness, &exponent, &complaint)) {
        return complain_at(target, node, &complaint);
    }
    if (!check_range(target, node, stiffness)) {
        return false;
    }
    contact->stiffness = stiffness;
    contact->exponent = exponent;
    return true;
}

static bool store_eccentricity(const Target *target)
{
    const Node *node = target->entry->node;
    Vec2 start = {0.0, 0.0};
    if (node->kind == NODE_SCALAR && strcmp(node->text, "centred") == 0) {
        *(Vec2 *)target->field = start;
        return true;
    }
    const Node *x = node->kind == NODE_LIST ? node->first : NULL;
    const Node *y = x != NULL ? x->next : NULL;
    if (y == NULL || y->next != NULL) {
        return source_error(target->entry->source, node->span,
                            "centred, or [x, y] such as "
                            "[5 um, 0 um]",
                            target->err, "%s takes a place", target->path);
    }
    double *const parts[] = {&start.x, &start.y};
    const Node *const nodes[] = {x, y};
    for (size_t i = 0; i < 2; i++) {
        Complaint complaint;
        if (!check_scalar(target, nodes[i])) {
            return false;
        }
        if (!quantity_parse(nodes[i]->text, DIMENSION_LENGTH, parts[i], &complaint)) {
            return complain_at(target, nodes[i], &complaint);
        }
        if (!check_range(target, nodes[i], *parts[i])) {
            return false;
        }
    }
    *(Vec2 *)target->field = start;
    return true;
}

static bool store_radial_clearance(const Target *target, Clearance *clearance)
{
    double radial;
    Target number = *target;
    number.field = &radial;
    if (!store_number(&number, 1.0)) {
        return false;
    }
    clearance->pin_radius = PIN_RADIUS;
    clearance->hole_radius = PIN_RADIUS + radial;
    return true;
}

bool store_value(const Entries *entries, const Entry *entry, Scenario *scenario, Err *err)
{
    Target target = {.entry = entry, .err = err};
    schema_path(entry->row, entries_name(entries, entry->row, entry->index), target.path);
    target.field = schema_field(entry->row, scenario, entry->index);
    switch (entry->row->type) {
    case SCHEMA_DIAMETER:
        return store_number(&target, 0.5);
    case SCHEMA_TOLERATED:
        return store_tolerated(&target);
    case SCHEMA_INTEGER:
        return store_integer(&target);
    case SCHEMA_CHOICE:
        return store_choice(&target);
    case SCHEMA_BACKENDS:
        return store_backends(&target, &scenario->run);
    case SCHEMA_TEXT:
        return store_text(&target, target.field, SCENARIO_TITLE_SIZE);
    case SCHEMA_STIFFNESS:
        return store_stiffness(&target, &scenario->contact);
    case SCHEMA_ECCENTRICITY:
        return store_eccentricity(&target);
    case SCHEMA_RADIAL_CLEARANCE:
        return store_radial_clearance(&target, target.field);
    case SCHEMA_QUANTITY:
    case SCHEMA_ALONG: // moved to the centre of mass once the links are known
    default:
        return store_number(&target, 1.0);
    }
}
