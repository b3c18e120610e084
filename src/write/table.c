// How are numbers set out for people, each under its heading and its unit?
#include "write/table.h"

#include "base/printable.h"

#include <assert.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { TABLE_FIRST_CAPACITY = 64 };

static void widen_column(TableColumn *column, const char *text)
{
    const size_t width = text_width(text, strlen(text));
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
    TableColumn *head = &table->columns[column];
    free(head->title);
    free(head->unit);
    head->title = printable_copy(title, false);
    head->unit = printable_copy(unit, false);
    head->align = align;
    widen_column(head, head->title);
    widen_column(head, head->unit);
}

void table_fit(Table *table, size_t width)
{
    table->fit = width;
}

// A negative number that is rounded to 0 is shown as 0: "-0.00" as "0.00".
static void drop_sign_of_zero(char *text)
{
    const size_t length = strlen(text);
    const bool is_zero = text[0] == '-' && length > 1 && strspn(text + 1, "0.") == length - 1 &&
                         strchr(text, '0') != NULL;
    if (is_zero) {
        memmove(text, text + 1, length);
    }
}

void table_cell(Table *table, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    char *text = printable_format(format, arguments);
    va_end(arguments);
    drop_sign_of_zero(text);
    if (table->cell_count == table->cell_capacity) {
        const size_t grown = 2 * table->cell_capacity;
        table->cell_capacity = grown > 0 ? grown : TABLE_FIRST_CAPACITY;
        table->cells = realloc(table->cells, table->cell_capacity * sizeof *table->cells);
        assert(table->cells != NULL);
    }
    widen_column(&table->columns[table->cell_count % table->column_count], text);
    table->cells[table->cell_count] = text;
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
