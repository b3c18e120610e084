// Field tables made of the rows of model/number_list.h.
#pragma once

#include "measure/number_values.h"
#include "write/fields.h"

// The numbers of one member that are shown; all others are NAN.
typedef struct NumberRecord {
    Extreme values[NUMBER_COUNT];
} NumberRecord;

NumberRecord number_record(NumberOwner owner, const NumberSource *of, size_t member);

// Fields of a NumberRecord. Not to be copied.
enum { NUMBER_FIELD_MAX = NUMBER_COUNT + 24 };

typedef struct NumberFields {
    size_t count;
    Field rows[NUMBER_FIELD_MAX];
} NumberFields;

// Adds a column that the caller fills.
void number_fields_label(NumberFields *fields, const char *title, const char *unit,
                         TableAlign align);

// Adds the numbers of an owner that are shown in JSON and tables, but those with any of some
// traits; beside what has a time the crank's angle there, or in tables, where `has_crank` is
// false, that time.
void number_fields_add(NumberFields *fields, NumberOwner owner, NumberTurn turn, unsigned without,
                       bool has_crank);

// The traits of numbers that a linkage has none of.
unsigned number_fields_lacked(const Linkage *linkage);

// Adds the numbers of a member to an object.
void number_fields_json(json_t *object, NumberOwner owner, const NumberSource *of,
                        const Linkage *linkage, size_t member);
