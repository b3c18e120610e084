// Which tables does a store have, and has it nothing else?
//
//     study    name, value, words: the key, `runs`, `checksum` of this table and of the columns
//     run      run (the number), the settings, outcome, reason, the results, hash, checksum
//     effort   run, wall_s, checksum
//
// The columns of `run` are the layout: their names, their types, and the position of `outcome`.
//
// The file may come from anyone, and SQL in its schema is run when it is read: a view instead of a
// table may have endless rows. So no query comes before its schema is known to be word for word the
// one that this program writes.
#include "commands/study/store_inside.h"

#include <assert.h>
#include <sqlite3.h>
#include <stdlib.h>
#include <string.h>

static const char *const TYPES[] = {
    [COLUMN_REAL] = "REAL", [COLUMN_WHOLE] = "INTEGER", [COLUMN_WORD] = "TEXT"};
enum { TYPE_COUNT = sizeof TYPES / sizeof *TYPES };

static const char RUN[] = "run"; // the one whose columns differ from study to study

// All that stands in the schema.
static const struct {
    const char *type;
    const char *name;
    const char *table;
    const char *sql; // NULL where it has none, or one of its own in each study
} OBJECTS[] = {
    {"table", "study", "study",
     "CREATE TABLE study(name TEXT PRIMARY KEY, value TEXT, words TEXT)"},
    {"index", "sqlite_autoindex_study_1", "study", NULL}, // of that primary key
    {"table", RUN, RUN, NULL},
    {"table", "effort", "effort",
     "CREATE TABLE effort(run INTEGER PRIMARY KEY, wall_s REAL, checksum INTEGER)"},
};
enum { OBJECT_COUNT = sizeof OBJECTS / sizeof *OBJECTS };

void store_shape_quote(Text *sql, const char *name)
{
    text_append(sql, "\"");
    for (; *name != '\0'; name++) {
        text_append(sql, *name == '"' ? "\"\"" : "%c", *name);
    }
    text_append(sql, "\"");
}

static void append_columns(Text *sql, const Column *columns, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        store_shape_quote(sql, columns[i].name);
        text_append(sql, " %s, ", TYPES[columns[i].kind]);
    }
}

static void append_run(const Layout *layout, Text *sql)
{
    text_append(sql, "CREATE TABLE run(run INTEGER PRIMARY KEY, ");
    append_columns(sql, layout->settings, layout->setting_count);
    text_append(sql, "outcome INTEGER, reason TEXT, ");
    append_columns(sql, layout->results, layout->result_count);
    text_append(sql, "hash INTEGER, checksum INTEGER)");
}

void store_shape_append(const Layout *layout, Text *sql)
{
    for (size_t i = 0; i < OBJECT_COUNT; i++) {
        if (OBJECTS[i].name == RUN) {
            append_run(layout, sql);
            text_append(sql, "; ");
        } else if (OBJECTS[i].sql != NULL) {
            text_append(sql, "%s; ", OBJECTS[i].sql);
        }
    }
}

void store_take_words(sqlite3_stmt *row, int column, char *words, size_t size)
{
    const char *text = (const char *)sqlite3_column_text(row, column);
    text_copy(words, size, text == NULL ? "" : text);
}

char *store_copy_column(sqlite3_stmt *statement, int column)
{
    const char *words = (const char *)sqlite3_column_text(statement, column);
    char *copy = strdup(words == NULL ? "" : words);
    assert(copy != NULL);
    return copy;
}

static bool is_word(sqlite3_stmt *statement, int column, const char *word)
{
    const char *words = (const char *)sqlite3_column_text(statement, column);
    return word == NULL ? words == NULL : words != NULL && strcmp(words, word) == 0;
}

// The object that a row of the schema is; OBJECT_COUNT where it is none of a store.
static size_t find_object(sqlite3_stmt *statement)
{
    size_t i = 0;
    while (i < OBJECT_COUNT &&
           !(is_word(statement, 0, OBJECTS[i].type) && is_word(statement, 1, OBJECTS[i].name) &&
             is_word(statement, 2, OBJECTS[i].table) &&
             (OBJECTS[i].name == RUN || is_word(statement, 3, OBJECTS[i].sql)))) {
        i++;
    }
    return i;
}

// Its name may be anything, and is not printed.
static bool refuse_object(const Store *store, sqlite3_stmt *statement, Err *err)
{
    static const struct {
        const char *type;
        const char *words;
    } KINDS[] = {
        {"view", "a view"}, {"trigger", "a trigger"}, {"index", "an index"}, {"table", "a table"}};
    const char *found = "something";
    for (size_t i = 0; i < sizeof KINDS / sizeof *KINDS; i++) {
        found = is_word(statement, 0, KINDS[i].type) ? KINDS[i].words : found;
    }
    return err_set(err, ERR_FILE,
                   "%s is not the store of a study: it contains %s that no store has", store->path,
                   found);
}

// Every object once, and no other. `run` receives the words of that table.
static bool read_objects(Store *store, char **run, Err *err)
{
    bool is_there[OBJECT_COUNT] = {false};
    sqlite3_stmt *row = NULL;
    bool is_right =
        store_prepare(store, "SELECT type, name, tbl_name, sql FROM sqlite_schema", &row, err);
    while (store_step(store, &row, &is_right, err)) {
        const size_t object = find_object(row);
        if (object == OBJECT_COUNT || is_there[object]) {
            is_right = refuse_object(store, row, err);
            continue;
        }
        is_there[object] = true;
        if (OBJECTS[object].name == RUN) {
            *run = store_copy_column(row, 3);
        }
    }
    for (size_t i = 0; i < OBJECT_COUNT && is_right; i++) {
        is_right =
            is_there[i] || err_set(err, ERR_FILE, "%s is not the store of a study: it has no %s %s",
                                   store->path, OBJECTS[i].type, OBJECTS[i].name);
    }
    return is_right;
}

// Adds a column where there is room; one that is left out is missing in the words made of them.
static void add_column(Column *columns, size_t *count, size_t most, sqlite3_stmt *row)
{
    if (*count < most) {
        Column *column = &columns[(*count)++];
        store_take_words(row, 0, column->name, sizeof column->name);
        for (size_t kind = 0; kind < TYPE_COUNT; kind++) {
            column->kind = is_word(row, 1, TYPES[kind]) ? (ColumnKind)kind : column->kind;
        }
    }
}

// The settings stand before `outcome`, the results behind it.
static bool read_columns(Store *store, Layout *layout, Err *err)
{
    sqlite3_stmt *row = NULL;
    bool is_read = store_prepare(
        store, "SELECT name, type FROM pragma_table_info('run') ORDER BY cid", &row, err);
    bool is_result = false;
    while (store_step(store, &row, &is_read, err)) {
        if (is_word(row, 0, "outcome")) {
            is_result = true;
        } else if (is_word(row, 0, RUN) || is_word(row, 0, "reason") || is_word(row, 0, "hash") ||
                   is_word(row, 0, "checksum")) {
            continue;
        } else if (is_result) {
            add_column(layout->results, &layout->result_count, RECORD_RESULT_MAX, row);
        } else {
            add_column(layout->settings, &layout->setting_count, RECORD_SETTING_MAX, row);
        }
    }
    return is_read;
}

bool store_shape_is_there(Store *store, bool *is_there, Err *err)
{
    sqlite3_stmt *row = NULL;
    bool is_read = store_prepare(store, "SELECT 1 FROM sqlite_schema LIMIT 1", &row, err);
    for (*is_there = false; store_step(store, &row, &is_read, err);) {
        *is_there = true;
    }
    return is_read;
}

bool store_shape_read(Store *store, Layout *layout, Err *err)
{
    char *run = NULL;
    bool is_right = read_objects(store, &run, err) && read_columns(store, layout, err);
    if (is_right) {
        Text sql;
        text_init(&sql);
        append_run(layout, &sql);
        is_right =
            strcmp(sql.data, run) == 0 ||
            store_fail_damaged(store, "the columns of its runs are not those of a store", err);
        text_finish(&sql);
    }
    free(run);
    return is_right;
}
