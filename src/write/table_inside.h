// What a table is made of: for table.c, which fills it, and table_write.c, which sets it out.
#pragma once

#include "write/table.h"

typedef struct TableColumn {
    char *title; // NULL without a head, as the unit
    char *unit;
    TableAlign align;
    size_t width; // of its widest text, in characters
} TableColumn;

struct Table {
    size_t column_count;
    TableColumn *columns;
    size_t cell_count;
    size_t cell_capacity;
    char **cells;
    size_t rule_count;
    size_t rule_capacity;
    size_t *rules; // each: how many cells stand above it
    size_t fit;    // the most characters of a line; 0: any number
};
