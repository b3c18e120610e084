// Text tables for people: columns under headings with units, numbers to the right, words to the
// left, no wider than a terminal.
#pragma once

#include "base/text.h"

// How a column is set, and what becomes of it in a table that is too wide. One of the first three,
// and any of the others: TABLE_RIGHT | TABLE_DETAIL.
//
// A table that is too wide loses its details first, then its minor columns, each from the right and
// only until it fits; a line below names what is missing. Where that is not enough, all columns are
// written in parts below one another, and the key columns stand in every part: those marked so, and
// the words that the table begins with.
typedef enum TableAlign {
    TABLE_LEFT = 0,
    TABLE_RIGHT = 1,
    TABLE_WRAP = 2,   // to the left, and a long text takes several lines where there is no room
    TABLE_KEY = 4,    // stands in every part
    TABLE_MINOR = 8,  // may be left out
    TABLE_DETAIL = 16 // may be left out before the minor ones
} TableAlign;

// The insides of a table are for table.c, which fills it, and table_write.c, which sets it out.
typedef struct TableColumn {
    char *title; // NULL without a head, as the unit
    char *unit;
    TableAlign align;
    size_t width; // of its widest text, in characters
} TableColumn;

typedef struct Table {
    size_t column_count;
    TableColumn *columns;
    size_t cell_count;
    size_t cell_capacity;
    char **cells;
    size_t rule_count;
    size_t rule_capacity;
    size_t *rules; // each: how many cells stand above it
    size_t fit;    // the most characters of a line; 0: any number
} Table;

// A table of that many columns; table_destroy frees it and accepts NULL.
Table *table_create(size_t columns);
void table_destroy(Table *table);

// Heads one column: a title, a unit (empty for none; it stands on a second line), an alignment.
void table_head(Table *table, size_t column, const char *title, const char *unit, TableAlign align);

// The most characters that a line of the table may have; 0, as in a new table, for any number.
void table_fit(Table *table, size_t width);

// Fills the next cell, row by row from the left. UTF-8; a wide text makes its column wide.
void table_cell(Table *table, const char *format, ...) __attribute__((format(printf, 2, 3)));

// A rule below the rows filled so far.
void table_rule(Table *table);

// Appends the table to the text, each line indented by two spaces. The last row must be full.
void table_write(const Table *table, Text *text);
