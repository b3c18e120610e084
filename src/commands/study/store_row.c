// How does a run become a row, and the row the run again, bit for bit?
//
// SQLite has no checksums: a bit that turned on the disk would be another number. So each row
// carries one of its own over all that is written, 32 bits of it. NAN is NULL. The sign of a zero
// is lost: a REAL without a fraction is kept as a whole number, which also makes it short.
#include "base/hash.h"
#include "commands/study/store_inside.h"

#include <assert.h>
#include <inttypes.h>
#include <math.h>
#include <sqlite3.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// Whole numbers of this size and below have a double of their own.
static const double WHOLE_MAX = 9007199254740992.0; // 2^53

static uint64_t hash_value(uint64_t hash, double value)
{
    // one NAN and one zero of each kind; the sum makes a zero positive
    return hash_number(hash, isnan(value) ? (double)NAN : value + 0.0);
}

static int32_t make_checksum(const Layout *layout, const Record *record)
{
    uint64_t hash = hash_number(HASH_START, (double)record->run);
    hash = hash_number(hash, record->fate);
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

static int32_t make_effort_checksum(uint64_t run, double wall_s)
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
    bool is_same = a->run == b->run && a->fate == b->fate && a->hash == b->hash &&
                   strcmp(a->reason, b->reason) == 0;
    for (size_t i = 0; i < layout->setting_count && is_same; i++) {
        is_same = layout->settings[i].kind == COLUMN_WORD
                      ? strcmp(a->settings[i].word, b->settings[i].word) == 0
                      : is_same_number(a->settings[i].number, b->settings[i].number);
    }
    for (size_t i = 0; i < layout->result_count && is_same; i++) {
        is_same = is_same_number(a->results[i], b->results[i]);
    }
    return is_same;
}

static void bind_number(sqlite3_stmt *statement, int place, double value, ColumnKind kind)
{
    if (kind == COLUMN_WHOLE && fabs(value) <= WHOLE_MAX && value == rint(value)) {
        sqlite3_bind_int64(statement, place, (sqlite3_int64)value);
    } else {
        sqlite3_bind_double(statement, place, value);
    }
}

static void bind_record(const Store *store, sqlite3_stmt *statement, const Record *record)
{
    const Layout *layout = store->layout;
    int place = 1;
    sqlite3_bind_int64(statement, place++, (sqlite3_int64)record->run);
    for (size_t i = 0; i < layout->setting_count; i++) {
        if (layout->settings[i].kind == COLUMN_WORD) {
            sqlite3_bind_text(statement, place++, record->settings[i].word, -1, SQLITE_STATIC);
        } else {
            bind_number(statement, place++, record->settings[i].number, layout->settings[i].kind);
        }
    }
    sqlite3_bind_int(statement, place++, (int)record->fate);
    sqlite3_bind_text(statement, place++, record->reason[0] == '\0' ? NULL : record->reason, -1,
                      SQLITE_STATIC);
    for (size_t i = 0; i < layout->result_count; i++) {
        bind_number(statement, place++, record->results[i], layout->results[i].kind);
    }
    sqlite3_bind_int64(statement, place++, (sqlite3_int64)record->hash);
    sqlite3_bind_int(statement, place++, make_checksum(layout, record));
}

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

static bool begin(Store *store, Err *err)
{
    store->is_changing = store->is_changing || store_run_sql(store, "BEGIN IMMEDIATE", err);
    return store->is_changing;
}

bool store_add(Store *store, const Record *record, Err *err)
{
    if (!prepare_adding(store, err) || !begin(store, err)) {
        return false;
    }
    bind_record(store, store->add_run, record);
    if (!step_to_end(store, store->add_run, record->run, err)) {
        return take_back(store);
    }
    sqlite3_bind_int64(store->add_effort, 1, (sqlite3_int64)record->run);
    sqlite3_bind_double(store->add_effort, 2, record->wall_s);
    sqlite3_bind_int(store->add_effort, 3, make_effort_checksum(record->run, record->wall_s));
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

// Deletes the rows that are not what was once written, in the transaction that is open.
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
    return is_done &&
           store_run_sql(store, "DELETE FROM effort WHERE run NOT IN (SELECT run FROM run)", err);
}

bool store_forget_failed(Store *store, uint64_t *forgotten, Err *err)
{
    if (!store_commit(store, err) || !begin(store, err)) {
        return false;
    }
    // there are errors only where the study has a truth; a run without them has missed it
    const size_t columns = store->layout->setting_count + store->layout->result_count;
    const bool has_errors = store_column(store->layout, STORE_ERROR_COLUMN) < columns;
    *forgotten = 0;
    const bool is_done =
        forget_damaged(store, forgotten, err) &&
        store_run_sql(store,
                      has_errors ? "DELETE FROM effort WHERE run IN "
                                   "(SELECT run FROM run WHERE fate <> 0 OR "
                                   "error_omega_max IS NULL); "
                                   "DELETE FROM run WHERE fate <> 0 OR error_omega_max IS NULL"
                                 : "DELETE FROM effort WHERE run IN "
                                   "(SELECT run FROM run WHERE fate <> 0); "
                                   "DELETE FROM run WHERE fate <> 0",
                      err);
    *forgotten += is_done ? (uint64_t)sqlite3_changes64(store->base) : 0;
    return is_done ? store_commit(store, err) : take_back(store);
}

bool store_replace(Store *store, const Record *record, Err *err)
{
    return begin(store, err) && delete_run(store, record->run, err) &&
           store_add(store, record, err);
}

bool store_row_prepare(Store *store, sqlite3_stmt **statement, Err *err)
{
    return store_prepare(store,
                         "SELECT run.*, effort.wall_s, effort.checksum FROM run LEFT JOIN effort "
                         "USING (run) WHERE run.run > ? ORDER BY run.run LIMIT ?",
                         statement, err);
}

static double column_number(sqlite3_stmt *statement, int place)
{
    return sqlite3_column_type(statement, place) == SQLITE_NULL
               ? NAN
               : sqlite3_column_double(statement, place);
}

static void column_words(sqlite3_stmt *statement, int place, char *words, size_t size)
{
    const char *text = (const char *)sqlite3_column_text(statement, place);
    text_copy(words, size, text == NULL ? "" : text);
}

bool store_row_take(const Store *store, sqlite3_stmt *statement, Record *record, Err *err)
{
    const Layout *layout = store->layout;
    int place = 0;
    record->run = (uint64_t)sqlite3_column_int64(statement, place++);
    for (size_t i = 0; i < layout->setting_count; i++, place++) {
        Cell *cell = &record->settings[i];
        if (layout->settings[i].kind == COLUMN_WORD) {
            column_words(statement, place, cell->word, sizeof cell->word);
        } else {
            cell->number = column_number(statement, place);
        }
    }
    const int fate = sqlite3_column_int(statement, place++);
    record->fate = (Fate)fate;
    column_words(statement, place++, record->reason, sizeof record->reason);
    for (size_t i = 0; i < layout->result_count; i++) {
        record->results[i] = column_number(statement, place++);
    }
    record->hash = (uint64_t)sqlite3_column_int64(statement, place++);
    const sqlite3_int64 checksum = sqlite3_column_int64(statement, place++);
    record->wall_s = column_number(statement, place++);
    const bool is_effort =
        sqlite3_column_type(statement, place) != SQLITE_NULL &&
        sqlite3_column_int64(statement, place) == make_effort_checksum(record->run, record->wall_s);
    if (fate >= 0 && fate < FATE_COUNT && is_effort && checksum == make_checksum(layout, record)) {
        return true;
    }
    char words[STORE_WORDS_SIZE];
    snprintf(words, sizeof words,
             "run %" PRIu64 " is not what was once written; 'jointplay study FILE --retry-failed' "
             "makes it again",
             record->run);
    return store_fail_damaged(store, words, err);
}
