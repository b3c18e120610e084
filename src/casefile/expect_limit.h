// A limit in words: "below 1.2 kN", "within 2 % of 950 N".
#pragma once

#include "casefile/expect.h"
#include "casefile/quantity.h"

// Reads a limit of a number into low, high, is_open, words, unit and unit_si. On failure the
// complaint says why, and *start and *length which bytes of the text are wrong.
bool expect_limit_read(const char *text, const ExpectRow *row, Expectation *expectation,
                       Complaint *complaint, size_t *start, size_t *length);
