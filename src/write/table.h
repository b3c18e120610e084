// Text tables and sections for people.
#pragma once

#include "base/text.h"

#include <stdbool.h>
#include <stddef.h>

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

// The insides of a table are for table.c alone.
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

// What a heading and a failure look like, as they are or marked for a terminal, and how wide a line
// may be.

typedef struct Style {
    const char *heading; // put in front of a heading
    const char *failure; // put in front of what failed
    const char *end;     // put behind either
    size_t width;        // the most characters of a line; 0: any number
} Style;

enum { STYLE_WIDTH = 80 }; // characters, where no terminal says another number

static const Style STYLE_PLAIN = {"", "", "", 0};
static const Style STYLE_TERMINAL = {"\x1b[1m", "\x1b[31m", "\x1b[0m", 0};

// Appends a line of a first screen, folded to its width, and frees the words.
void screen_line(Text *words, Text *text);

// The same without folding it.
void screen_sentence(Text *words, Text *text);

// A section of the report for people: a heading and a table under it.

typedef struct SectionHead {
    const char *title;
    const char *unit;
    TableAlign align;
} SectionHead;

// A table with these heads, for table_destroy.
Table *table_headed(size_t columns, const SectionHead *heads);

// Appends a heading on a line of its own, behind an empty one. It may be a path.
void section_heading(const char *heading, const Style *style, Text *text);

// Begins a report: the title of a case and its path, where it has them.
void section_title(const char *title, const char *path, const Style *style, Text *text);

// Begins a section; the caller fills the table and hands it to section_end, which frees it.
Table *section_begin(const char *heading, size_t columns, const SectionHead *heads,
                     const Style *style, Text *text);
void section_end(Table *table, Text *text);

// Four digits; a number that would need an exponent for them gets all of its own instead.
void section_number(Table *table, double value);

// The same, or a dash where it is not known.
void section_number_or_dash(Table *table, bool is_known, double value);

// A number in a format of its own, or a dash where it is not finite.
void section_finite(Table *table, const char *format, double value);
