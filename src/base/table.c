// How are numbers set out for people, each under its heading and its unit?
#include "base/table.h"

#include <assert.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { TABLE_FIRST_CAPACITY = 64, TABLE_CELL_SIZE = 512, TABLE_INDENT = 2, TABLE_GUTTER = 2 };

typedef struct Column {
    char *title;
    char *unit;
    TableAlign align;
    size_t width; // of its widest text, in characters
} Column;

struct Table {
    size_t column_count;
    Column *columns;
    size_t cell_count;
    size_t cell_capacity;
    char **cells;
    size_t rule_count;
    size_t rule_capacity;
    size_t *rules; // each: how many cells stand above it
};

static char *copy_text(const char *source)
{
    const size_t size = strlen(source) + 1;
    char *copy = malloc(size);
    assert(copy != NULL);
    return memcpy(copy, source, size);
}

// The characters of UTF-8 text: bytes that do not continue one.
static size_t text_width(const char *text)
{
    size_t width = 0;
    for (; *text != '\0'; text++) {
        width += ((unsigned char)*text & 0xc0u) != 0x80u ? 1 : 0;
    }
    return width;
}

static void widen_column(Column *column, const char *text)
{
    const size_t width = text_width(text);
    column->width = width > column->width ? width : column->width;
}

Table *table_create(size_t columns)
{
    assert(columns > 0);
    Table *table = calloc(1, sizeof *table);
    assert(table != NULL);
    table->column_count = columns;
    table->columns = calloc(columns, sizeof *table->columns);
    assert(table->columns != NULL);
    return table;
}

void table_destroy(Table *table)
{
    if (table == NULL) {
        return;
    }
    for (size_t i = 0; i < table->column_count; i++) {
        free(table->columns[i].title);
        free(table->columns[i].unit);
    }
    for (size_t i = 0; i < table->cell_count; i++) {
        free(table->cells[i]);
    }
    free(table->columns);
    free(table->cells);
    free(table->rules);
    free(table);
}

void table_head(Table *table, size_t column, const char *title, const char *unit, TableAlign align)
{
    assert(column < table->column_count);
    Column *head = &table->columns[column];
    free(head->title);
    free(head->unit);
    head->title = copy_text(title);
    head->unit = copy_text(unit);
    head->align = align;
    widen_column(head, title);
    widen_column(head, unit);
}

void table_cell(Table *table, const char *format, ...)
{
    char text[TABLE_CELL_SIZE];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    if (table->cell_count == table->cell_capacity) {
        const size_t grown = 2 * table->cell_capacity;
        table->cell_capacity = grown > 0 ? grown : TABLE_FIRST_CAPACITY;
        table->cells = realloc(table->cells, table->cell_capacity * sizeof *table->cells);
        assert(table->cells != NULL);
    }
    widen_column(&table->columns[table->cell_count % table->column_count], text);
    table->cells[table->cell_count] = copy_text(text);
    table->cell_count++;
}

void table_rule(Table *table)
{
    assert(table->cell_count % table->column_count == 0);
    if (table->rule_count == table->rule_capacity) {
        const size_t grown = 2 * table->rule_capacity;
        table->rule_capacity = grown > 0 ? grown : TABLE_FIRST_CAPACITY;
        table->rules = realloc(table->rules, table->rule_capacity * sizeof *table->rules);
        assert(table->rules != NULL);
    }
    table->rules[table->rule_count] = table->cell_count;
    table->rule_count++;
}

// One line; spaces are owed and only paid before a text, so that no line ends in spaces.
static void write_line(const Table *table, const char *const *texts, Text *text)
{
    size_t owed = TABLE_INDENT;
    for (size_t i = 0; i < table->column_count; i++) {
        const Column *column = &table->columns[i];
        const char *cell = texts[i] == NULL ? "" : texts[i];
        const size_t missing = column->width - text_width(cell);
        owed += column->align == TABLE_RIGHT ? missing : 0;
        if (cell[0] != '\0') {
            text_append(text, "%*s%s", (int)owed, "", cell);
            owed = 0;
        }
        owed += TABLE_GUTTER + (column->align == TABLE_LEFT ? missing : 0);
    }
    text_append(text, "\n");
}

static void write_rule(const Table *table, Text *text)
{
    text_append(text, "%*s", TABLE_INDENT, "");
    size_t width = TABLE_GUTTER * (table->column_count - 1);
    for (size_t i = 0; i < table->column_count; i++) {
        width += table->columns[i].width;
    }
    for (size_t i = 0; i < width; i++) {
        text_append(text, "-");
    }
    text_append(text, "\n");
}

static void write_head(const Table *table, Text *text)
{
    const char **titles = calloc(table->column_count, sizeof *titles);
    const char **units = calloc(table->column_count, sizeof *units);
    assert(titles != NULL && units != NULL);
    bool has_titles = false;
    bool has_units = false;
    for (size_t i = 0; i < table->column_count; i++) {
        titles[i] = table->columns[i].title;
        units[i] = table->columns[i].unit;
        has_titles = has_titles || titles[i] != NULL;
        has_units = has_units || (units[i] != NULL && units[i][0] != '\0');
    }
    if (has_titles) {
        write_line(table, titles, text);
    }
    if (has_units) {
        write_line(table, units, text);
    }
    if (has_titles) {
        write_rule(table, text);
    }
    free(titles);
    free(units);
}

void table_write(const Table *table, Text *text)
{
    assert(table->cell_count % table->column_count == 0);
    write_head(table, text);
    size_t rule = 0;
    for (size_t cell = 0; cell <= table->cell_count; cell += table->column_count) {
        for (; rule < table->rule_count && table->rules[rule] == cell; rule++) {
            write_rule(table, text);
        }
        if (cell < table->cell_count) {
            write_line(table, (const char *const *)&table->cells[cell], text);
        }
    }
}
