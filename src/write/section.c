// What does a section of the report look like?
#include "write/section.h"

#include <math.h>
#include <stdio.h>

void section_heading(const char *heading, const Style *style, Text *text)
{
    text_append(text, "\n%s", style->heading);
    text_append_shown(text, heading);
    text_append(text, "%s\n", style->end);
}

void section_title(const char *title, const char *path, const Style *style, Text *text)
{
    text_append(text, "%s%s%s\n\n", style->heading,
                title[0] != '\0' ? title : "A case without a title", style->end);
    if (path[0] != '\0') {
        text_append(text, "  case        ");
        text_append_shown(text, path);
        text_append(text, "\n");
    }
}

Table *section_begin(const char *heading, size_t columns, const SectionHead *heads,
                     const Style *style, Text *text)
{
    section_heading(heading, style, text);
    text_append(text, "\n");
    Table *table = table_create(columns);
    table_fit(table, style->width);
    for (size_t i = 0; i < columns; i++) {
        table_head(table, i, heads[i].title, heads[i].unit, heads[i].align);
    }
    return table;
}

void section_end(Table *table, Text *text)
{
    table_write(table, text);
    table_destroy(table);
}

void section_number(Table *table, double value)
{
    const bool is_long = fabs(value) >= 1e4 && fabs(value) < 1e8;
    table_cell(table, is_long ? "%.0f" : "%.4g", value);
}

void section_number_or_dash(Table *table, bool is_known, double value)
{
    if (is_known) {
        section_number(table, value);
    } else {
        table_cell(table, "-");
    }
}

void section_finite(Table *table, const char *format, double value)
{
    char text[32];
    snprintf(text, sizeof text, format, value);
    table_cell(table, "%s", isfinite(value) ? text : "-");
}
