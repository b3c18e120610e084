// A table of numbers and words as CSV, JSON Lines or SQLite, by the ending of its file's name.
//
// Every number reads back as the very same double, a zero with its sign. One that does not exist,
// an infinity or NaN, is an empty cell of CSV, null in JSON and NULL in SQLite. The file is written
// whole or not at all (write/file.h).
#pragma once

#include "base/text.h"
#include "write/file.h"

#include <stdbool.h>
#include <stddef.h>

// What a table has, all of it borrowed.
typedef struct RowHead {
    const char *table;        // its name in SQLite
    const char *const *names; // of the columns
    size_t count;
} RowHead;

typedef struct RowForm RowForm;

// A table that is being written: cells in the order of the columns, then the end of their row. Not
// to be copied.
typedef struct RowFile {
    const RowForm *form;
    RowHead head; // must live as long
    WholeFile file;
    Text row;    // as far as it has come
    size_t cell; // the number of the next one
    void *own;   // what the form needs besides
} RowFile;

// A form of a table. What fails while it is written is remembered in `file.sink` as an errno.
struct RowForm {
    const char *ending; // of the names of such files
    FileKind kind;
    // Whether such a file can be: ERR_USAGE, ERR_FILE. NULL: it always can.
    bool (*check)(const char *user, const char *path, const RowHead *head, Err *err);
    void (*begin)(RowFile *file);
    void (*number)(RowFile *file, double value);
    void (*word)(RowFile *file, const char *text);
    void (*end_row)(RowFile *file);
    void (*end)(RowFile *file); // NULL: there is nothing to do
};

extern const RowForm row_form_sqlite;

// Claims a file for a table before the work whose results it is to hold, as file_claim does. Fails
// also with ERR_USAGE where the ending is that of another form of JSON or SQLite, and where a table
// of such a head or to such a stream cannot be in the form that the ending asks for.
bool row_file_claim(const char *user, const char *path, const RowHead *head, Err *err);

// Begins a table. Fails as row_file_claim does; nothing is left then.
bool row_file_begin(RowFile *file, const char *path, const RowHead *head, Err *err);

// Writes the next cell of a row.
void row_file_number(RowFile *file, double value);
void row_file_word(RowFile *file, const char *text);

// Ends a row, which has a cell of every column.
void row_file_end_row(RowFile *file);

// Ends the table: it stands under its name, or, with ERR_FILE, nothing of it is left.
bool row_file_end(RowFile *file, Err *err);
