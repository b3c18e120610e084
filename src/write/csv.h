// Words and numbers in a table for spreadsheets.
#pragma once

#include <stdio.h>

// Quoted, so that commas and quotes stay in their cell; a line's end becomes a space.
void csv_write_quoted(FILE *stream, const char *text);

// Quoted only where it must be.
void csv_write_word(FILE *stream, const char *text);

// With 17 digits, which read back as the very same number. One that does not exist, an infinity or
// NaN, leaves its cell empty: JSON has null there.
void csv_write_number(FILE *stream, double value);
