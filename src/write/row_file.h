// A table of numbers and words as CSV: the names of the columns, then a line a row.
//
// Every number reads back as the very same double, a zero with its sign. One that does not exist,
// an infinity or NaN, is an empty cell. The file is written whole or not at all (write/file.h).
#pragma once

#include "base/text.h"
#include "write/file.h"

#include <stdbool.h>
#include <stddef.h>

// A table that is being written: cells in the order of the columns, then the end of their row. Not
// to be copied.
typedef struct RowFile {
    size_t count; // of columns
    WholeFile file;
    Text row;    // as far as it has come
    size_t cell; // the number of the next one
} RowFile;

// Claims a file for a table before the work whose results it is to hold, as file_claim does. Fails
// also with ERR_USAGE where the ending is that of another form.
bool row_file_claim(const char *user, const char *path, Err *err);

// Begins a table of so many columns. Fails as row_file_claim does; nothing is left then.
bool row_file_begin(RowFile *file, const char *path, const char *const *names, size_t count,
                    Err *err);

// Writes the next cell of a row.
void row_file_number(RowFile *file, double value);
void row_file_word(RowFile *file, const char *text);

// Ends a row, which has a cell of every column.
void row_file_end_row(RowFile *file);

// Ends the table: it stands under its name, or, with ERR_FILE, nothing of it is left.
bool row_file_end(RowFile *file, Err *err);
