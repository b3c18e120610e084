// How does a torque over time stand in a case?
#include "casefile/torque_table.h"

#include "casefile/quantity.h"

#include <math.h>
#include <stdio.h>

static const char ALLOWED[] = "a torque such as 0.1 N m, or points [time, torque] in the order of "
                              "time: [[0 s, 1 N m], [10 ms, 0 N m]]";

static bool refuse(const Entry *entry, const Node *node, const char *what, Err *err)
{
    return source_error(entry->source, node->span, ALLOWED, err, "%s", what);
}

static bool read_number(const Entry *entry, const Node *node, Dimension dimension, double *number,
                        Err *err)
{
    Complaint complaint;
    if (node->kind != NODE_SCALAR || node->text[0] == '\0') {
        return refuse(entry, node, "drive.torque takes a torque, or points of time and torque",
                      err);
    }
    return quantity_parse(node->text, dimension, number, &complaint) ||
           source_error(entry->source, node->span, complaint.allowed, err, "%s", complaint.text);
}

static bool read_torque(const Entry *entry, const Node *node, double *torque, Err *err)
{
    const double most = entry->row->high;
    if (!read_number(entry, node, DIMENSION_TORQUE, torque, err)) {
        return false;
    }
    return fabs(*torque) <= most || source_error(entry->source, node->span, "-1e9 to 1e9 N m", err,
                                                 "drive.torque is out of range: %.60s", node->text);
}

static bool read_point(const Entry *entry, const Node *node, Torque *torque, Err *err)
{
    const Node *time = node->kind == NODE_LIST ? node->first : NULL;
    const Node *value = time != NULL ? time->next : NULL;
    const size_t number = torque->count;
    if (value == NULL || value->next != NULL) {
        return refuse(entry, node, "a point of drive.torque is a time and a torque", err);
    }
    if (number == LINKAGE_TORQUE_MAX) {
        char allowed[64];
        snprintf(allowed, sizeof allowed, "at most %d points", LINKAGE_TORQUE_MAX);
        return source_error(entry->source, node->span, allowed, err,
                            "one point of drive.torque too many");
    }
    if (!read_number(entry, time, DIMENSION_TIME, &torque->times[number], err) ||
        !read_torque(entry, value, &torque->values[number], err)) {
        return false;
    }
    if (!(torque->times[number] >= 0.0) ||
        (number > 0 && !(torque->times[number] > torque->times[number - 1]))) {
        return refuse(entry, time, "the times of drive.torque must increase, from 0 s or later",
                      err);
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
        return refuse(entry, node, "drive.torque has no point", err);
    }
    *torque = read;
    return true;
}
