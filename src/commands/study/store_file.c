// How is the file of a store opened, by one writer at a time?
//
// SQLite provides the transactions, with a rollback journal: a write-ahead log needs memory shared
// between processes, which network file systems do not have. synchronous = EXTRA also removes the
// journal from the folder on disk before a commit counts; FULL could undo the last commit after a
// power cut. At one commit a second the cost does not matter.
//
// A writer holds a lock of its own, on one byte far behind SQLite's, from opening to closing:
// SQLite's locks last for a transaction, and one that lasted longer would block readers. The lock
// belongs to the open file and not to the process, because SQLite releases all of its process's
// locks on the file after each transaction.
#include "base/claims.h"
#include "commands/study/store_inside.h"
#include "write/work_lock.h"

#include <errno.h>
#include <fcntl.h>
#include <sqlite3.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum {
    HEADER_SIZE = 100, // of an SQLite file, which the root of its schema follows
    ROOT_SIZE = 8,
    ROOT_CELLS = 3,    // behind its start: how many entries it has, on its own page
    HEADER_WRITE = 18, // 1: rollback journal; 2: write-ahead log
    HEADER_READ = 19,
    HEADER_PAGES = 28,
    HEADER_VERSION = 60,
    HEADER_APPLICATION = 68,
    WORK_BYTE = 0x40001000, // SQLite's own locks lie on 0x40000000 to 0x400001ff
    WORK_WAIT_MS = 60000,   // for readers, with any tool, to be done
    VALUE_MAX = 1 << 20,    // bytes of a row or of SQL; a row of all columns has some 10 kB
};

static const char MAGIC[16] = "SQLite format 3";

bool store_fail_damaged(const Store *store, const char *how, Err *err)
{
    return err_set(err, ERR_FILE, "the store %s is damaged: %s", store->path, how);
}

// The system's errno for an error of input or output; 0 where SQLite has none. After a failed
// commit only the file control has it.
static int system_reason(const Store *store, int code)
{
    int reason = 0;
    if ((code & 0xff) == SQLITE_IOERR || (code & 0xff) == SQLITE_CANTOPEN) {
        reason = sqlite3_system_errno(store->base);
        if (reason == 0) {
            sqlite3_file_control(store->base, "main", SQLITE_FCNTL_LAST_ERRNO, &reason);
        }
    }
    return reason;
}

bool store_fail(const Store *store, const char *what, Err *err)
{
    const int code = sqlite3_extended_errcode(store->base);
    const int reason = system_reason(store, code);
    if ((code & 0xff) == SQLITE_FULL) {
        return err_set(err, ERR_FILE, "cannot %s the store %s: %s", what, store->path,
                       strerror(ENOSPC));
    }
    switch (code & 0xff) {
    case SQLITE_BUSY:
    case SQLITE_LOCKED:
        return err_set(err, ERR_FILE, "the store %s is in use by another process", store->path);
    case SQLITE_NOTADB:
        return err_set(err, ERR_FILE, "%s is not the store of a study", store->path);
    case SQLITE_CORRUPT:
    case SQLITE_FORMAT:
        return store_fail_damaged(store, sqlite3_errmsg(store->base), err);
    case SQLITE_READONLY:
        if (code == SQLITE_READONLY_ROLLBACK) {
            return err_set(err, ERR_FILE,
                           "a write to the store %s was interrupted while it was read: read again",
                           store->path);
        }
        return err_set(err, ERR_FILE, "cannot %s the store %s: it or its folder cannot be written",
                       what, store->path);
    default:
        return err_set(err, ERR_FILE, "cannot %s the store %s: %s", what, store->path,
                       reason != 0 ? strerror(reason) : sqlite3_errmsg(store->base));
    }
}

static bool fail_system(const Store *store, const char *what, int reason, Err *err)
{
    return err_set(err, ERR_FILE, "cannot %s the store %s: %s", what, store->path,
                   strerror(reason));
}

bool store_run_sql(Store *store, const char *sql, Err *err)
{
    return sqlite3_exec(store->base, sql, NULL, NULL, NULL) == SQLITE_OK ||
           store_fail(store, "write", err);
}

bool store_prepare(Store *store, const char *sql, sqlite3_stmt **statement, Err *err)
{
    return *statement != NULL ||
           sqlite3_prepare_v2(store->base, sql, -1, statement, NULL) == SQLITE_OK ||
           store_fail(store, "read", err);
}

static uint32_t read_big_endian(const unsigned char *bytes)
{
    return (uint32_t)bytes[0] << 24 | (uint32_t)bytes[1] << 16 | (uint32_t)bytes[2] << 8 | bytes[3];
}

// Whether an SQLite file holds nothing: no application's number, and one page without a table. Such
// a file remains of a store that was to be made anew and was stopped half-way.
static bool is_blank(const unsigned char *header)
{
    const unsigned char *root = header + HEADER_SIZE;
    return memcmp(header, MAGIC, sizeof MAGIC) == 0 &&
           read_big_endian(header + HEADER_APPLICATION) == 0 &&
           read_big_endian(header + HEADER_PAGES) == 1 && root[ROOT_CELLS] == 0 &&
           root[ROOT_CELLS + 1] == 0;
}

// A file that is neither empty nor a store is left alone, before SQLite sees it. The header may be
// of the moment in mid-commit; what is asked of it never changes.
static bool check_header(const Store *store, int file, bool is_empty_right, bool is_any_version,
                         Err *err)
{
    unsigned char header[HEADER_SIZE + ROOT_SIZE];
    const ssize_t count = pread(file, header, sizeof header, 0);
    if (count < 0) {
        return fail_system(store, "read", errno, err);
    }
    if (is_empty_right && (count == 0 || (count == (ssize_t)sizeof header && is_blank(header)))) {
        return true;
    }
    if (count < HEADER_SIZE || memcmp(header, MAGIC, sizeof MAGIC) != 0 ||
        read_big_endian(header + HEADER_APPLICATION) != STORE_APPLICATION) {
        return err_set(err, ERR_FILE, "%s is not the store of a study", store->path);
    }
    if (header[HEADER_WRITE] > 1 || header[HEADER_READ] > 1) {
        return err_set(err, ERR_FILE,
                       "the store %s was set to a write-ahead log, which no store has; "
                       "'PRAGMA journal_mode = DELETE' in sqlite3 takes it back",
                       store->path);
    }
    const uint32_t version = read_big_endian(header + HEADER_VERSION);
    return version == STORE_VERSION || is_any_version ||
           err_set(err, ERR_FILE,
                   "the store %s has tables of version %u, and this program's are %d", store->path,
                   version, STORE_VERSION);
}

// Opening a pipe would wait, and a folder gets a message of its own.
static bool check_kind(const Store *store, Err *err)
{
    struct stat status;
    if (stat(store->path, &status) != 0 || S_ISREG(status.st_mode)) {
        return true;
    }
    return err_set(err, ERR_FILE, "%s is not the store of a study%s", store->path,
                   S_ISDIR(status.st_mode) ? ", but a folder" : "");
}

static bool take_lock(const Store *store, Err *err)
{
    const int reason = work_lock_take(store->lock, WORK_BYTE);
    if (reason == EAGAIN) {
        return err_set(err, ERR_FILE, "the store %s is in use by another process", store->path);
    }
    return reason == 0 || fail_system(store, "lock", reason, err);
}

bool store_file_is_at_work(const char *path)
{
    const int file = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    const bool is_at_work = work_lock_is_taken(file, WORK_BYTE);
    if (file >= 0) {
        close(file);
    }
    return is_at_work;
}

// The file may come from anyone: no SQL in its schema is run, and no number in it decides how much
// memory is allocated.
static void harden(sqlite3 *base)
{
    static const struct {
        int option;
        int value;
    } OPTIONS[] = {
        {SQLITE_DBCONFIG_DEFENSIVE, 1},      {SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0},
        {SQLITE_DBCONFIG_ENABLE_TRIGGER, 0}, {SQLITE_DBCONFIG_ENABLE_VIEW, 0},
        {SQLITE_DBCONFIG_DQS_DDL, 0},        {SQLITE_DBCONFIG_DQS_DML, 0},
        {SQLITE_DBCONFIG_ENABLE_FKEY, 0},    {SQLITE_DBCONFIG_ENABLE_LOAD_EXTENSION, 0},
    };
    for (size_t i = 0; i < sizeof OPTIONS / sizeof *OPTIONS; i++) {
        sqlite3_db_config(base, OPTIONS[i].option, OPTIONS[i].value, NULL);
    }
    sqlite3_limit(base, SQLITE_LIMIT_LENGTH, VALUE_MAX);
    sqlite3_limit(base, SQLITE_LIMIT_SQL_LENGTH, VALUE_MAX);
    sqlite3_limit(base, SQLITE_LIMIT_TRIGGER_DEPTH, 1);
}

bool store_file_connect(Store *store, const char *path, bool is_to_work, Err *err)
{
    const int flags = is_to_work ? SQLITE_OPEN_READWRITE : SQLITE_OPEN_READONLY;
    if (!store_beside_check(store, path, err)) {
        return false;
    }
    if (sqlite3_open_v2(path, &store->base, flags | SQLITE_OPEN_NOMUTEX, NULL) != SQLITE_OK) {
        return store_fail(store, "open", err);
    }
    sqlite3_extended_result_codes(store->base, 1);
    sqlite3_busy_timeout(store->base, is_to_work ? WORK_WAIT_MS : STORE_VIEW_WAIT_MS);
    harden(store->base);
    return store_run_sql(store, "PRAGMA cell_size_check = ON", err);
}

// By the path with all links resolved, as SQLite resolves it: the files next to it are checked by
// that path, too. It begins with a slash, so that it is not a special name such as ":memory:".
static bool open_to_work(Store *store, Err *err)
{
    char *path = realpath(store->path, NULL);
    const bool is_open = path != NULL ? store_file_connect(store, path, true, err)
                                      : fail_system(store, "open", errno, err);
    free(path);
    return is_open;
}

// SQLite reads and writes nothing; where that would not do, because the last write was interrupted,
// it says so at the first read.
static bool open_to_view(Store *store, Err *err)
{
    char *path = realpath(store->path, NULL);
    bool is_open = path != NULL ? store_file_connect(store, path, false, err)
                                : fail_system(store, "open", errno, err);
    if (is_open && sqlite3_exec(store->base, "PRAGMA schema_version", NULL, NULL, NULL) ==
                       SQLITE_READONLY_ROLLBACK) {
        sqlite3_close(store->base);
        store->base = NULL;
        is_open = store_copy_view(store, path, err);
    }
    free(path);
    return is_open;
}

// Empties the file, damaged or not, in one transaction. It must be the first use of SQLite on the
// file, because any other reads the tables.
static bool reset(Store *store, Err *err)
{
    sqlite3_db_config(store->base, SQLITE_DBCONFIG_RESET_DATABASE, 1, NULL);
    const bool is_done = store_run_sql(store, "VACUUM", err);
    sqlite3_db_config(store->base, SQLITE_DBCONFIG_RESET_DATABASE, 0, NULL);
    return is_done;
}

// Another process may lock the file between its creation and our lock, and write to it.
static bool claim(Store *store, bool is_made, Err *err)
{
    struct stat status;
    if (!take_lock(store, err)) {
        return false;
    }
    if (fstat(store->lock, &status) != 0) {
        return fail_system(store, "open", errno, err);
    }
    // the process that had the lock may have deleted the file
    if (status.st_nlink == 0) {
        return err_set(err, ERR_FILE, "the store %s is in use by another process", store->path);
    }
    store->is_made = is_made && status.st_size == 0;
    return true;
}

bool store_file_open(Store *store, bool is_fresh, Err *err)
{
    if (!check_kind(store, err)) {
        return false;
    }
    store->lock = open(store->path, O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    const bool is_made = store->lock >= 0;
    if (!is_made && errno == EEXIST) {
        store->lock = open(store->path, O_RDWR | O_CLOEXEC);
    }
    if (store->lock < 0) {
        return fail_system(store, "open", errno, err);
    }
    return claim(store, is_made, err) && check_header(store, store->lock, true, is_fresh, err) &&
           open_to_work(store, err) && (!is_fresh || reset(store, err)) &&
           store_run_sql(store, "PRAGMA journal_mode = DELETE; PRAGMA synchronous = EXTRA", err);
}

bool store_file_view(Store *store, Err *err)
{
    if (!check_kind(store, err)) {
        return false;
    }
    const int file = open(store->path, O_RDONLY | O_CLOEXEC);
    if (file < 0) {
        return fail_system(store, "open", errno, err);
    }
    claims_note_read("store", store->path);
    const bool is_store = check_header(store, file, false, false, err);
    close(file);
    return is_store && open_to_view(store, err);
}

void store_file_close(Store *store)
{
    // before the file of the lock, because closing that ends all locks of SQLite on it
    sqlite3_close(store->base);
    store->base = NULL;
    if (store->lock >= 0) {
        work_lock_give(store->lock, WORK_BYTE);
        close(store->lock);
        store->lock = -1;
    }
}

bool store_step(Store *store, sqlite3_stmt **statement, bool *is_good, Err *err)
{
    const int status = *is_good ? sqlite3_step(*statement) : SQLITE_DONE;
    if (status == SQLITE_ROW) {
        return true;
    }
    *is_good = *is_good && (status == SQLITE_DONE || store_fail(store, "read", err));
    sqlite3_finalize(*statement);
    *statement = NULL;
    return false;
}

bool store_file_check(Store *store, Err *err)
{
    sqlite3_stmt *row = NULL;
    bool is_whole = store_prepare(store, "PRAGMA quick_check(1)", &row, err);
    while (store_step(store, &row, &is_whole, err)) {
        const char *words = (const char *)sqlite3_column_text(row, 0);
        const char *line = words == NULL ? NULL : strrchr(words, '\n');
        is_whole = (words != NULL && strcmp(words, "ok") == 0) ||
                   store_fail_damaged(store,
                                      line != NULL    ? line + 1
                                      : words != NULL ? words
                                                      : "",
                                      err);
    }
    return is_whole;
}
