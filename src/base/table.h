// Text tables for people: columns under headings with units, numbers to the right, words to the
// left.
#pragma once

#include "base/text.h"

typedef enum TableAlign { TABLE_LEFT, TABLE_RIGHT } TableAlign;

typedef struct Table Table;

// A table of so many columns; table_destroy frees it and accepts NULL.
Table *table_create(size_t columns);
void table_destroy(Table *table);

// Heads one column: a title, a unit (empty for none; it stands on a second line), an alignment.
void table_head(Table *table, size_t column, const char *title, const char *unit, TableAlign align);

// Fills the next cell, row by row from the left. UTF-8; a wide text makes its column wide.
void table_cell(Table *table, const char *format, ...) __attribute__((format(printf, 2, 3)));

// A rule below the rows filled so far.
void table_rule(Table *table);

// Appends the table to the text, each line indented by two spaces. The last row must be full.
void table_write(const Table *table, Text *text);
