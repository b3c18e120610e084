// Rows of numbers in a line of a driver's answer.
#pragma once

#include "base/err.h"

#include <jansson.h>
#include <stdbool.h>
#include <stddef.h>

// Where a row stands, such as the "bodies[1]" of a line "sample", and what it has to have: so many
// numbers, of which the first ones, `known`, must be there and others may be null.
typedef struct EngineRow {
    const char *line;
    const char *field;
    size_t index;
    size_t known;
    size_t count;
} EngineRow;

// Reads a row; null becomes NAN. Fails with ERR_SOLVER, which says where, for any other row, and
// for a number above 1e15.
bool engine_row_read(const json_t *row, const EngineRow *as, double *numbers, Err *err);

// Whether a field has so many rows; ERR_SOLVER where not.
bool engine_row_count(const json_t *rows, const EngineRow *as, size_t count, Err *err);
