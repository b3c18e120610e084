// A limit in words: "below 1.2 kN", "within 2 % of 950 N".
#pragma once

#include "casefile/quantity.h"
#include "model/expectation.h"

enum { EXPECT_NAME_SIZE = 64 };

// A number that can be limited.
typedef struct ExpectRow {
    char name[EXPECT_NAME_SIZE]; // the last word of its path
    Dimension dimension;
    bool is_count;   // a whole number
    bool needs_play; // of a joint
} ExpectRow;

// The ways to write a limit, in one line.
extern const char EXPECT_FORMS[];

// Reads a limit of a number into low, high, is_open, words, unit and unit_si. On failure the
// complaint says why, and *start and *length which bytes of the text are wrong.
bool expect_limit_read(const char *text, const ExpectRow *row, Expectation *expectation,
                       Complaint *complaint, size_t *start, size_t *length);
