// Writes and reads a record by the rows of its field table.
//
// A walk goes through the rows that are shown, into groups and parts too, and hands each field with
// the address of its value, NULL where it is not known, to the function that writes.
#include "write/fields.h"
#include "write/csv.h"
#include "write/json_value.h"
#include "write/units.h"

#include <assert.h>
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { HASH_DIGITS = 16 };

// A value by its field: where it stands, or what a function found.
typedef struct Value {
    const void *at;   // NULL: not known
    double number;    // of FIELD_NUMBER and its like
    const char *word; // of those that are words; NULL: not known
} Value;

static bool is_in_file(const Field *field, unsigned where)
{
    return (field->where & where) != 0 && field->type != FIELD_LABEL;
}

static bool is_number(const Field *field)
{
    return field->type >= FIELD_NUMBER && field->type <= FIELD_WHOLE;
}

static bool has_inner(const Field *field)
{
    return field->type >= FIELD_GROUP && field->type <= FIELD_PART;
}

static double file_number(const Field *field, double value)
{
    return field->type == FIELD_DEGREES   ? value * UNITS_DEG
           : field->type == FIELD_WRAPPED ? units_wrapped_deg(value)
                                          : value;
}

// The record of a group or part, or NULL.
static const void *inner_record(const Field *field, const void *record)
{
    if (record == NULL || field->type == FIELD_PART) {
        return record == NULL ? NULL : field->part(record);
    }
    const char *bytes = record;
    const bool is_known = field->type != FIELD_IF || *(const bool *)(bytes + field->known);
    return is_known ? bytes + field->offset : NULL;
}

static const char *fields_find_word(const Field *field, const void *record, const void *at)
{
    switch (field->type) {
    case FIELD_NAME:
        return field->word != NULL ? field->word(record) : *(const char *const *)at;
    case FIELD_CHOICE:
        return ((const char *const *)field->of)[*(const unsigned *)at];
    case FIELD_TEXT:
        return field->word != NULL ? field->word(record) : at;
    default:
        return NULL;
    }
}

static Value find_value(const Field *field, const void *record)
{
    if (record == NULL) {
        return (Value){.at = NULL, .number = NAN};
    }
    const void *at = (const char *)record + field->offset;
    Value value = {.at = at, .word = fields_find_word(field, record, at)};
    if (is_number(field)) {
        value.number = field->number != NULL ? field->number(record) : *(const double *)at;
    }
    return value;
}

static json_t *json_of(const Field *field, const void *record)
{
    const Value value = find_value(field, record);
    if (value.at == NULL) {
        return json_null();
    }
    switch (field->type) {
    case FIELD_COUNT:
        return json_integer((json_int_t)(*(const size_t *)value.at));
    case FIELD_FLAG:
        return json_boolean(*(const bool *)value.at);
    case FIELD_HASH:
        return json_sprintf("%016" PRIx64, *(const uint64_t *)value.at);
    case FIELD_VALUE:
        return field->json(record);
    case FIELD_NAME:
    case FIELD_TEXT:
    case FIELD_CHOICE:
        return value.word == NULL ? json_null() : json_value_text(value.word);
    case FIELD_WHOLE:
        return isfinite(value.number) ? json_integer((json_int_t)value.number) : json_null();
    default:
        assert(is_number(field));
        return json_value_real(file_number(field, value.number));
    }
}

void fields_json_set(const Field *fields, unsigned where, const void *record, json_t *object)
{
    for (const Field *field = fields; field->type != FIELD_END; field++) {
        if (!is_in_file(field, where)) {
            continue;
        }
        if (!has_inner(field)) {
            json_object_set_new(object, field->key, json_of(field, record));
            continue;
        }
        const void *inner = inner_record(field, record);
        if (field->key != NULL) {
            json_object_set_new(object, field->key,
                                inner == NULL ? json_null() : fields_json(field->of, where, inner));
        } else if (inner != NULL || field->has_nulls) {
            fields_json_set(field->of, where, inner, object);
        }
    }
}

json_t *fields_json(const Field *fields, unsigned where, const void *record)
{
    json_t *object = json_object();
    fields_json_set(fields, where, record, object);
    return object;
}

static bool fields_read_number(const Field *field, const json_t *json, double *value)
{
    const bool is_known = json_is_number(json);
    *value = is_known ? json_number_value(json) : NAN;
    return field->type == FIELD_STEP ? is_known && *value >= 0.0 : is_known || json_is_null(json);
}

static bool fields_read_hash(const json_t *json, uint64_t *value)
{
    const char *text = json_string_value(json);
    const bool is_hash = text != NULL && strlen(text) == HASH_DIGITS &&
                         strspn(text, "0123456789abcdef") == HASH_DIGITS;
    *value = is_hash ? strtoull(text, NULL, 16) : 0;
    return is_hash;
}

static bool fields_read_value(const Field *field, unsigned where, const json_t *json, void *value)
{
    switch (field->type) {
    case FIELD_COUNT:
        *(size_t *)value = (size_t)json_integer_value(json);
        return json_is_integer(json) && json_integer_value(json) >= 0;
    case FIELD_FLAG:
        *(bool *)value = json_is_true(json);
        return json_is_boolean(json);
    case FIELD_TEXT:
        snprintf(value, field->size, "%s", json_is_string(json) ? json_string_value(json) : "");
        return json_is_string(json);
    case FIELD_HASH:
        return fields_read_hash(json, value);
    case FIELD_GROUP:
        return fields_json_read(field->of, where, json, value);
    default:
        assert(field->type == FIELD_NUMBER || field->type == FIELD_STEP);
        return fields_read_number(field, json, value);
    }
}

bool fields_json_read(const Field *fields, unsigned where, const json_t *object, void *record)
{
    bool is_right = json_is_object(object);
    for (const Field *field = fields; is_right && field->type != FIELD_END; field++) {
        const json_t *json = field->key == NULL ? object : json_object_get(object, field->key);
        is_right = !is_in_file(field, where) ||
                   fields_read_value(field, where, json, (char *)record + field->offset);
    }
    return is_right;
}

static size_t csv_heads(const Field *fields, unsigned where, const char *prefix, size_t count,
                        FILE *stream)
{
    for (const Field *field = fields; field->type != FIELD_END; field++) {
        if (!is_in_file(field, where)) {
            continue;
        }
        if (has_inner(field)) {
            count = csv_heads(field->of, where, field->key == NULL ? prefix : field->key, count,
                              stream);
            continue;
        }
        fprintf(stream, "%s%s%s%s", count > 0 ? "," : "", prefix == NULL ? "" : prefix,
                prefix == NULL ? "" : "_", field->key);
        count++;
    }
    return count;
}

void fields_csv_head(const Field *fields, unsigned where, FILE *stream)
{
    csv_heads(fields, where, NULL, 0, stream);
    fputc('\n', stream);
}

static void csv_cell(const Field *field, const void *record, FILE *stream)
{
    const Value value = find_value(field, record);
    if (value.at == NULL) {
        return;
    }
    switch (field->type) {
    case FIELD_COUNT:
        fprintf(stream, "%zu", *(const size_t *)value.at);
        break;
    case FIELD_FLAG:
        fprintf(stream, "%d", *(const bool *)value.at);
        break;
    case FIELD_HASH:
        fprintf(stream, "%016" PRIx64, *(const uint64_t *)value.at);
        break;
    case FIELD_TEXT:
        if (value.word[0] != '\0') {
            csv_write_quoted(stream, value.word);
        }
        break;
    case FIELD_NAME:
    case FIELD_CHOICE:
        csv_write_word(stream, value.word == NULL ? "" : value.word);
        break;
    default:
        assert(is_number(field));
        csv_write_number(stream, file_number(field, value.number));
    }
}

static size_t csv_cells(const Field *fields, unsigned where, const void *record, size_t count,
                        FILE *stream)
{
    for (const Field *field = fields; field->type != FIELD_END; field++) {
        if (!is_in_file(field, where)) {
            continue;
        }
        if (has_inner(field)) {
            count = csv_cells(field->of, where, inner_record(field, record), count, stream);
            continue;
        }
        fputs(count > 0 ? "," : "", stream);
        csv_cell(field, record, stream);
        count++;
    }
    return count;
}

void fields_csv_row(const Field *fields, unsigned where, const void *record, FILE *stream)
{
    csv_cells(fields, where, record, 0, stream);
    fputc('\n', stream);
}

size_t fields_table_width(const Field *fields, unsigned where)
{
    size_t count = 0;
    for (const Field *field = fields; field->type != FIELD_END; field++) {
        const bool is_shown = (field->where & where) != 0;
        count += !is_shown ? 0 : has_inner(field) ? fields_table_width(field->of, where) : 1;
    }
    return count;
}

size_t fields_table_heads(const Field *fields, unsigned where, size_t column, Table *table)
{
    for (const Field *field = fields; field->type != FIELD_END; field++) {
        if ((field->where & where) == 0) {
            continue;
        }
        if (has_inner(field)) {
            column = fields_table_heads(field->of, where, column, table);
            continue;
        }
        const bool is_right = is_number(field) || field->type == FIELD_COUNT;
        table_head(table, column++, field->title, field->unit == NULL ? "" : field->unit,
                   field->align | (is_right ? TABLE_RIGHT : TABLE_LEFT));
    }
    return column;
}

Table *fields_table(const char *heading, const Field *fields, unsigned where, const Style *style,
                    Text *text)
{
    if (heading != NULL) {
        section_heading(heading, style, text);
        text_append(text, "\n");
    }
    Table *table = table_create(fields_table_width(fields, where));
    table_fit(table, style->width);
    fields_table_heads(fields, where, 0, table);
    return table;
}

static void absent_cell(const Field *field, Table *table)
{
    table_cell(table, "%s", field->absent == NULL ? "-" : field->absent);
}

static void number_cell(const Field *field, double value, Table *table)
{
    const double per_si = field->per_si != 0.0 ? field->per_si : units_per_si(field->unit);
    const double shown = field->type == FIELD_WRAPPED ? units_wrapped_deg(value) : value * per_si;
    if (!isfinite(shown)) {
        absent_cell(field, table);
    } else if (field->type == FIELD_WHOLE) {
        table_cell(table, "%.0f", shown);
    } else if (field->format == NULL) {
        section_number(table, shown);
    } else {
        section_finite(table, field->format, shown);
    }
}

static void fields_write_cell(const Field *field, const void *record, Table *table)
{
    const Value value = find_value(field, record);
    if (is_number(field)) {
        number_cell(field, value.number, table);
    } else if (field->type == FIELD_COUNT && value.at != NULL) {
        table_cell(table, "%zu", *(const size_t *)value.at);
    } else if (value.word != NULL) {
        table_cell(table, "%s", value.word);
    } else {
        absent_cell(field, table);
    }
}

void fields_table_row(const Field *fields, unsigned where, const void *record, Table *table)
{
    for (const Field *field = fields; field->type != FIELD_END; field++) {
        if ((field->where & where) != 0 && has_inner(field)) {
            fields_table_row(field->of, where, inner_record(field, record), table);
        } else if ((field->where & where) != 0 && field->type != FIELD_LABEL) {
            fields_write_cell(field, record, table);
        }
    }
}
