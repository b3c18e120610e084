// Reads a torque, a speed or an angle over time.
#include "casefile/over_time.h"

#include "casefile/quantity.h"

#include "model/drive.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>

// What messages say of a quantity over time.
typedef struct Words {
    const char *name; // with its article
    const char *bare;
    const char *allowed;
} Words;

static const Words TORQUE_WORDS = {
    .name = "a torque",
    .bare = "torque",
    .allowed = "a torque such as 0.1 N m, or points [time, torque] in the order of time: [[0 s, "
               "1 N m], [10 ms, 0 N m]]",
};

static const Words FORCE_WORDS = {
    .name = "a force",
    .bare = "force",
    .allowed = "a force such as 1.2 kN, or points [time, force] in the order of time: [[0 s, 1 N], "
               "[10 ms, 0 N]]",
};

static const Words SPEED_WORDS = {
    .name = "a speed",
    .bare = "speed",
    .allowed = "a speed such as 1000 rpm, or points [time, speed] in the order of time: [[0 s, "
               "0 rpm], [10 ms, 1000 rpm]]",
};

static const Words ANGLE_WORDS = {
    .name = "an angle",
    .bare = "angle",
    .allowed = "points [time, angle] in the order of time: [[0 s, 0 deg], [0.5 s, 90 deg], [1 s, "
               "0 deg]]",
};

static const Words *words_of(const Entry *entry)
{
    switch (entry->row->dimension) {
    case DIMENSION_TORQUE:
        return &TORQUE_WORDS;
    case DIMENSION_FORCE:
        return &FORCE_WORDS;
    case DIMENSION_ANGLE:
        return &ANGLE_WORDS;
    default:
        return &SPEED_WORDS;
    }
}

__attribute__((format(printf, 4, 5))) static bool refuse(const Entry *entry, const Node *node,
                                                         Err *err, const char *format, ...)
{
    char message[QUANTITY_TEXT_SIZE];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(message, sizeof message, format, arguments);
    va_end(arguments);
    return source_error(entry->source, node->span, words_of(entry)->allowed, err, "%s", message);
}

static bool read_number(const Entry *entry, const Node *node, Dimension dimension, double *number,
                        Err *err)
{
    const Words *words = words_of(entry);
    Complaint complaint;
    if (node->kind != NODE_SCALAR || node->text[0] == '\0') {
        return refuse(entry, node, err, "%s takes %s, or points of time and %s", entry->row->path,
                      words->name, words->bare);
    }
    return quantity_parse(node->text, dimension, number, &complaint) ||
           source_error(entry->source, node->span, complaint.allowed, err, "%s", complaint.text);
}

static bool read_value(const Entry *entry, const Node *node, double *value, Err *err)
{
    if (!read_number(entry, node, entry->row->dimension, value, err)) {
        return false;
    }
    const SchemaRow *row = entry->row;
    char allowed[64];
    snprintf(allowed, sizeof allowed, "%g to %g %s", row->low, row->high, units_si(row->dimension));
    return fabs(*value) <= row->high ||
           source_error(entry->source, node->span, allowed, err, "%s is out of range: %.60s",
                        row->path, node->text);
}

static bool read_point(const Entry *entry, const Node *node, TimeTable *table, Err *err)
{
    const Node *time = node->kind == NODE_LIST ? node->first : NULL;
    const Node *value = time != NULL ? time->next : NULL;
    const size_t number = table->count;
    const char *path = entry->row->path;
    if (value == NULL || value->next != NULL) {
        return refuse(entry, node, err, "a point of %s is a time and %s", path,
                      words_of(entry)->name);
    }
    if (number == TIME_TABLE_MAX) {
        char allowed[64];
        snprintf(allowed, sizeof allowed, "at most %d points", TIME_TABLE_MAX);
        return source_error(entry->source, node->span, allowed, err, "one point of %s too many",
                            path);
    }
    if (!read_number(entry, time, DIMENSION_TIME, &table->times[number], err) ||
        !read_value(entry, value, &table->values[number], err)) {
        return false;
    }
    if (!(table->times[number] >= 0.0) ||
        (number > 0 && !(table->times[number] > table->times[number - 1]))) {
        return refuse(entry, time, err, "the times of %s must increase, from 0 s or later", path);
    }
    table->count++;
    return true;
}

bool over_time_store(const Entry *entry, TimeTable *table, Err *err)
{
    const Node *node = entry->node;
    TimeTable read = {.count = 0};
    if (node->kind != NODE_LIST) {
        read.count = 1;
        if (!read_value(entry, node, &read.values[0], err)) {
            return false;
        }
        *table = read;
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
    *table = read;
    return true;
}

bool over_time_store_speed(const Entry *entry, Driver *driver, Err *err)
{
    if (!over_time_store(entry, &driver->table, err)) {
        return false;
    }
    driver->has_angles = false;
    drive_complete(driver);
    bool is_constant = true;
    for (size_t i = 0; i < driver->table.count; i++) {
        is_constant = is_constant && driver->table.values[i] == driver->speed;
    }
    if (is_constant) {
        driver->table = (TimeTable){.count = 0};
    }
    return true;
}

bool over_time_store_angles(const Entry *entry, Driver *driver, Err *err)
{
    TimeTable read = {.period_s = driver->table.period_s};
    if (!over_time_store(entry, &read, err)) {
        return false;
    }
    const Node *node = entry->node;
    if (node->kind != NODE_LIST || read.count < 2) {
        return refuse(entry, node, err, "%s takes two points at least", entry->row->path);
    }
    if (read.values[0] != 0.0) {
        return refuse(entry, node->first, err, "%s counts from the start, so that it begins with 0",
                      entry->row->path);
    }
    driver->table = read;
    driver->has_angles = true;
    return true;
}
