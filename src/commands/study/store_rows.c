// Writes the rows of a store and reads them back, under a schema that is checked.
#include "base/hash.h"
#include "commands/study/store_inside.h"

#include <assert.h>
#include <inttypes.h>
#include <math.h>
#include <sqlite3.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// The tables of a store, and that it has nothing else.
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

// Appends the SQL that makes the tables.
static void store_shape_append(const Layout *layout, Text *sql)
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

static char *store_copy_column(sqlite3_stmt *statement, int column)
{
    const char *words = (const char *)sqlite3_column_text(statement, column);
    char *copy = strdup(words == NULL ? "" : words);
    assert(copy != NULL);
    return copy;
}

static bool store_rows_is_word(sqlite3_stmt *statement, int column, const char *word)
{
    const char *words = (const char *)sqlite3_column_text(statement, column);
    return word == NULL ? words == NULL : words != NULL && strcmp(words, word) == 0;
}

// The object that a row of the schema is; OBJECT_COUNT where it is none of a store.
static size_t find_object(sqlite3_stmt *statement)
{
    size_t i = 0;
    while (i < OBJECT_COUNT &&
           !(store_rows_is_word(statement, 0, OBJECTS[i].type) &&
             store_rows_is_word(statement, 1, OBJECTS[i].name) &&
             store_rows_is_word(statement, 2, OBJECTS[i].table) &&
             (OBJECTS[i].name == RUN || store_rows_is_word(statement, 3, OBJECTS[i].sql)))) {
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
        found = store_rows_is_word(statement, 0, KINDS[i].type) ? KINDS[i].words : found;
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
static void store_rows_add_column(Column *columns, size_t *count, size_t most, sqlite3_stmt *row)
{
    if (*count < most) {
        Column *column = &columns[(*count)++];
        store_take_words(row, 0, column->name, sizeof column->name);
        for (size_t kind = 0; kind < TYPE_COUNT; kind++) {
            column->kind =
                store_rows_is_word(row, 1, TYPES[kind]) ? (ColumnKind)kind : column->kind;
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
        if (store_rows_is_word(row, 0, "outcome")) {
            is_result = true;
        } else if (store_rows_is_word(row, 0, RUN) || store_rows_is_word(row, 0, "reason") ||
                   store_rows_is_word(row, 0, "hash") || store_rows_is_word(row, 0, "checksum")) {
            continue;
        } else if (is_result) {
            store_rows_add_column(layout->results, &layout->result_count, RECORD_RESULT_MAX, row);
        } else {
            store_rows_add_column(layout->settings, &layout->setting_count, RECORD_SETTING_MAX,
                                  row);
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

// Reads the columns, after checking that the file has the tables of a store and nothing else. No
// other query may come before.
static bool store_shape_read(Store *store, Layout *layout, Err *err)
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

// The study and the program to which the rows of a store belong.
//
// The table `study` has the key, `runs`, and `checksum`: of this table and of the columns of `run`.

static const char RUNS[] = "runs";
static const char CHECKSUM[] = "checksum";
static const char COUNT_FORMAT[] = "%" PRIu64;

static uint64_t hash_words(uint64_t hash, const char *words)
{
    return hash_bytes(hash, words, strlen(words) + 1);
}

static uint64_t hash_columns(uint64_t hash, const Column *columns, size_t count)
{
    hash = hash_number(hash, (double)count);
    for (size_t i = 0; i < count; i++) {
        hash = hash_number(hash_words(hash, columns[i].name), columns[i].kind);
    }
    return hash;
}

static void store_schema_make_checksum(const StoreHead *head, char words[STORE_WORDS_SIZE])
{
    uint64_t hash = hash_number(HASH_START, (double)head->run_count);
    for (size_t i = 0; i < head->key_count; i++) {
        hash = hash_words(hash, head->keys[i].name);
        hash = hash_words(hash, head->keys[i].value);
        hash = hash_words(hash, head->keys[i].words);
    }
    hash = hash_columns(hash, head->layout->settings, head->layout->setting_count);
    hash = hash_columns(hash, head->layout->results, head->layout->result_count);
    snprintf(words, STORE_WORDS_SIZE, "%016" PRIx64, hash);
}

// The names of columns in SQL: those of the rows, and the checksum. NULL behind the last.
static const char *column_name(const Layout *layout, size_t number)
{
    RecordField field = {.name = NULL};
    return number == 0 ? CHECKSUM : record_field(layout, number - 1, &field) ? field.name : NULL;
}

// SQL does not tell capitals from small letters in them.
static bool store_rows_check_names(const Layout *layout, Err *err)
{
    const char *name;
    for (size_t i = 0; (name = column_name(layout, i)) != NULL; i++) {
        for (size_t k = 0; k < i; k++) {
            if (sqlite3_stricmp(name, column_name(layout, k)) == 0) {
                return err_set(
                    err, ERR_CASE,
                    "two columns of the study would be called %s; rename a body or joint", name);
            }
        }
    }
    return true;
}

static bool store_rows_add_value(Store *store, sqlite3_stmt *statement, const char *name,
                                 const char *value, const char *words, Err *err)
{
    sqlite3_bind_text(statement, 1, name, -1, SQLITE_STATIC);
    sqlite3_bind_text(statement, 2, value, -1, SQLITE_STATIC);
    sqlite3_bind_text(statement, 3, words, -1, SQLITE_STATIC);
    const bool is_added = sqlite3_step(statement) == SQLITE_DONE || store_fail(store, "write", err);
    sqlite3_reset(statement);
    return is_added;
}

static bool add_values(Store *store, const StoreHead *head, Err *err)
{
    sqlite3_stmt *statement = NULL;
    if (!store_prepare(store, "INSERT INTO study VALUES (?, ?, ?)", &statement, err)) {
        return false;
    }
    bool is_added = true;
    for (size_t i = 0; i < head->key_count && is_added; i++) {
        const StoreKey *key = &head->keys[i];
        is_added = store_rows_add_value(store, statement, key->name, key->value, key->words, err);
    }
    char runs[STORE_WORDS_SIZE];
    char checksum[STORE_WORDS_SIZE];
    snprintf(runs, sizeof runs, COUNT_FORMAT, head->run_count);
    store_schema_make_checksum(head, checksum);
    is_added = is_added && store_rows_add_value(store, statement, RUNS, runs, NULL, err) &&
               store_rows_add_value(store, statement, CHECKSUM, checksum, NULL, err);
    sqlite3_finalize(statement);
    return is_added;
}

bool store_schema_make(Store *store, const StoreHead *head, Err *err)
{
    if (!store_rows_check_names(head->layout, err)) {
        return false;
    }
    Text sql;
    text_init(&sql);
    text_append(&sql, "BEGIN IMMEDIATE; PRAGMA application_id = %d; PRAGMA user_version = %d; ",
                STORE_APPLICATION, STORE_VERSION);
    store_shape_append(head->layout, &sql);
    // a store without rows is whole, so that what is killed later is a store
    const bool is_made = store_run_sql(store, sql.data, err) && add_values(store, head, err) &&
                         store_run_sql(store, "COMMIT", err);
    if (!is_made) {
        sqlite3_exec(store->base, "ROLLBACK", NULL, NULL, NULL);
    }
    text_finish(&sql);
    return is_made;
}

// The key, the number of runs, and the checksum that was written with them.
static bool read_values(Store *store, char checksum[STORE_WORDS_SIZE], Err *err)
{
    sqlite3_stmt *row = NULL;
    bool is_read =
        store_prepare(store, "SELECT name, value, words FROM study ORDER BY rowid", &row, err);
    while (store_step(store, &row, &is_read, err)) {
        char *name = store_copy_column(row, 0);
        char *value = store_copy_column(row, 1);
        const bool is_count = strcmp(name, RUNS) == 0;
        const bool is_checksum = strcmp(name, CHECKSUM) == 0;
        if (!is_count && !is_checksum && store->key_count < STORE_KEY_MAX) {
            store->keys[store->key_count++] = (StoreKey){name, value, store_copy_column(row, 2)};
            continue;
        }
        if (is_count) {
            store->run_count = strtoull(value, NULL, 10);
        } else if (is_checksum) {
            text_copy(checksum, STORE_WORDS_SIZE, value);
        }
        free(name);
        free(value);
    }
    return is_read;
}

StoreHead store_schema_head(const Store *store)
{
    StoreHead head = {
        .layout = store->layout, .run_count = store->run_count, .key_count = store->key_count};
    memcpy(head.keys, store->keys, sizeof head.keys);
    return head;
}

bool store_schema_read(Store *store, Err *err)
{
    char stored[STORE_WORDS_SIZE] = "";
    char checksum[STORE_WORDS_SIZE];
    store_schema_finish(store);
    store->layout = calloc(1, sizeof *store->layout);
    assert(store->layout != NULL);
    if (!store_shape_read(store, store->layout, err) || !read_values(store, stored, err)) {
        return false;
    }
    const StoreHead head = store_schema_head(store);
    store_schema_make_checksum(&head, checksum);
    return strcmp(stored, checksum) == 0 ||
           store_fail_damaged(store, "its key and columns do not match their checksum", err);
}

static bool keys_differ(const StoreKey *there, const StoreKey *here, Text *words)
{
    if (there != NULL && strcmp(there->value, here->value) == 0) {
        return false;
    }
    text_append(words, "%s (%s is %s there and %s here)", here->words, here->name,
                there == NULL ? "missing" : there->value, here->value);
    return true;
}

static bool columns_differ(const char *what, const Column *there, size_t there_count,
                           const Column *here, size_t here_count, Text *words)
{
    const size_t count = there_count > here_count ? there_count : here_count;
    for (size_t i = 0; i < count; i++) {
        const char *was = i < there_count ? there[i].name : "missing";
        const char *is = i < here_count ? here[i].name : "missing";
        if (strcmp(was, is) != 0 || there[i].kind != here[i].kind) {
            text_append(words, "%s %zu is %s there and %s here", what, i + 1, was, is);
            return true;
        }
    }
    return false;
}

// The first thing in which a store differs from what is asked for, as words; "there" is the store.
static bool differs(const Store *store, const StoreHead *head, Text *words)
{
    for (size_t i = 0; i < head->key_count; i++) {
        const StoreKey *here = &head->keys[i];
        const StoreKey *there = NULL;
        for (size_t k = 0; k < store->key_count; k++) {
            there = strcmp(store->keys[k].name, here->name) == 0 ? &store->keys[k] : there;
        }
        if (keys_differ(there, here, words)) {
            return true;
        }
    }
    if (store->key_count != head->key_count) {
        text_append(words, "its key has %zu parts there and %zu here", store->key_count,
                    head->key_count);
        return true;
    }
    if (store->run_count != head->run_count) {
        text_append(words, "the study has %" PRIu64 " runs there and %" PRIu64 " here",
                    store->run_count, head->run_count);
        return true;
    }
    const Layout *there = store->layout;
    const Layout *here = head->layout;
    return columns_differ("setting", there->settings, there->setting_count, here->settings,
                          here->setting_count, words) ||
           columns_differ("result", there->results, there->result_count, here->results,
                          here->result_count, words);
}

bool store_schema_check(const Store *store, const StoreHead *head, const char *source, Err *err)
{
    Text words;
    text_init(&words);
    const bool is_same = !differs(store, head, &words);
    if (!is_same && source == NULL) {
        err_set(err, ERR_FILE, "the store %s holds other runs: %s; --fresh starts it over",
                store->path, words.data);
    } else if (!is_same) {
        err_set(err, ERR_FILE, "%s cannot be merged with %s: %s", store->path, source, words.data);
    }
    text_finish(&words);
    return is_same;
}

void store_schema_finish(Store *store)
{
    for (size_t i = 0; i < store->key_count; i++) {
        free((char *)store->keys[i].name);
        free((char *)store->keys[i].value);
        free((char *)store->keys[i].words);
    }
    store->key_count = 0;
    free(store->layout);
    store->layout = NULL;
}

// A run becomes a row, and the row the run again, bit for bit.
//
// SQLite has no checksums: a bit that turned on the disk would be another number. So each row
// carries one of its own over all that is written, 32 bits of it. NAN is NULL. The sign of a zero
// is lost: a REAL without a fraction is kept as a whole number, which also makes it short.
//
// Rows are read in portions, and the file is unlocked in between, so that a reader never blocks the
// process that writes.

enum { PORTION = 64 }; // rows at a time, of some 5 kB each

// Whole numbers of this size and below have a double of their own.
static const double WHOLE_MAX = 9007199254740992.0; // 2^53

static uint64_t hash_value(uint64_t hash, double value)
{
    // one NAN and one zero of each kind; the sum makes a zero positive
    return hash_number(hash, isnan(value) ? (double)NAN : value + 0.0);
}

static int32_t store_row_make_checksum(const Layout *layout, const Record *record)
{
    uint64_t hash = hash_number(HASH_START, (double)record->run);
    hash = hash_number(hash, record->outcome);
    hash = hash_bytes(hash, record->reason, strlen(record->reason));
    for (size_t i = 0; i < layout->setting_count; i++) {
        const Cell *cell = &record->settings[i];
        hash = layout->settings[i].kind == COLUMN_WORD
                   ? hash_bytes(hash, cell->word, strlen(cell->word) + 1)
                   : hash_value(hash, cell->number);
    }
    for (size_t i = 0; i < layout->result_count; i++) {
        hash = hash_value(hash, record->results[i]);
    }
    hash = hash_bytes(hash, &record->hash, sizeof record->hash);
    return (int32_t)(uint32_t)(hash >> 32);
}

// The checksum of what differs each time.
static int32_t store_row_effort_checksum(uint64_t run, double wall_s)
{
    const uint64_t hash = hash_value(hash_number(HASH_START, (double)run), wall_s);
    return (int32_t)(uint32_t)(hash >> 32);
}

static bool is_same_number(double a, double b)
{
    return a == b || (isnan(a) && isnan(b));
}

bool store_row_is_same(const Layout *layout, const Record *a, const Record *b)
{
    bool is_same = a->run == b->run && a->outcome == b->outcome && a->hash == b->hash;
    RecordField field;
    for (size_t i = 0; record_field(layout, i, &field) && field.kind != COLUMN_HASH; i++) {
        const bool is_text = field.kind == COLUMN_WORD || field.kind == COLUMN_REASON;
        const bool is_number = field.kind == COLUMN_REAL || field.kind == COLUMN_WHOLE;
        is_same =
            is_same && (!is_text || strcmp(record_text(a, &field), record_text(b, &field)) == 0) &&
            (!is_number || is_same_number(record_number(a, &field), record_number(b, &field)));
    }
    return is_same;
}

static void bind_number(sqlite3_stmt *statement, int parameter, double value, ColumnKind kind)
{
    if (kind == COLUMN_WHOLE && fabs(value) <= WHOLE_MAX && value == rint(value)) {
        sqlite3_bind_int64(statement, parameter, (sqlite3_int64)value);
    } else {
        sqlite3_bind_double(statement, parameter, value);
    }
}

// Binds all columns of a row to the statement that adds one.
static void store_row_bind(const Layout *layout, sqlite3_stmt *statement, const Record *record)
{
    int parameter = 1;
    RecordField field = {.kind = COLUMN_RUN};
    for (size_t i = 0; field.kind != COLUMN_HASH; i++, parameter++) {
        record_field(layout, i, &field);
        switch (field.kind) {
        case COLUMN_RUN:
            sqlite3_bind_int64(statement, parameter, (sqlite3_int64)record->run);
            break;
        case COLUMN_FATE:
            sqlite3_bind_int(statement, parameter, (int)record->outcome);
            break;
        case COLUMN_WORD:
            sqlite3_bind_text(statement, parameter, record_text(record, &field), -1, SQLITE_STATIC);
            break;
        case COLUMN_REASON:
            sqlite3_bind_text(statement, parameter,
                              record->reason[0] == '\0' ? NULL : record->reason, -1, SQLITE_STATIC);
            break;
        case COLUMN_HASH:
            sqlite3_bind_int64(statement, parameter, (sqlite3_int64)record->hash);
            break;
        case COLUMN_REAL:
        case COLUMN_WHOLE:
            bind_number(statement, parameter, record_number(record, &field), field.kind);
            break;
        }
    }
    sqlite3_bind_int(statement, parameter, store_row_make_checksum(layout, record));
}

bool store_row_prepare(Store *store, sqlite3_stmt **statement, Err *err)
{
    return store_prepare(store,
                         "SELECT run.*, effort.wall_s, effort.checksum FROM run LEFT JOIN effort "
                         "USING (run) WHERE run.run > ? ORDER BY run.run LIMIT ?",
                         statement, err);
}

static double column_number(sqlite3_stmt *statement, int column)
{
    return sqlite3_column_type(statement, column) == SQLITE_NULL
               ? NAN
               : sqlite3_column_double(statement, column);
}

bool store_row_take(const Store *store, sqlite3_stmt *statement, Record *record, Err *err)
{
    int column = 0;
    int outcome = 0;
    RecordField field = {.kind = COLUMN_RUN};
    for (size_t i = 0; field.kind != COLUMN_HASH; i++, column++) {
        record_field(store->layout, i, &field);
        void *target = record_target(record, &field);
        switch (field.kind) {
        case COLUMN_RUN:
        case COLUMN_HASH:
            *(uint64_t *)target = (uint64_t)sqlite3_column_int64(statement, column);
            break;
        case COLUMN_FATE:
            outcome = sqlite3_column_int(statement, column);
            record->outcome = (RunOutcome)outcome;
            break;
        case COLUMN_WORD:
            store_take_words(statement, column, target, RECORD_WORD_SIZE);
            break;
        case COLUMN_REASON:
            store_take_words(statement, column, target, RECORD_REASON_SIZE);
            break;
        case COLUMN_REAL:
        case COLUMN_WHOLE:
            *(double *)target = column_number(statement, column);
            break;
        }
    }
    const sqlite3_int64 checksum = sqlite3_column_int64(statement, column++);
    record->wall_s = column_number(statement, column++);
    const bool is_effort = sqlite3_column_type(statement, column) != SQLITE_NULL &&
                           sqlite3_column_int64(statement, column) ==
                               store_row_effort_checksum(record->run, record->wall_s);
    if (outcome >= 0 && outcome < RUN_OUTCOME_COUNT && is_effort &&
        checksum == store_row_make_checksum(store->layout, record)) {
        return true;
    }
    char words[STORE_WORDS_SIZE];
    snprintf(words, sizeof words,
             "run %" PRIu64 " does not match its checksum; 'jointplay study FILE --retry-failed' "
             "makes it again",
             record->run);
    return store_fail_damaged(store, words, err);
}

// Reads the rows behind a number into the portion; their count.
static bool read_portion(Store *store, sqlite3_int64 behind, Record *portion, size_t *count,
                         Err *err)
{
    sqlite3_bind_int64(store->rows, 1, behind);
    sqlite3_bind_int(store->rows, 2, PORTION);
    *count = 0;
    int status;
    bool is_read = true;
    while (is_read && (status = sqlite3_step(store->rows)) == SQLITE_ROW) {
        is_read = store_row_take(store, store->rows, &portion[*count], err);
        // a damaged tree may come back to where it was
        if (is_read && (sqlite3_int64)portion[*count].run <= behind) {
            is_read = store_fail_damaged(store, "its runs are out of order", err);
        }
        behind = (sqlite3_int64)portion[*count].run;
        (*count)++;
    }
    is_read = is_read && (status == SQLITE_DONE || store_fail(store, "read", err));
    sqlite3_reset(store->rows);
    return is_read;
}

bool store_each(Store *store, StoreTaker take, void *context, Err *err)
{
    if (!store_file_check(store, err) || !store_row_prepare(store, &store->rows, err)) {
        return false;
    }
    Record *portion = calloc(PORTION, sizeof *portion);
    assert(portion != NULL);
    sqlite3_int64 behind = -1;
    size_t count = PORTION;
    bool is_done = true;
    while (is_done && count == PORTION) {
        is_done = read_portion(store, behind, portion, &count, err);
        for (size_t i = 0; i < count && is_done; i++) {
            is_done = take(store->layout, &portion[i], context, err);
        }
        behind = count > 0 ? (sqlite3_int64)portion[count - 1].run : behind;
    }
    free(portion);
    return is_done;
}

// Adds rows, and deletes them so that they are made again.
//
// A row is written whole, together with its effort, in a transaction that store_commit ends.

static bool step_to_end(Store *store, sqlite3_stmt *statement, uint64_t run, Err *err)
{
    const int status = sqlite3_step(statement);
    if ((status & 0xff) == SQLITE_CONSTRAINT) {
        err_set(err, ERR_FILE, "run %" PRIu64 " is in the store %s already", run, store->path);
    } else if (status != SQLITE_DONE) {
        store_fail(store, "write", err);
    }
    sqlite3_reset(statement);
    return status == SQLITE_DONE;
}

// SQLite may have ended the transaction by itself.
static bool take_back(Store *store)
{
    sqlite3_exec(store->base, "ROLLBACK", NULL, NULL, NULL);
    store->is_changing = false;
    return false;
}

static bool prepare_adding(Store *store, Err *err)
{
    if (store->add_run != NULL && store->add_effort != NULL) {
        return true;
    }
    const size_t count = 5 + store->layout->setting_count + store->layout->result_count;
    Text sql;
    text_init(&sql);
    text_append(&sql, "INSERT INTO run VALUES (");
    for (size_t i = 0; i < count; i++) {
        text_append(&sql, i == 0 ? "?" : ", ?");
    }
    text_append(&sql, ")");
    const bool is_ready =
        store_prepare(store, sql.data, &store->add_run, err) &&
        store_prepare(store, "INSERT INTO effort VALUES (?, ?, ?)", &store->add_effort, err);
    text_finish(&sql);
    return is_ready;
}

static bool store_rows_begin(Store *store, Err *err)
{
    store->is_changing = store->is_changing || store_run_sql(store, "BEGIN IMMEDIATE", err);
    return store->is_changing;
}

bool store_add(Store *store, const Record *record, Err *err)
{
    if (!prepare_adding(store, err) || !store_rows_begin(store, err)) {
        return false;
    }
    store_row_bind(store->layout, store->add_run, record);
    if (!step_to_end(store, store->add_run, record->run, err)) {
        return take_back(store);
    }
    sqlite3_bind_int64(store->add_effort, 1, (sqlite3_int64)record->run);
    sqlite3_bind_double(store->add_effort, 2, record->wall_s);
    sqlite3_bind_int(store->add_effort, 3, store_row_effort_checksum(record->run, record->wall_s));
    return step_to_end(store, store->add_effort, record->run, err) || take_back(store);
}

bool store_commit(Store *store, Err *err)
{
    if (store->is_changing && !store_run_sql(store, "COMMIT", err)) {
        return take_back(store);
    }
    store->is_changing = false;
    return true;
}

bool store_has(Store *store, uint64_t run, bool *has, Err *err)
{
    if (!store_prepare(store, "SELECT 1 FROM run WHERE run = ?", &store->find, err)) {
        return false;
    }
    sqlite3_bind_int64(store->find, 1, (sqlite3_int64)run);
    const int status = sqlite3_step(store->find);
    const bool is_read =
        status == SQLITE_ROW || status == SQLITE_DONE || store_fail(store, "read", err);
    *has = status == SQLITE_ROW;
    sqlite3_reset(store->find);
    return is_read;
}

static bool delete_run(Store *store, uint64_t run, Err *err)
{
    Text sql;
    text_init(&sql);
    text_append(&sql,
                "DELETE FROM effort WHERE run = %" PRId64 "; DELETE FROM run WHERE run = %" PRId64,
                (int64_t)run, (int64_t)run);
    const bool is_gone = store_run_sql(store, sql.data, err);
    text_finish(&sql);
    return is_gone;
}

// Deletes the rows that do not match their checksums, in the open transaction.
static bool forget_damaged(Store *store, uint64_t *forgotten, Err *err)
{
    Record *record = malloc(sizeof *record);
    assert(record != NULL);
    int64_t behind = -1;
    bool is_done = store_row_prepare(store, &store->rows, err);
    for (int status = SQLITE_ROW; is_done && status == SQLITE_ROW;) {
        sqlite3_bind_int64(store->rows, 1, behind);
        sqlite3_bind_int64(store->rows, 2, -1);
        Err damage = {0};
        while ((status = sqlite3_step(store->rows)) == SQLITE_ROW &&
               store_row_take(store, store->rows, record, &damage)) {
        }
        sqlite3_reset(store->rows);
        if (status == SQLITE_ROW) {
            behind = (int64_t)record->run;
            (*forgotten)++;
            is_done = delete_run(store, record->run, err);
        } else {
            is_done = status == SQLITE_DONE || store_fail(store, "read", err);
        }
    }
    free(record);
    return is_done;
}

bool store_forget_failed(Store *store, uint64_t *forgotten, Err *err)
{
    if (!store_commit(store, err) || !store_rows_begin(store, err)) {
        return false;
    }
    // there are errors only where the study has a truth; a run without them has none
    const size_t columns = store->layout->setting_count + store->layout->result_count;
    const bool has_errors = store_column(store->layout, STORE_ERROR_COLUMN) < columns;
    *forgotten = 0;
    bool is_done = forget_damaged(store, forgotten, err) &&
                   store_run_sql(store,
                                 has_errors ? "DELETE FROM run WHERE outcome <> 0 OR "
                                              "error_max IS NULL"
                                            : "DELETE FROM run WHERE outcome <> 0",
                                 err);
    *forgotten += is_done ? (uint64_t)sqlite3_changes64(store->base) : 0;
    is_done =
        is_done &&
        store_run_sql(store, "DELETE FROM effort WHERE run NOT IN (SELECT run FROM run)", err);
    return is_done ? store_commit(store, err) : take_back(store);
}

bool store_replace(Store *store, const Record *record, Err *err)
{
    return store_rows_begin(store, err) && delete_run(store, record->run, err) &&
           store_add(store, record, err);
}
