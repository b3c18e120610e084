// The values that JSON of this program is made of, and how they are written.
#pragma once

#include "base/text.h"

#include <jansson.h>
#include <math.h>
#include <stdio.h>

// Numbers have 17 significant digits; objects are indented, for people read them too.
enum { JSON_VALUE_FLAGS = JSON_REAL_PRECISION(17) | JSON_INDENT(2) };

// JSON knows no infinity and no NaN: they become null.
static inline json_t *json_value_real(double value)
{
    return isfinite(value) ? json_real(value) : json_null();
}

// Text that may not be UTF-8, such as a path: bytes that are none become escapes, \xff.
json_t *json_value_text(const char *text);

// Why a truth could not be certified, in words of its own; empty where it was.
json_t *json_value_not_certified(const char *message);

// Appends a value as JSON, by jansson's flags. What a terminal would obey or hide, see
// base/printable.h, stands there as \u202e, which a reader of the JSON decodes to what it was.
void json_value_write(const json_t *value, size_t flags, Text *text);

static inline void json_value_set(json_t *object, const char *key, double value)
{
    json_object_set_new(object, key, json_value_real(value));
}

// Keys of JSON of what turns: torques, angles and inertias where others have forces, lengths and
// masses.

// The key of what turns for one of what pushes, by the unit that it ends in: force_max_N_m for
// force_max_N. Keys without such a unit stay. The buffer is filled.
enum { TURNED_KEY_SIZE = 64 };
void turned_key(const char *key, char turned[TURNED_KEY_SIZE]);

// The same value with such keys in all its objects, in their order; a new reference, for the one
// given, which is taken.
json_t *torsional_keys(json_t *value);
