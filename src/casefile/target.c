// Reads one value of a case, and checks that it is in the range of its key.
#include "casefile/target.h"

#include "base/printable.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

void target_describe(const Entries *entries, const SchemaRow *row, Text *text)
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

bool target_refuse(const Target *target, Span span, const char *format, ...)
{
    char message[QUANTITY_TEXT_SIZE];
    va_list arguments;
    va_start(arguments, format);
    shorten_list(message, sizeof message, format, arguments);
    va_end(arguments);
    Text allowed;
    text_init(&allowed);
    target_describe(target->entries, target->entry->row, &allowed);
    source_error(target->entry->source, span, allowed.data, target->err, "%s", message);
    text_finish(&allowed);
    return false;
}

bool target_check_scalar(const Target *target, const Node *node)
{
    const SchemaRow *row = target->entry->row;
    const bool is_scalar = node->kind == NODE_SCALAR;
    if (is_scalar && (node->text[0] != '\0' || row->type == SCHEMA_TEXT)) {
        return true;
    }
    const Span span = is_scalar && node->key != NULL ? node->key->span : node->span;
    return target_refuse(target, span, is_scalar ? "%s has no value" : "%s takes a single value",
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

bool target_read(const SchemaRow *row, const char *text, TargetNumber *number, Complaint *complaint)
{
    size_t whole = 0;
    bool is_read = false;
    *number = (TargetNumber){.value = 0.0};
    switch (row->type) {
    case SCHEMA_INTEGER:
        is_read = quantity_integer(text, &whole, complaint);
        number->value = (double)whole; // exact: it is at most 2^53
        return is_read;
    case SCHEMA_STIFFNESS:
        return quantity_stiffness(text, row->dimension, &number->value, &number->exponent,
                                  complaint);
    case SCHEMA_SPAN:
        return quantity_span(text, &number->value, &number->is_in_turns, complaint);
    default:
        return quantity_parse(text, row->dimension, &number->value, complaint);
    }
}

bool target_number(const Target *target, const Node *node, TargetNumber *number)
{
    const SchemaRow *row = target->entry->row;
    Complaint complaint;
    if (!target_check_scalar(target, node)) {
        return false;
    }
    if (target_read(row, node->text, number, &complaint)) {
        return check_range(target, node, number->value);
    }
    const bool is_special =
        row->type == SCHEMA_INTEGER || row->type == SCHEMA_STIFFNESS || row->type == SCHEMA_SPAN;
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

bool target_quantity(const Target *target, const Node *node, Dimension dimension, double *number)
{
    Complaint complaint;
    return target_check_scalar(target, node) &&
           (quantity_parse(node->text, dimension, number, &complaint) ||
            source_error(target->entry->source, node->span, complaint.allowed, target->err, "%s",
                         complaint.text));
}

bool target_pair(const Node *node, const Node *pair[2])
{
    pair[0] = node->kind == NODE_LIST ? node->first : NULL;
    pair[1] = pair[0] != NULL ? pair[0]->next : NULL;
    return pair[1] != NULL && pair[1]->next == NULL;
}
