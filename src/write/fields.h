// The field table: one row for each number of a result, with its name, unit, type, format, where in
// the record it stands and where it is shown. The keys of JSON, the columns of CSV, the lines of a
// store and the columns of tables for people all come from these rows.
#pragma once

#include "base/err.h"
#include "write/table.h"

#include <jansson.h>
#include <stddef.h>
#include <stdio.h>

// What is not known is null in JSON, an empty cell of CSV and a dash in a table.
typedef enum FieldType {
    FIELD_END,     // behind the last row
    FIELD_NUMBER,  // double; not known where it is not finite
    FIELD_STEP,    // double, s; a store holds none that is negative or not known
    FIELD_DEGREES, // double, rad; files have degrees too
    FIELD_WRAPPED, // the same from 0 to 360 degrees
    FIELD_WHOLE,   // double, a whole number; not known where it is not finite
    FIELD_COUNT,   // size_t
    FIELD_FLAG,    // bool
    FIELD_NAME,    // const char *; NULL: not known
    FIELD_TEXT,    // char[size], a sentence: quoted in CSV
    FIELD_CHOICE,  // enum, by the words of `of`
    FIELD_HASH,    // uint64_t, 16 hexadecimal digits
    FIELD_GROUP,   // a struct with the fields `of`
    FIELD_IF,      // the same, where the bool at `known` says that it is known
    FIELD_PART, // the same, of a record that `part` finds; NULL: it is not known. What is not known
                // has none of its keys in JSON, or null under its own
    FIELD_VALUE, // what `json` makes. Of JSON alone
    FIELD_LABEL, // of tables alone: a cell that the caller fills, before or behind the row
} FieldType;

// Where a field is shown: any of these bits, and bits of a caller's own from FIELD_OWN on.
enum {
    FIELD_JSON = 1,
    FIELD_CSV = 2,
    FIELD_STORE = 4,
    FIELD_TABLE = 8,
    FIELD_OWN = 16,
    FIELD_FILES = FIELD_JSON | FIELD_CSV,
    FIELD_ALL = FIELD_FILES | FIELD_TABLE,
};

typedef struct Field {
    // The key in files, with the unit in SI behind it. The fields of a group with a key are an
    // object in JSON, and have the key in front of their columns in CSV; those of a group without
    // one stand among the others.
    const char *key;
    FieldType type;
    unsigned where;
    const char *title;  // of the column for people
    const char *unit;   // likewise; it says what SI is multiplied by (units_per_si)
    const char *format; // for people; NULL: section_number, or the plain count
    size_t offset;      // in the record
    double per_si;      // where the unit says nothing of it
    TableAlign align;   // beyond TABLE_RIGHT for numbers: TABLE_MINOR, TABLE_DETAIL, TABLE_KEY
    const char *absent; // for people, in place of what is not known; NULL: a dash
    const void *of;     // the fields of a group or part, or the words of a choice
    size_t size;        // of FIELD_TEXT, where it is read
    size_t known;       // of FIELD_IF: where in the record
    bool has_nulls;     // of FIELD_PART without a key: where it is not known its keys are null
    // how a value is found that does not stand in the record as it is; then the offset is not used
    union {
        double (*number)(const void *record);    // of FIELD_NUMBER and its like
        const char *(*word)(const void *record); // of FIELD_NAME and FIELD_TEXT
        const void *(*part)(const void *record); // of FIELD_PART
        json_t *(*json)(const void *record);     // of FIELD_VALUE: a new reference
    };
} Field;

// Adds the fields that are shown in any place of `where` to an object, or makes one: a new
// reference.
void fields_json_set(const Field *fields, unsigned where, const void *record, json_t *object);
json_t *fields_json(const Field *fields, unsigned where, const void *record);

// Reads them back into a record. False where a key is missing or its value has another type; the
// record may then be filled in part. Names, choices and parts cannot be read.
bool fields_json_read(const Field *fields, unsigned where, const json_t *object, void *record);

// Writes the heads of the columns, or the cells of a record, with the end of the line.
void fields_csv_head(const Field *fields, unsigned where, FILE *stream);
void fields_csv_row(const Field *fields, unsigned where, const void *record, FILE *stream);

// Writes records that stand `size` bytes apart to a file, a row each under one head, whole or not
// at all. ERR_FILE.
bool fields_csv_write(const Field *fields, unsigned where, const void *records, size_t count,
                      size_t size, const char *path, Err *err);

// Begins a section with a table of these columns, to be ended by section_end; without a heading
// where that is NULL.
Table *fields_table(const char *heading, const Field *fields, unsigned where, const Style *style,
                    Text *text);

// The same columns in a table of the caller's: how many there are, and their heads from a column
// on; returns the next column.
size_t fields_table_width(const Field *fields, unsigned where);
size_t fields_table_heads(const Field *fields, unsigned where, size_t column, Table *table);

// Fills one row of it.
void fields_table_row(const Field *fields, unsigned where, const void *record, Table *table);
