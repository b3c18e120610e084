// A section of the report for people: a heading and a table under it.
#pragma once

#include "write/style.h"
#include "write/table.h"

#include <stdbool.h>

typedef struct SectionHead {
    const char *title;
    const char *unit;
    TableAlign align;
} SectionHead;

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
