// What the files of the store share; no other file includes this.
#pragma once

#include "base/text.h"
#include "commands/study/store.h"

struct sqlite3;
struct sqlite3_stmt;

enum {
    STORE_VERSION = 3,              // of the tables; stands in the file as user_version
    STORE_APPLICATION = 0x4a505354, // "JPST"; stands in the file as application_id
    STORE_WORDS_SIZE = 256,
    STORE_VIEW_WAIT_MS = 10000, // for a commit to end, which takes some 10
};

// The first of the columns of a run's error, see metrics.c.
static const char STORE_ERROR_COLUMN[] = "error_max";

struct Store {
    struct sqlite3 *base;
    struct sqlite3_stmt *add_run; // prepared when first needed, as are the next three
    struct sqlite3_stmt *add_effort;
    struct sqlite3_stmt *find;
    struct sqlite3_stmt *rows;
    char *path;       // owned, as given
    int lock;         // file that holds the lock of the process that writes; -1: none
    bool is_made;     // this opening created the file: no other process has written to it
    bool is_changing; // a transaction is open
    bool is_verified; // every row that was there at the first question matches its checksum
    Layout *layout;   // owned
    uint64_t run_count;
    size_t key_count;
    StoreKey keys[STORE_KEY_MAX]; // their words are owned
};

// Opening (store_file.c)

// Opens the store that others are merged into, as store_open; `source` is the first of them.
Store *store_open_target(const char *path, const StoreHead *head, const char *source, Err *err);

// The file (store_file.c)

// Sets the error of SQLite's last failure, in our own words for what a user can act on. `what` is
// what was tried: "read" or "write". Always false.
bool store_fail(const Store *store, const char *what, Err *err);
bool store_fail_damaged(const Store *store, const char *how, Err *err);

// Opens it for reading: no file is written or deleted, and what an interrupted write has changed is
// read as it was before.
bool store_file_view(Store *store, Err *err);

// Closes the file and releases its lock.
void store_file_close(Store *store);

// Checks the structure of the whole file. The contents of rows are checked by their checksums.
bool store_file_check(Store *store, Err *err);

// Whether another process writes to the store of that path. Not for a store that this process has
// open: closing the file would end SQLite's locks on it.
bool store_file_is_at_work(const char *path);

// Runs and prepares SQL.
bool store_run_sql(Store *store, const char *sql, Err *err);
bool store_prepare(Store *store, const char *sql, struct sqlite3_stmt **statement, Err *err);

// Goes to the next row of a query. False behind the last, on failure, and where `*is_good` was
// false already, which it is then; the statement is finished.
bool store_step(Store *store, struct sqlite3_stmt **statement, bool *is_good, Err *err);

// What stands beside the file

// Reading what an interrupted write has left

// The tables (store_rows.c)

// Whether there is anything in the schema of the file.
bool store_shape_is_there(Store *store, bool *is_there, Err *err);

// Appends the name of a column as SQL writes it.
void store_shape_quote(Text *sql, const char *name);

// The text of a value, cut to so many bytes, or a copy of it; empty for NULL.
void store_take_words(struct sqlite3_stmt *row, int column, char *words, size_t size);

// Whose rows they are

// Makes the tables, or reads what they are.
bool store_schema_make(Store *store, const StoreHead *head, Err *err);
bool store_schema_read(Store *store, Err *err);

// What a store holds, borrowed from it.
StoreHead store_schema_head(const Store *store);

// Whether the store is of the study that is asked for, by itself (NULL) or by a store that it is
// merged with. Fails with ERR_FILE, saying what differs.
bool store_schema_check(const Store *store, const StoreHead *head, const char *source, Err *err);

void store_schema_finish(Store *store);

// The rows

// The statement that reads rows by rising number: parameter 1 is the number before the first, 2 the
// most that are wanted (-1: all).
bool store_row_prepare(Store *store, struct sqlite3_stmt **statement, Err *err);

// Reads the current row of the statement. Fails with ERR_FILE where it does not match its checksum.
bool store_row_take(const Store *store, struct sqlite3_stmt *statement, Record *record, Err *err);

// Whether two rows are the same in all but their effort.
bool store_row_is_same(const Layout *layout, const Record *a, const Record *b);

// Adding and deleting them

// Replaces the row of a run, in the transaction that store_commit ends.
bool store_replace(Store *store, const Record *record, Err *err);
