// How does a torque or a force over time stand in a case?
#include "casefile/torque_table.h"

#include "casefile/quantity.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>

// What the key takes, a torque or a force.
static const char *word_of(const Entry *entry)
{
    return entry->row->dimension == DIMENSION_FORCE ? "force" : "torque";
}

__attribute__((format(printf, 4, 5))) static bool refuse(const Entry *entry, const Node *node,
                                                         Err *err, const char *format, ...)
{
    char message[QUANTITY_TEXT_SIZE];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(message, sizeof message, format, arguments);
    va_end(arguments);
    const char *unit = units_si(entry->row->dimension);
    char allowed[QUANTITY_TEXT_SIZE];
    snprintf(allowed, sizeof allowed,
             "a %s such as %s, or points [time, %s] in the order of time: [[0 s, 1 %s], [10 ms, "
             "0 %s]]",
             word_of(entry), units_example(entry->row->dimension), word_of(entry), unit, unit);
    return source_error(entry->source, node->span, allowed, err, "%s", message);
}

static bool read_number(const Entry *entry, const Node *node, Dimension dimension, double *number,
                        Err *err)
{
    Complaint complaint;
    if (node->kind != NODE_SCALAR || node->text[0] == '\0') {
        return refuse(entry, node, err, "%s takes a %s, or points of time and %s", entry->row->path,
                      word_of(entry), word_of(entry));
    }
    return quantity_parse(node->text, dimension, number, &complaint) ||
           source_error(entry->source, node->span, complaint.allowed, err, "%s", complaint.text);
}

static bool read_torque(const Entry *entry, const Node *node, double *torque, Err *err)
{
    const SchemaRow *row = entry->row;
    if (!read_number(entry, node, row->dimension, torque, err)) {
        return false;
    }
    char allowed[64];
    snprintf(allowed, sizeof allowed, "%g to %g %s", row->low, row->high, units_si(row->dimension));
    return fabs(*torque) <= row->high ||
           source_error(entry->source, node->span, allowed, err, "%s is out of range: %.60s",
                        row->path, node->text);
}

static bool read_point(const Entry *entry, const Node *node, Torque *torque, Err *err)
{
    const Node *time = node->kind == NODE_LIST ? node->first : NULL;
    const Node *value = time != NULL ? time->next : NULL;
    const size_t number = torque->count;
    if (value == NULL || value->next != NULL) {
        return refuse(entry, node, err, "a point of %s is a time and a %s", entry->row->path,
                      word_of(entry));
    }
    if (number == LINKAGE_TORQUE_MAX) {
        char allowed[64];
        snprintf(allowed, sizeof allowed, "at most %d points", LINKAGE_TORQUE_MAX);
        return source_error(entry->source, node->span, allowed, err, "one point of %s too many",
                            entry->row->path);
    }
    if (!read_number(entry, time, DIMENSION_TIME, &torque->times[number], err) ||
        !read_torque(entry, value, &torque->values[number], err)) {
        return false;
    }
    if (!(torque->times[number] >= 0.0) ||
        (number > 0 && !(torque->times[number] > torque->times[number - 1]))) {
        return refuse(entry, time, err, "the times of %s must increase, from 0 s or later",
                      entry->row->path);
    }
    torque->count++;
    return true;
}

bool torque_table_store(const Entry *entry, Torque *torque, Err *err)
{
    const Node *node = entry->node;
    Torque read = {.joint = torque->joint};
    if (node->kind != NODE_LIST) {
        read.count = 1;
        if (!read_torque(entry, node, &read.values[0], err)) {
            return false;
        }
        *torque = read;
        return true;
    }
    for (const Node *point = node->first; point != NULL; point = point->next) {
        if (!read_point(entry, point, &read, err)) {
            return false;
        }
    }
    if (read.count == 0) {
        return refuse(entry, node, err, "%s has no point", entry->row->path);
    }
    *torque = read;
    return true;
}
