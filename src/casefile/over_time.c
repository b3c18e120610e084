// Reads a torque, a speed or an angle over time.
#include "casefile/over_time.h"

#include "casefile/quantity.h"
#include "casefile/waves.h"

#include "base/drive.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

// 1: of an amplitude, what the digits of a mean that lets an angle begin with 0 may leave
static const double ANGLE_ROUNDING = 1e-9;

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

bool over_time_store(const Entries *entries, const Entry *entry, TimeTable *table, Err *err)
{
    const Node *node = entry->node;
    TimeTable read = {.count = 0};
    WaveRead wave;
    if (waves_is_one(entry)) {
        if (!waves_read(entries, entry, entry->row->dimension, 1.0, &wave, err)) {
            return false;
        }
        *table = (TimeTable){.count = 1, .values = {wave.mean}, .wave = wave.wave};
        return true;
    }
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

bool over_time_store_speed(const Entries *entries, const Entry *entry, Driver *driver, Err *err)
{
    const double period_s = driver->table.period_s;
    if (!over_time_store(entries, entry, &driver->table, err)) {
        return false;
    }
    driver->table.period_s = period_s;
    driver->has_angles = false;
    drive_complete(driver);
    bool is_constant = driver->table.wave.amplitude == 0.0;
    for (size_t i = 0; i < driver->table.count; i++) {
        is_constant = is_constant && driver->table.values[i] == driver->speed;
    }
    if (is_constant) {
        driver->table = (TimeTable){.count = 0};
    }
    return true;
}

// A sinusoid begins with angle 0 where the case does not say its mean.
static bool read_swing(const Entries *entries, const Entry *entry, bool is_soft, TimeTable *table,
                       Err *err)
{
    WaveRead read;
    if (!waves_read(entries, entry, DIMENSION_ANGLE, 1.0, &read, err)) {
        return false;
    }
    const double first = wave_at(&read.wave, 0.0);
    if (read.has_mean && !is_soft &&
        !(fabs(read.mean + first) <= ANGLE_ROUNDING * fabs(read.wave.amplitude))) {
        return refuse(entry, entry->node, err,
                      "%s counts from the start, so that it begins with 0: without mean it does",
                      entry->row->path);
    }
    *table = (TimeTable){.count = 1, .wave = read.wave};
    table->values[0] = read.has_mean && is_soft ? read.mean : -first;
    return true;
}

bool over_time_store_angles(const Entries *entries, const Entry *entry, Driver *driver, Err *err)
{
    const bool is_soft = strncmp(entry->row->path, "drive.", strlen("drive.")) == 0 &&
                         entries_blame(entries, "drive.stiffness drive.damping", 0) != NULL;
    const double period_s = driver->table.period_s;
    TimeTable read;
    if (!(waves_is_one(entry) ? read_swing(entries, entry, is_soft, &read, err)
                              : over_time_store(entries, entry, &read, err))) {
        return false;
    }
    read.period_s = period_s;
    const Node *node = entry->node;
    if (!waves_is_one(entry) && !is_soft && (node->kind != NODE_LIST || read.count < 2)) {
        return refuse(entry, node, err, "%s takes two points at least%s", entry->row->path,
                      node->kind != NODE_LIST ? "; only a soft drive holds one angle" : "");
    }
    if (!waves_is_one(entry) && !is_soft && read.values[0] != 0.0) {
        return refuse(entry, node->first, err, "%s counts from the start, so that it begins with 0",
                      entry->row->path);
    }
    driver->table = read;
    driver->has_angles = true;
    return true;
}
