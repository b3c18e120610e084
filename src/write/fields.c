// How is a record written and read by the rows of its field table?
//
// A walk goes through the rows that are shown, into groups and parts too, and hands each field with
// the address of its value, NULL where it is not known, to whoever writes.
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

static const void *value_at(const Field *field, const void *record)
{
    return record == NULL ? NULL : (const char *)record + field->offset;
}

static bool is_number(const Field *field)
{
    return field->type >= FIELD_NUMBER && field->type <= FIELD_WRAPPED;
}

// The record of a group or part.
static const void *inner_record(const Field *field, const void *value)
{
    return field->type == FIELD_PART && value != NULL ? *(const void *const *)value : value;
}

static bool has_inner(const Field *field)
{
    return field->type == FIELD_GROUP || field->type == FIELD_PART;
}

static double file_number(const Field *field, double value)
{
    return field->type == FIELD_DEGREES   ? value * UNITS_DEG
           : field->type == FIELD_WRAPPED ? units_wrapped_deg(value)
                                          : value;
}

static const char *word_of(const Field *field, const void *value)
{
    switch (field->type) {
    case FIELD_NAME:
        return *(const char *const *)value;
    case FIELD_CHOICE:
        return ((const char *const *)field->of)[*(const unsigned *)value];
    default:
        return value;
    }
}

static json_t *json_of(const Field *field, const void *value)
{
    if (value == NULL) {
        return json_null();
    }
    switch (field->type) {
    case FIELD_COUNT:
        return json_integer((json_int_t)(*(const size_t *)value));
    case FIELD_FLAG:
        return json_boolean(*(const bool *)value);
    case FIELD_HASH:
        return json_sprintf("%016" PRIx64, *(const uint64_t *)value);
    case FIELD_NAME:
    case FIELD_TEXT:
    case FIELD_CHOICE:
        return word_of(field, value) == NULL ? json_null() : json_value_text(word_of(field, value));
    default:
        assert(is_number(field));
        return json_value_real(file_number(field, *(const double *)value));
    }
}

void fields_json_set(const Field *fields, unsigned where, const void *record, json_t *object)
{
    for (const Field *field = fields; field->type != FIELD_END; field++) {
        const void *value = value_at(field, record);
        const void *inner = inner_record(field, value);
        if ((field->where & where) == 0) {
            continue;
        }
        if (field->type == FIELD_VALUE) {
            json_t *made = *(json_t *const *)value;
            if (made != NULL) {
                json_object_set_new(object, field->key, made);
            }
        } else if (!has_inner(field)) {
            json_object_set_new(object, field->key, json_of(field, value));
        } else if (field->key != NULL) {
            json_object_set_new(object, field->key,
                                inner == NULL ? json_null() : fields_json(field->of, where, inner));
        } else if (inner != NULL) {
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

static bool read_number(const Field *field, const json_t *json, double *value)
{
    const bool is_known = json_is_number(json);
    *value = is_known ? json_number_value(json) : NAN;
    return field->type == FIELD_STEP ? is_known && *value >= 0.0 : is_known || json_is_null(json);
}

static bool read_hash(const json_t *json, uint64_t *value)
{
    const char *text = json_string_value(json);
    const bool is_hash = text != NULL && strlen(text) == HASH_DIGITS &&
                         strspn(text, "0123456789abcdef") == HASH_DIGITS;
    *value = is_hash ? strtoull(text, NULL, 16) : 0;
    return is_hash;
}

static bool read_value(const Field *field, unsigned where, const json_t *json, void *value)
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
        return read_hash(json, value);
    case FIELD_GROUP:
        return fields_json_read(field->of, where, json, value);
    default:
        assert(field->type == FIELD_NUMBER || field->type == FIELD_STEP);
        return read_number(field, json, value);
    }
}

bool fields_json_read(const Field *fields, unsigned where, const json_t *object, void *record)
{
    bool is_right = json_is_object(object);
    for (const Field *field = fields; is_right && field->type != FIELD_END; field++) {
        const json_t *json = field->key == NULL ? object : json_object_get(object, field->key);
        is_right = (field->where & where) == 0 ||
                   read_value(field, where, json, (char *)record + field->offset);
    }
    return is_right;
}

static size_t csv_heads(const Field *fields, unsigned where, const char *prefix, size_t count,
                        FILE *stream)
{
    for (const Field *field = fields; field->type != FIELD_END; field++) {
        if ((field->where & where) == 0) {
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

static void csv_cell(const Field *field, const void *value, FILE *stream)
{
    switch (field->type) {
    case FIELD_COUNT:
        fprintf(stream, "%zu", *(const size_t *)value);
        break;
    case FIELD_FLAG:
        fprintf(stream, "%d", *(const bool *)value);
        break;
    case FIELD_HASH:
        fprintf(stream, "%016" PRIx64, *(const uint64_t *)value);
        break;
    case FIELD_TEXT:
        if (word_of(field, value)[0] != '\0') {
            csv_write_quoted(stream, word_of(field, value));
        }
        break;
    case FIELD_NAME:
    case FIELD_CHOICE:
        csv_write_word(stream, word_of(field, value) == NULL ? "" : word_of(field, value));
        break;
    default:
        assert(is_number(field));
        csv_write_number(stream, file_number(field, *(const double *)value));
    }
}

static size_t csv_cells(const Field *fields, unsigned where, const void *record, size_t count,
                        FILE *stream)
{
    for (const Field *field = fields; field->type != FIELD_END; field++) {
        const void *value = value_at(field, record);
        if ((field->where & where) == 0) {
            continue;
        }
        if (has_inner(field)) {
            count = csv_cells(field->of, where, inner_record(field, value), count, stream);
            continue;
        }
        fputs(count > 0 ? "," : "", stream);
        if (value != NULL) {
            csv_cell(field, value, stream);
        }
        count++;
    }
    return count;
}

void fields_csv_row(const Field *fields, unsigned where, const void *record, FILE *stream)
{
    csv_cells(fields, where, record, 0, stream);
    fputc('\n', stream);
}

static size_t count_columns(const Field *fields, unsigned where)
{
    size_t count = 0;
    for (const Field *field = fields; field->type != FIELD_END; field++) {
        const bool is_shown = (field->where & where) != 0;
        count += !is_shown ? 0 : has_inner(field) ? count_columns(field->of, where) : 1;
    }
    return count;
}

static size_t table_heads(const Field *fields, unsigned where, size_t column, Table *table)
{
    for (const Field *field = fields; field->type != FIELD_END; field++) {
        if ((field->where & where) == 0) {
            continue;
        }
        if (has_inner(field)) {
            column = table_heads(field->of, where, column, table);
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
    Table *table = table_create(count_columns(fields, where));
    table_fit(table, style->width);
    table_heads(fields, where, 0, table);
    return table;
}

static void number_cell(const Field *field, double value, Table *table)
{
    const double shown = field->type == FIELD_WRAPPED
                             ? units_wrapped_deg(value)
                             : value * units_per_si(field->unit == NULL ? "" : field->unit);
    if (field->format == NULL) {
        section_number_or_dash(table, isfinite(shown), shown);
    } else {
        section_finite(table, field->format, shown);
    }
}

static void table_cell_of(const Field *field, const void *value, Table *table)
{
    if (value == NULL) {
        table_cell(table, "-");
    } else if (is_number(field)) {
        number_cell(field, *(const double *)value, table);
    } else if (field->type == FIELD_COUNT) {
        table_cell(table, "%zu", *(const size_t *)value);
    } else {
        const char *word = word_of(field, value);
        table_cell(table, "%s", word == NULL ? "-" : word);
    }
}

void fields_table_row(const Field *fields, unsigned where, const void *record, Table *table)
{
    for (const Field *field = fields; field->type != FIELD_END; field++) {
        const void *value = value_at(field, record);
        if ((field->where & where) != 0 && has_inner(field)) {
            fields_table_row(field->of, where, inner_record(field, value), table);
        } else if ((field->where & where) != 0) {
            table_cell_of(field, value, table);
        }
    }
}
