// How are rows added to a store, and deleted so that they are made again?
//
// A row is written whole, together with its effort, in a transaction that store_commit ends.
#include "commands/study/store_inside.h"

#include <assert.h>
#include <inttypes.h>
#include <sqlite3.h>
#include <stdlib.h>

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
    if (!store_commit(store, err) || !begin(store, err)) {
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
    return begin(store, err) && delete_run(store, record->run, err) &&
           store_add(store, record, err);
}
