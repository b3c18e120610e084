// Which study and program do the rows of a store belong to?
//
// The table `study` has the key, `runs`, and `checksum`: of this table and of the columns of `run`.
#include "base/hash.h"
#include "commands/study/store_inside.h"

#include <assert.h>
#include <inttypes.h>
#include <sqlite3.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

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

static void make_checksum(const StoreHead *head, char words[STORE_WORDS_SIZE])
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
static bool check_names(const Layout *layout, Err *err)
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

static bool add_value(Store *store, sqlite3_stmt *statement, const char *name, const char *value,
                      const char *words, Err *err)
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
        is_added = add_value(store, statement, key->name, key->value, key->words, err);
    }
    char runs[STORE_WORDS_SIZE];
    char checksum[STORE_WORDS_SIZE];
    snprintf(runs, sizeof runs, COUNT_FORMAT, head->run_count);
    make_checksum(head, checksum);
    is_added = is_added && add_value(store, statement, RUNS, runs, NULL, err) &&
               add_value(store, statement, CHECKSUM, checksum, NULL, err);
    sqlite3_finalize(statement);
    return is_added;
}

bool store_schema_make(Store *store, const StoreHead *head, Err *err)
{
    if (!check_names(head->layout, err)) {
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
    make_checksum(&head, checksum);
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
