// Reads loads, and checks that they go with the rest of a case.
#include "casefile/loads.h"

#include "casefile/input.h"
#include "casefile/waves.h"
#include "model/loads.h"

#include <ctype.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { LINE_SIZE = 256, UNIT_SIZE = 32, WRONG_SIZE = 96, ALLOWED_SIZE = 256, PATH_SIZE = 1024 };

// 1: of where a load jumps, how far apart the two points are that a message proposes
static const double JUMP_SHARE = 1e-3;
// 1: of a period, what rounding may leave
static const double PERIOD_ROUNDING = 1e-9;

void loads_prepare(const Entries *entries, Linkage *linkage)
{
    const EntryNames *names = &entries->names[SCHEMA_LOAD_FAMILY];
    linkage->load_count = names->count;
    for (size_t i = 0; i < names->count; i++) {
        Load *load = &linkage->loads[i];
        text_copy(load->name, LINKAGE_NAME_SIZE, names->names[i]);
        const bool is_along = entries_find(entries, "loads.*.joint", i) != NULL;
        const bool is_torque = entries_find(entries, "loads.*.torque", i) != NULL;
        load->kind = is_along ? LOAD_ALONG : is_torque ? LOAD_TORQUE : LOAD_FORCE;
    }
}

Dimension loads_dimension(const Linkage *linkage, const Load *load)
{
    switch (load->over) {
    case LOAD_OVER_TIME:
        return DIMENSION_TIME;
    case LOAD_OVER_CRANK:
        return DIMENSION_ANGLE;
    case LOAD_OVER_POSITION:
        break;
    }
    const bool is_line = load->kind == LOAD_ALONG && forces_is_along_line(linkage, load->joint);
    return is_line ? DIMENSION_LENGTH : DIMENSION_ANGLE;
}

bool loads_apply(const SchemaRow *row, const Linkage *linkage, const Load *load)
{
    const bool is_force = load_is_force(linkage, load);
    switch (row->offset) {
    case offsetof(Load, joint):
        return load->kind == LOAD_ALONG;
    case offsetof(Load, body):
        return load->kind != LOAD_ALONG;
    case offsetof(Load, anchor):
    case offsetof(Load, direction):
    case offsetof(Load, frame):
        return load->kind == LOAD_FORCE;
    case offsetof(Load, area):
        return is_force;
    case offsetof(Load, over):
    case offsetof(Load, table.shape):
        return load->table.count > 1;
    case offsetof(Load, table.period):
        return load->table.count > 1 && load->table.period > 0.0;
    default:
        return (row->dimension == DIMENSION_FORCE) == is_force;
    }
}

// What the values of a load are written as: with an area those of a force are pressures on it.
static Dimension loads_value_dimension(const SchemaRow *row, const Load *load)
{
    return row->dimension == DIMENSION_FORCE && load->area != 0.0 ? DIMENSION_PRESSURE
                                                                  : row->dimension;
}

// What such a value is multiplied by.
static double value_scale(const SchemaRow *row, const Load *load)
{
    return loads_value_dimension(row, load) == DIMENSION_PRESSURE ? load->area : 1.0;
}

// What the points of a load look like, for messages.
static void describe_points(const Linkage *linkage, const Load *load, const SchemaRow *row,
                            char allowed[ALLOWED_SIZE])
{
    const Dimension over = loads_dimension(linkage, load);
    const char *from = over == DIMENSION_TIME ? "0 s" : over == DIMENSION_ANGLE ? "0 deg" : "0 mm";
    const char *to = over == DIMENSION_TIME ? "5 ms" : over == DIMENSION_ANGLE ? "90 deg" : "20 mm";
    snprintf(allowed, ALLOWED_SIZE,
             "%s, points in order such as [[%s, 0 %s], [%s, %s]], or a file such as load.csv",
             units_example(row->dimension), from, units_si(row->dimension), to,
             units_example(row->dimension));
}

// The value of a point, within the range of its row.
static bool read_point_value(const Target *target, const Node *node, const Load *load,
                             double *value)
{
    const SchemaRow *row = target->entry->row;
    if (!target_quantity(target, node, loads_value_dimension(row, load), value)) {
        return false;
    }
    *value *= value_scale(row, load);
    char allowed[ALLOWED_SIZE];
    snprintf(allowed, sizeof allowed, "%g to %g %s", row->low, row->high, units_si(row->dimension));
    return fabs(*value) <= row->high ||
           source_error(target->entry->source, node->span, allowed, target->err,
                        "%s is out of range: %.60s", target->path, node->text);
}

// Whether a point does not go behind those that are there: why, and what would be allowed.
static bool is_misplaced(const Linkage *linkage, const Load *load, double at,
                         char wrong[WRONG_SIZE], char allowed[ALLOWED_SIZE])
{
    const LoadTable *table = &load->table;
    const double before = table->count > 0 ? table->at[table->count - 1] : -INFINITY;
    if (table->count == LOAD_TABLE_MAX) {
        snprintf(wrong, WRONG_SIZE, "is one too many");
        snprintf(allowed, ALLOWED_SIZE, "at most %d points", LOAD_TABLE_MAX);
        return true;
    }
    const Dimension over = loads_dimension(linkage, load);
    const bool is_angle = over == DIMENSION_ANGLE;
    const double scale = is_angle ? 180.0 / M_PI : 1.0;
    const char *unit = is_angle ? "deg" : units_si(over);
    snprintf(wrong, WRONG_SIZE, "is not in order: %.10g %s after %.10g %s", scale * at, unit,
             scale * before, unit);
    snprintf(allowed, ALLOWED_SIZE,
             at == before
                 ? "each point behind the one before; a jump is two points close together, "
                   "such as %.10g %s and %.10g %s, or interpolation: steps"
                 : "each point behind the one before",
             scale * at, unit, scale * (at + JUMP_SHARE * (at != 0.0 ? fabs(at) : 1.0)), unit);
    return !(at > before);
}

static void add_point(LoadTable *table, double at, double value)
{
    table->at[table->count] = at;
    table->values[table->count++] = value;
}

static bool read_points(const Target *target, const Linkage *linkage, Load *load)
{
    const SchemaRow *row = target->entry->row;
    LoadTable *table = &load->table;
    char allowed[ALLOWED_SIZE];
    describe_points(linkage, load, row, allowed);
    for (const Node *point = target->entry->node->first; point != NULL; point = point->next) {
        const Node *pair[2];
        double numbers[2];
        if (!target_pair(point, pair)) {
            return source_error(target->entry->source, point->span, allowed, target->err,
                                "a point of %s is two numbers", target->path);
        }
        if (!target_quantity(target, pair[0], loads_dimension(linkage, load), &numbers[0]) ||
            !read_point_value(target, pair[1], load, &numbers[1])) {
            return false;
        }
        char wrong[WRONG_SIZE];
        if (is_misplaced(linkage, load, numbers[0], wrong, allowed)) {
            return source_error(target->entry->source, pair[0]->span, allowed, target->err,
                                "this point of %s %s", target->path, wrong);
        }
        add_point(table, numbers[0], numbers[1]);
    }
    return table->count > 0 || source_error(target->entry->source, target->entry->node->span,
                                            allowed, target->err, "%s has no point", target->path);
}

// The text of a CSV file, which is looked for beside the case.
typedef struct Csv {
    char path[PATH_SIZE];
    size_t line;
    char units[2][UNIT_SIZE];
} Csv;

static void find_beside(const Source *source, const char *name, char path[PATH_SIZE])
{
    const char *slash = source->is_option ? NULL : strrchr(source->name, '/');
    const int folder = slash == NULL || name[0] == '/' ? 0 : (int)(slash + 1 - source->name);
    snprintf(path, PATH_SIZE, "%.*s%s", folder, source->name, name);
}

// The unit in brackets of a column's head; false where there is none.
static bool read_unit(const char *head, char unit[UNIT_SIZE])
{
    const char *open = strpbrk(head, "[(");
    const size_t length = open == NULL ? 0 : strcspn(open + 1, "])");
    if (open == NULL || length == 0 || length >= UNIT_SIZE) {
        return false;
    }
    snprintf(unit, UNIT_SIZE, "%.*s", (int)length, open + 1);
    return true;
}

// A mistake on a line of the file; what would be allowed stands in lines of its own.
static bool refuse_line(const Target *target, const Csv *csv, const char *allowed,
                        const char *format, ...) __attribute__((format(printf, 4, 5)));
static bool refuse_line(const Target *target, const Csv *csv, const char *allowed,
                        const char *format, ...)
{
    char words[2 * LINE_SIZE];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(words, sizeof words, format, arguments);
    va_end(arguments);
    return allowed[0] == '\0'
               ? err_set(target->err, ERR_CASE, "%s:%zu: %s", csv->path, csv->line, words)
               : err_set(target->err, ERR_CASE, "%s:%zu: %s\nallowed: %s", csv->path, csv->line,
                         words, allowed);
}

static char *skip_blanks(char *text)
{
    return text + strspn(text, " \t\r");
}

// Takes a cell off the line, in quotes or without: its text in place, and what stands behind the
// comma; NULL where there is none. False where something stands behind the quote.
static bool take_cell(char *line, char **cell, char **rest)
{
    char *end;
    *cell = skip_blanks(line);
    if (**cell != '"') {
        end = *cell + strcspn(*cell, ",;");
    } else {
        char *target = ++*cell;
        // a quote within is written twice
        for (end = target; *end != '\0' && (*end != '"' || end[1] == '"'); end++) {
            end += *end == '"' ? 1 : 0;
            *target++ = *end;
        }
        const bool is_closed = *end == '"';
        end = is_closed ? skip_blanks(end + 1) : end;
        *target = '\0';
        if (!is_closed || strchr(",;", *end) == NULL) {
            return false;
        }
    }
    *rest = *end == '\0' ? NULL : end + 1;
    *end = '\0';
    return true;
}

// The two cells of a line.
static bool take_cells(char *line, char *cells[2])
{
    char *rest = NULL;
    char *nothing = NULL;
    // a third cell is left in the second, where it is no number
    return take_cell(line, &cells[0], &rest) && rest != NULL &&
           (*skip_blanks(rest) != '"' ? (cells[1] = rest) != NULL
                                      : take_cell(rest, &cells[1], &nothing) && nothing == NULL);
}

static bool read_head(const Target *target, char *line, const Load *load, Csv *csv)
{
    char *cells[2];
    if (!take_cells(line, cells) || !read_unit(cells[0], csv->units[0]) ||
        !read_unit(cells[1], csv->units[1])) {
        return refuse_line(target, csv, "crank angle [deg], force [kN]",
                           "expected the heads of two columns with their units");
    }
    char name[UNITS_NAME_SIZE];
    units_normalise(csv->units[1], name);
    const Dimension wanted = loads_value_dimension(target->entry->row, load);
    const Unit *unit = units_find(wanted, name);
    if (wanted == DIMENSION_FORCE && unit != NULL && unit->dimension == DIMENSION_PRESSURE) {
        return refuse_line(target, csv, "area: 12.6 cm^2 beside force, or a column of a force",
                           "[%s] is a pressure, and the load has no area that it acts on",
                           csv->units[1]);
    }
    return true;
}

// One number of a line, in the unit of its column.
static bool read_cell(const Target *target, const Csv *csv, const char *cell, size_t column,
                      Dimension dimension, double *number)
{
    char text[LINE_SIZE + UNIT_SIZE];
    Complaint complaint;
    while (isspace((unsigned char)*cell)) {
        cell++;
    }
    int length = (int)strlen(cell);
    while (length > 0 && isspace((unsigned char)cell[length - 1])) {
        length--;
    }
    snprintf(text, sizeof text, "%.*s %s", length, cell, csv->units[column]);
    return quantity_parse(text, dimension, number, &complaint) ||
           refuse_line(target, csv, complaint.allowed, "%s", complaint.text);
}

static bool read_line(const Target *target, const Linkage *linkage, char *line, Csv *csv,
                      Load *load)
{
    const SchemaRow *row = target->entry->row;
    char *cells[2];
    double numbers[2];
    if (csv->units[0][0] == '\0') {
        return read_head(target, line, load, csv);
    }
    if (!take_cells(line, cells)) {
        return refuse_line(target, csv, "", "expected two numbers with a comma between");
    }
    if (!read_cell(target, csv, cells[0], 0, loads_dimension(linkage, load), &numbers[0]) ||
        !read_cell(target, csv, cells[1], 1, loads_value_dimension(row, load), &numbers[1])) {
        return false;
    }
    numbers[1] *= value_scale(row, load);
    char wrong[WRONG_SIZE];
    char allowed[ALLOWED_SIZE];
    if (!(fabs(numbers[1]) <= row->high)) {
        snprintf(allowed, sizeof allowed, "%g to %g %s", row->low, row->high,
                 units_si(row->dimension));
        return refuse_line(target, csv, allowed, "this point is out of range");
    }
    if (is_misplaced(linkage, load, numbers[0], wrong, allowed)) {
        return refuse_line(target, csv, allowed, "this point %s", wrong);
    }
    add_point(&load->table, numbers[0], numbers[1]);
    return true;
}

// The text of the file, to be freed by the caller; NULL where it cannot be read or is no text.
static char *read_text(const Target *target, const Csv *csv)
{
    char *text = NULL;
    size_t size = 0;
    Err own = {ERR_NONE, ""};
    if (!input_read("load", csv->path, &text, &size, &own)) {
        // its first line: what would be allowed is said here
        source_error(target->entry->source, target->entry->node->span,
                     "a CSV file beside the case, or points", target->err, "%.*s",
                     (int)strcspn(own.text, "\n"), own.text);
        return NULL;
    }
    const size_t good = source_text_length(text, size);
    if (good < size) {
        err_set(target->err, ERR_CASE,
                "%s: byte %zu (0x%02x) is not text: the file is binary, damaged or not in UTF-8",
                csv->path, good, (unsigned)(unsigned char)text[good]);
        free(text);
        return NULL;
    }
    return text;
}

static bool read_file(const Target *target, const Linkage *linkage, Load *load)
{
    Csv csv = {.line = 0};
    find_beside(target->entry->source, target->entry->node->text, csv.path);
    char *text = read_text(target, &csv);
    if (text == NULL) {
        return false;
    }
    bool is_good = true;
    // a byte order mark is no part of the text
    char *next = strncmp(text, "\xef\xbb\xbf", 3) == 0 ? text + 3 : text;
    while (is_good && next != NULL && *next != '\0') {
        char *end = strchr(next, '\n');
        char line[LINE_SIZE];
        const int length = snprintf(line, sizeof line, "%.*s",
                                    (int)(end != NULL ? end - next : (long)strlen(next)), next);
        csv.line++;
        const bool is_empty = line[strspn(line, " \t\r")] == '\0' || line[0] == '#';
        is_good = is_empty ||
                  (length < LINE_SIZE || refuse_line(target, &csv, "", "the line is too long"));
        is_good = is_good && (is_empty || read_line(target, linkage, line, &csv, load));
        next = end != NULL ? end + 1 : NULL;
    }
    free(text);
    return is_good && (load->table.count > 0 || err_set(target->err, ERR_CASE,
                                                        "%s has no point\nallowed: a line of heads "
                                                        "with units, and a line for each point",
                                                        csv.path));
}

static bool is_file(const Node *node)
{
    const size_t length = node->kind == NODE_SCALAR ? strlen(node->text) : 0;
    return length > 4 && strcmp(node->text + length - 4, ".csv") == 0;
}

static bool read_wave(const Target *target, Load *load)
{
    const SchemaRow *row = target->entry->row;
    WaveRead read;
    if (!waves_read(target->entries, target->entry, loads_value_dimension(row, load),
                    value_scale(row, load), &read, target->err)) {
        return false;
    }
    add_point(&load->table, 0.0, read.mean);
    load->table.wave = read.wave;
    return true;
}

bool loads_store_value(const Target *target, const Linkage *linkage, Load *load)
{
    const Node *node = target->entry->node;
    load->table.count = 0;
    load->table.wave = (Wave){.rate = 0.0};
    if (waves_is_one(target->entry)) {
        return read_wave(target, load);
    }
    if (node->kind == NODE_LIST) {
        return read_points(target, linkage, load);
    }
    if (is_file(node)) {
        return read_file(target, linkage, load);
    }
    double value;
    if (!read_point_value(target, node, load, &value)) {
        return false;
    }
    add_point(&load->table, 0.0, value);
    return true;
}

bool loads_store_period(const Target *target, const Linkage *linkage, Load *load)
{
    const Node *node = target->entry->node;
    double period = 0.0;
    if (node->kind == NODE_SCALAR && strcmp(node->text, "none") == 0) {
        load->table.period = -1.0; // not even that of a turn
        return true;
    }
    if (!target_quantity(target, node, loads_dimension(linkage, load), &period)) {
        return false;
    }
    load->table.period = period;
    return period > 0.0 ||
           source_error(target->entry->source, node->span, "above 0, or none", target->err,
                        "%s is out of range: %.60s", target->path, node->text);
}

// Refuses a load where one of the keys stands that are given, with what would be allowed.
static bool refuse(const Entries *entries, const char *paths, size_t number, Err *err,
                   const char *words, const char *allowed)
{
    const Entry *entry = entries_blame(entries, paths, number);
    const EntryGroup *group = entries_group(entries, "loads.*", number);
    return entry != NULL ? entries_refuse(entry, err, "%s\nallowed: %s", words, allowed)
                         : entries_refuse_group(group, err, "%s\nallowed: %s", words, allowed);
}

#define WHERE "loads.*.joint loads.*.body"
#define WHAT  "loads.*.force loads.*.torque"

// What a load acts on, and what it is.
static bool check_load_kind(const Entries *entries, const Linkage *linkage, size_t i, Err *err)
{
    const Load *load = &linkage->loads[i];
    const bool has_joint = entries_find(entries, "loads.*.joint", i) != NULL;
    const bool has_body = entries_find(entries, "loads.*.body", i) != NULL;
    const bool has_force = entries_find(entries, "loads.*.force", i) != NULL;
    const bool has_torque = entries_find(entries, "loads.*.torque", i) != NULL;
    if (has_joint == has_body) {
        return refuse(entries, WHERE, i, err, "a load acts on a body or along a joint",
                      "either joint or body");
    }
    if (has_force == has_torque) {
        return refuse(entries, WHAT, i, err, "a load is a force or a torque",
                      "either force or torque");
    }
    if (!has_joint) {
        return load->over != LOAD_OVER_POSITION ||
               refuse(entries, "loads.*.over", i, err,
                      "a load on a body has no position of a joint",
                      "over: time or crank-angle, or a load along a joint");
    }
    const JointKind kind = linkage->joints[load->joint].kind;
    if (!joint_holds(kind)) {
        return refuse(entries, "loads.*.joint", i, err,
                      "a stop or a pair of gears has no coordinate to push along",
                      "a pivot, a pin, a slider or guides");
    }
    return has_force == forces_is_along_line(linkage, load->joint) ||
           refuse(entries, WHAT, i, err,
                  has_force ? "a force acts along a slider's line, and this joint turns"
                            : "a torque acts at a pivot, and this joint slides",
                  has_force ? "torque here, or a force on a body"
                            : "force here, or a torque on a body");
}

// Points beside what they are over, and whether it is there.
static bool check_points(const Entries *entries, const Linkage *linkage, size_t i, Err *err)
{
    const Load *load = &linkage->loads[i];
    const bool has_crank = linkage->driver.is_present || linkage->torque.table.count > 0;
    const bool is_steady = drive_is_steady(&linkage->driver);
    if (wave_exists(&load->table.wave) && load->over != LOAD_OVER_TIME) {
        return refuse(entries, "loads.*.over", i, err, "a sinusoid is over time",
                      "over: time, or points over the crank's angle or a position");
    }
    if (load->table.count > 1 && load->over == LOAD_OVER_CRANK && !has_crank) {
        return refuse(entries, "loads.*.over", i, err,
                      "nothing drives this mechanism: it has no crank",
                      "over: time or position, or a drive");
    }
    const bool is_known =
        load->over == LOAD_OVER_TIME || (load->over == LOAD_OVER_CRANK && is_steady);
    return load->table.count <= 1 || load->table.shape != LOAD_STEPS || is_known ||
           refuse(entries, "loads.*.interpolation", i, err,
                  "steps are for loads over time, or over the angle of a crank of constant speed",
                  "linear, smooth");
}

// A last point that is the first of the next period is left out.
static bool fold_period(const Entries *entries, size_t i, Load *load, Err *err)
{
    LoadTable *table = &load->table;
    table->period = table->period == 0.0 && load->over == LOAD_OVER_CRANK && table->count > 1
                        ? 2.0 * M_PI
                        : fmax(table->period, 0.0);
    if (table->count < 2 || table->period == 0.0) {
        return true;
    }
    const size_t last = table->count - 1;
    const double span = table->at[last] - table->at[0];
    if (fabs(span - table->period) <= PERIOD_ROUNDING * table->period) {
        table->count -= table->shape == LOAD_STEPS || table->values[last] == table->values[0];
    }
    return table->at[table->count - 1] - table->at[0] < table->period * (1.0 - PERIOD_ROUNDING) ||
           refuse(
               entries, "loads.*.period " WHAT, i, err,
               "the points of the load do not fit into its period, or it does not end as it begins",
               "points within one period (over a crank's angle one turn by itself), the same value "
               "at both ends, or period: none");
}

bool loads_complete(const Entries *entries, Linkage *linkage, Err *err)
{
    for (size_t i = 0; i < linkage->load_count; i++) {
        Load *load = &linkage->loads[i];
        if (!check_load_kind(entries, linkage, i, err) || !check_points(entries, linkage, i, err) ||
            !fold_period(entries, i, load, err)) {
            return false;
        }
        load_table_settle(&load->table);
    }
    return true;
}
