// Sets out numbers in tables and sections for people.
#include "write/table.h"
#include "base/printable.h"

#include <assert.h>
#include <math.h>
#include <stdarg.h>
#include <stdbool.h>
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

// The columns there is room for, and how the table looks.
//
// A table no wider than its limit is written as it is. One that is wider gives up columns by their
// importance, then breaks the words of columns that may be broken, then is written in parts.

enum {
    TABLE_INDENT = 2,
    TABLE_GUTTER = 2,
    TABLE_WRAP_LEAST = 20, // characters: broken into shorter lines, words are hard to read
};

// Columns that are written side by side, in their order.
typedef struct Part {
    size_t count;
    size_t *columns; // their numbers
    size_t *widths;  // characters
} Part;

static size_t least_width(const TableColumn *column)
{
    const bool is_broken = (column->align & TABLE_WRAP) != 0 && column->width > TABLE_WRAP_LEAST;
    return is_broken ? TABLE_WRAP_LEAST : column->width;
}

static bool is_aligned(const TableColumn *column, TableAlign align)
{
    return (column->align & align) != 0;
}

static Part part_create(const Table *table)
{
    const size_t count = table->column_count;
    Part part = {.columns = calloc(count, sizeof *part.columns),
                 .widths = calloc(count, sizeof *part.widths)};
    assert(part.columns != NULL && part.widths != NULL);
    return part;
}

static void part_finish(Part *part)
{
    free(part->columns);
    free(part->widths);
}

// The characters of a line of the part, with its words broken as far as they may be.
static size_t least_line(const Table *table, const Part *part)
{
    size_t width = TABLE_INDENT + TABLE_GUTTER * (part->count - 1);
    for (size_t i = 0; i < part->count; i++) {
        width += least_width(&table->columns[part->columns[i]]);
    }
    return width;
}

static bool fits(const Table *table, const Part *part)
{
    return table->fit == 0 || least_line(table, part) <= table->fit;
}

static void part_remove(Part *part, size_t index)
{
    part->count--;
    for (size_t i = index; i < part->count; i++) {
        part->columns[i] = part->columns[i + 1];
    }
}

static void table_take_all(const Table *table, Part *part)
{
    part->count = table->column_count;
    for (size_t i = 0; i < part->count; i++) {
        part->columns[i] = i;
    }
}

// Takes out columns of an importance from the right until the rest fits, and says whether it does.
static bool drop_columns(const Table *table, TableAlign importance, Part *part, bool *is_dropped)
{
    for (size_t i = part->count; i-- > 0 && !fits(table, part);) {
        const size_t column = part->columns[i];
        if (is_aligned(&table->columns[column], importance)) {
            part_remove(part, i);
            is_dropped[column] = true;
        }
    }
    return fits(table, part);
}

// Words between which a line is broken share what room there is.
static void set_widths(const Table *table, Part *part)
{
    const size_t line = least_line(table, part);
    size_t room = table->fit > line ? table->fit - line : 0;
    for (size_t i = 0; i < part->count; i++) {
        const TableColumn *column = &table->columns[part->columns[i]];
        const size_t least = least_width(column);
        const size_t wanted = column->width - least;
        const size_t given = table->fit == 0 || wanted < room ? wanted : room;
        part->widths[i] = least + given;
        room -= table->fit == 0 ? 0 : given;
    }
}

// The bytes of the first line of a text that is broken at a width, without the space behind it.
static size_t first_line(const char *text, size_t width)
{
    size_t used = 0;
    size_t last_word = 0;
    for (size_t i = 0; text[i] != '\0'; i++) {
        used += ((unsigned char)text[i] & 0xc0u) != 0x80u ? 1 : 0;
        if (text[i] == ' ' && used <= width + 1) {
            last_word = i;
        }
        if (used > width && last_word > 0) {
            return last_word;
        }
    }
    return strlen(text);
}

// One line of texts, each from where the last one ended: spaces are owed and only paid before a
// text, so that no line ends in spaces. Returns whether any text has more lines.
static bool table_write_line(const Table *table, const Part *part, const char **texts, Text *text)
{
    size_t owed = TABLE_INDENT;
    bool has_more = false;
    for (size_t i = 0; i < part->count; i++) {
        const size_t number = part->columns[i];
        const TableColumn *column = &table->columns[number];
        const char *cell = texts[number] == NULL ? "" : texts[number];
        const bool is_broken = is_aligned(column, TABLE_WRAP);
        const size_t size = is_broken ? first_line(cell, part->widths[i]) : strlen(cell);
        const size_t used = text_width(cell, size);
        const size_t missing = part->widths[i] > used ? part->widths[i] - used : 0;
        owed += is_aligned(column, TABLE_RIGHT) ? missing : 0;
        if (size > 0) {
            text_append(text, "%*s%.*s", (int)owed, "", (int)size, cell);
            owed = 0;
        }
        owed += TABLE_GUTTER + (is_aligned(column, TABLE_RIGHT) ? 0 : missing);
        texts[number] = cell + size + strspn(cell + size, " ");
        has_more = has_more || texts[number][0] != '\0';
    }
    text_append(text, "\n");
    return has_more;
}

static void table_write_row(const Table *table, const Part *part, const char *const *cells,
                            Text *text)
{
    const char **texts = calloc(table->column_count, sizeof *texts);
    assert(texts != NULL);
    memcpy(texts, cells, table->column_count * sizeof *texts);
    while (table_write_line(table, part, texts, text)) {
    }
    free(texts);
}

static void write_rule(const Part *part, Text *text)
{
    text_append(text, "%*s", TABLE_INDENT, "");
    size_t width = TABLE_GUTTER * (part->count - 1);
    for (size_t i = 0; i < part->count; i++) {
        width += part->widths[i];
    }
    for (size_t i = 0; i < width; i++) {
        text_append(text, "-");
    }
    text_append(text, "\n");
}

static void table_write_head(const Table *table, const Part *part, Text *text)
{
    const char **titles = calloc(table->column_count, sizeof *titles);
    const char **units = calloc(table->column_count, sizeof *units);
    assert(titles != NULL && units != NULL);
    bool has_titles = false;
    bool has_units = false;
    for (size_t i = 0; i < part->count; i++) {
        const size_t number = part->columns[i];
        titles[number] = table->columns[number].title;
        units[number] = table->columns[number].unit;
        has_titles = has_titles || titles[number] != NULL;
        has_units = has_units || (units[number] != NULL && units[number][0] != '\0');
    }
    if (has_titles) {
        table_write_row(table, part, titles, text);
    }
    if (has_units) {
        table_write_row(table, part, units, text);
    }
    if (has_titles) {
        write_rule(part, text);
    }
    free(titles);
    free(units);
}

// Of a table of more rows than anyone reads, as of a thousand bodies, the first are shown where
// lines have a width; without one, in files and by --wide, all.
enum { ROWS_MOST = 400, ROWS_SHOWN = 100 };

static size_t shown_cells(const Table *table)
{
    const size_t rows = table->cell_count / table->column_count;
    return table->fit > 0 && rows > ROWS_MOST ? ROWS_SHOWN * table->column_count
                                              : table->cell_count;
}

static void write_left_out(const Table *table, Text *text)
{
    const size_t left = (table->cell_count - shown_cells(table)) / table->column_count;
    if (left > 0) {
        text_append(text, "  ... and %zu rows more, which --wide shows and --json has\n", left);
    }
}

static void write_part(const Table *table, Part *part, Text *text)
{
    set_widths(table, part);
    table_write_head(table, part, text);
    size_t rule = 0;
    const size_t end = shown_cells(table);
    for (size_t cell = 0; cell <= end; cell += table->column_count) {
        for (; rule < table->rule_count && table->rules[rule] == cell; rule++) {
            write_rule(part, text);
        }
        if (cell < end) {
            table_write_row(table, part, (const char *const *)&table->cells[cell], text);
        }
    }
}

// The first column always says what a row is of.
static bool is_key(const Table *table, size_t number)
{
    size_t words = 0;
    while (words < table->column_count &&
           (table->columns[words].align & ~TABLE_KEY) == TABLE_LEFT) {
        words++;
    }
    return number == 0 || number < words || is_aligned(&table->columns[number], TABLE_KEY);
}

// The key columns, and of the others the ones of a part.
static void fill_part(const Table *table, const Part *all, size_t from, size_t to, Part *part)
{
    size_t others = 0;
    part->count = 0;
    for (size_t i = 0; i < all->count; i++) {
        const bool is_shown = is_key(table, all->columns[i]) || (others >= from && others < to);
        others += is_key(table, all->columns[i]) ? 0 : 1;
        if (is_shown) {
            part->columns[part->count++] = all->columns[i];
        }
    }
}

// The largest number of columns a part, alike in all but the last, at which every part fits.
static size_t columns_a_part(const Table *table, const Part *all, size_t others, Part *part)
{
    for (size_t parts = 2; parts < others; parts++) {
        const size_t each = (others + parts - 1) / parts;
        bool is_narrow = true;
        for (size_t from = 0; from < others; from += each) {
            fill_part(table, all, from, from + each, part);
            is_narrow = is_narrow && fits(table, part);
        }
        if (is_narrow) {
            return each;
        }
    }
    return 1;
}

static void write_parts(const Table *table, const Part *all, Text *text)
{
    Part part = part_create(table);
    size_t others = 0;
    for (size_t i = 0; i < all->count; i++) {
        others += is_key(table, all->columns[i]) ? 0 : 1;
    }
    const size_t each = columns_a_part(table, all, others, &part);
    size_t to;
    for (size_t from = 0; from < others || from == 0; from = to) {
        to = from + each;
        // where one wide column is in the way of all others, each part takes what it has room for
        for (bool has_room = each == 1; has_room && to < others; to += has_room ? 1 : 0) {
            fill_part(table, all, from, to + 1, &part);
            has_room = fits(table, &part);
        }
        fill_part(table, all, from, to, &part);
        text_append(text, "%s", from > 0 ? "\n" : "");
        write_part(table, &part, text);
    }
    part_finish(&part);
}

// Names the columns that were left out, each title once.
static void write_dropped(const Table *table, const bool *is_dropped, Text *text)
{
    bool has_any = false;
    for (size_t i = 0; i < table->column_count; i++) {
        const char *title = table->columns[i].title;
        bool is_new = is_dropped[i] && title != NULL && title[0] != '\0';
        for (size_t k = 0; k < i && is_new; k++) {
            is_new = !is_dropped[k] || strcmp(table->columns[k].title, title) != 0;
        }
        if (is_new) {
            text_append(text, "%s%s",
                        has_any ? ", " : "  Columns left out, --wide shows them: ", title);
            has_any = true;
        }
    }
    text_append(text, has_any ? ".\n" : "");
}

void table_write(const Table *table, Text *text)
{
    assert(table->cell_count % table->column_count == 0);
    bool *is_dropped = calloc(table->column_count, sizeof *is_dropped);
    assert(is_dropped != NULL);
    Part all = part_create(table);
    table_take_all(table, &all);
    const bool is_narrow = drop_columns(table, TABLE_DETAIL, &all, is_dropped) ||
                           drop_columns(table, TABLE_MINOR, &all, is_dropped);
    if (is_narrow) {
        write_part(table, &all, text);
        write_dropped(table, is_dropped, text);
    } else {
        // in parts there is room for all of them
        table_take_all(table, &all);
        write_parts(table, &all, text);
    }
    write_left_out(table, text);
    part_finish(&all);
    free(is_dropped);
}

// A section: a heading and a table.

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

void screen_sentence(Text *words, Text *text)
{
    text_append(text, "%s\n", words->data);
    text_finish(words);
}

void screen_line(Text *words, Text *text)
{
    text_fold(words, STYLE_WIDTH);
    screen_sentence(words, text);
}

Table *table_headed(size_t columns, const SectionHead *heads)
{
    Table *table = table_create(columns);
    for (size_t i = 0; i < columns; i++) {
        table_head(table, i, heads[i].title, heads[i].unit, heads[i].align);
    }
    return table;
}

Table *section_begin(const char *heading, size_t columns, const SectionHead *heads,
                     const Style *style, Text *text)
{
    section_heading(heading, style, text);
    text_append(text, "\n");
    Table *table = table_headed(columns, heads);
    table_fit(table, style->width);
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
