// Reads a torque or a speed over time.
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

static const Words *words_of(const Entry *entry)
{
    switch (entry->row->dimension) {
    case DIMENSION_TORQUE:
        return &TORQUE_WORDS;
    case DIMENSION_FORCE:
        return &FORCE_WORDS;
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
    if (!over_time_store(entry, &driver->speeds, err)) {
        return false;
    }
    drive_take_largest(driver);
    bool is_constant = true;
    for (size_t i = 0; i < driver->speeds.count; i++) {
        is_constant = is_constant && driver->speeds.values[i] == driver->speed;
    }
    if (is_constant) {
        driver->speeds = (TimeTable){.count = 0};
    }
    return true;
}

// 1: of a period or of a turn, what rounding may leave
static const double PERIOD_ROUNDING = 1e-12;
static const double TURN_ROUNDING = 1e-9;

static bool over_time_check_turns(const Entry *entry, const TimeTable *speeds, Err *err)
{
    const double turns = (double)time_table_integral(speeds, speeds->period_s) / (2.0 * M_PI);
    const double whole = round(turns);
    if (fabs(turns - whole) <= TURN_ROUNDING) {
        return true;
    }
    if (whole == 0.0) {
        return entries_refuse(
            entry, err,
            "the drive turns by %.9g of a revolution in a period, and would start "
            "the next elsewhere\nallowed: whole turns in a period, or none",
            turns);
    }
    return entries_refuse(entry, err,
                          "the drive turns by %.9g revolutions in a period, and would start the "
                          "next elsewhere\nallowed: whole turns in a period, as with all speeds "
                          "times %.9g",
                          turns, whole / turns);
}

bool over_time_repeat(const Entries *entries, Driver *driver, Err *err)
{
    const Entry *entry = entries_find(entries, "drive.period", 0);
    TimeTable *speeds = &driver->speeds;
    if (entry == NULL) {
        return true;
    }
    if (!driver->is_present) {
        return entries_refuse(entry, err,
                              "only a speed over time repeats\nallowed: drive.period beside "
                              "drive.speed alone");
    }
    if (speeds->count == 0) {
        return true; // a constant speed has no use for it, which is said elsewhere
    }
    const size_t last = speeds->count - 1;
    const double end_s = speeds->times[last];
    const bool is_at_end = fabs(end_s - speeds->period_s) <= PERIOD_ROUNDING * speeds->period_s;
    if (is_at_end && speeds->times[0] == 0.0 && speeds->values[last] != speeds->values[0]) {
        return entries_refuse(entry, err,
                              "the speed at the end of a period is not that at its start\nallowed: "
                              "the same at both, or a period longer than %.6g s",
                              end_s);
    }
    if (!is_at_end && end_s > speeds->period_s) {
        return entries_refuse(entry, err,
                              "the points of drive.speed do not fit into a period\nallowed: a "
                              "period of at least %.6g s, the time of the last point",
                              end_s);
    }
    speeds->count -= is_at_end && speeds->times[0] == 0.0 ? 1 : 0;
    return over_time_check_turns(entry, speeds, err);
}
