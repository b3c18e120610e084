// Opens the file of a store: one writer at a time, complete after a crash, and no other file
// touched.
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
#define _GNU_SOURCE // locks of an open file

#include "base/claims.h"
#include "commands/study/store_inside.h"
#include "write/file.h"

#include <assert.h>
#include <errno.h>
#include <fcntl.h>
#include <sqlite3.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static bool store_file_connect(Store *store, const char *path, bool is_to_work, Err *err);

// The files next to a store that would make SQLite write or delete a file that is not the store's.
//
// SQLite finds its files by name and obeys their contents. A journal may end with the name of
// a super-journal, that of a transaction over several databases, which SQLite deletes when nothing
// refers to it any more, whatever file it is:
//
//     ... | name | length of the name: 4 | sum of its bytes: 4 | magic: 8
//
// A journal that is a link redirects writes. A write-ahead log is merged into the database whether
// the database uses one or not. A store of ours never has such a file next to it: whoever sent one
// may mean harm.

enum { MAGIC_SIZE = 8 };

// The first bytes of a journal, and the last ones of the name of a super-journal.
static const unsigned char STORE_BESIDE_MAGIC[MAGIC_SIZE] = {0xd9, 0xd5, 0x05, 0xf9,
                                                             0x20, 0xa1, 0x63, 0xd7};
// Those of a journal that is not in use.
static const unsigned char NOTHING[MAGIC_SIZE] = {0};

static bool store_file_refuse(const Store *store, const char *beside, const char *why, Err *err)
{
    return err_set(err, ERR_FILE,
                   "the store %s is not opened: the file %s next to it %s; move it away",
                   store->path, beside, why);
}

// What is wrong with a journal of that size; NULL where it can only change the store.
static const char *find_fault(int journal, off_t size)
{
    unsigned char first[MAGIC_SIZE];
    unsigned char last[MAGIC_SIZE];
    if (size == 0) {
        return NULL;
    }
    if (size < MAGIC_SIZE || pread(journal, first, MAGIC_SIZE, 0) != MAGIC_SIZE ||
        (memcmp(first, STORE_BESIDE_MAGIC, MAGIC_SIZE) != 0 &&
         memcmp(first, NOTHING, MAGIC_SIZE) != 0)) {
        return "is not its journal, and would be deleted as one";
    }
    if (size > MAGIC_SIZE && (pread(journal, last, MAGIC_SIZE, size - MAGIC_SIZE) != MAGIC_SIZE ||
                              memcmp(last, STORE_BESIDE_MAGIC, MAGIC_SIZE) == 0)) {
        return "names another file that would be deleted (a super-journal)";
    }
    return NULL;
}

static bool check_journal(const Store *store, const char *path, Err *err)
{
    struct stat status;
    const int journal = open(path, O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
    if (journal < 0) {
        // a journal may end while a store in use is read
        return errno == ENOENT ||
               store_file_refuse(store, path, errno == ELOOP ? "is a link" : "cannot be read", err);
    }
    const char *fault = "is not a file of a single name";
    if (fstat(journal, &status) == 0 && S_ISREG(status.st_mode) && status.st_nlink <= 1) {
        fault = status.st_nlink == 0 ? NULL : find_fault(journal, status.st_size);
    }
    // a journal that has been deleted since is none
    struct stat later;
    const bool is_wrong = fault != NULL && (fstat(journal, &later) != 0 || later.st_nlink != 0);
    close(journal);
    return !is_wrong || store_file_refuse(store, path, fault, err);
}

// Refuses files that would make SQLite write or delete another file than the store and its journal.
// Call it before SQLite opens the file of that resolved path.
static bool store_beside_check(const Store *store, const char *resolved, Err *err)
{
    struct stat status;
    Text path;
    text_init(&path);
    text_append(&path, "%s-wal", resolved);
    bool is_right =
        lstat(path.data, &status) != 0 ||
        store_file_refuse(store, path.data, "is a write-ahead log, which no store has", err);
    text_finish(&path);
    text_init(&path);
    text_append(&path, "%s-journal", resolved);
    is_right = is_right && check_journal(store, path.data, err);
    text_finish(&path);
    return is_right;
}

// Reads a store whose last writer was killed in mid-write.
//
// SQLite undoes an interrupted write when it opens the file to work, from the journal next to it. A
// reader writes nothing, so that SQLite undoes it in a copy of both files, in a folder of its own
// that is gone again as soon as the copy is open. While it copies, the reader holds the lock that
// SQLite's readers hold: nobody may write to the file or undo anything in it. A journal that is at
// work then belongs to a write that has not yet reached the file, and undoing it changes nothing.

enum {
    SHARED_FIRST = 0x40000002, // SQLite's lock of readers (sqlite.org/lockingv3.html)
    SHARED_SIZE = 510,
    LOCK_WAIT_US = 10000,
    BLOCK_SIZE = 1 << 16,
};

// The copy of a store: its folder and files.
typedef struct Copy {
    Text folder;
    Text file;
    Text journal;
    off_t size; // bytes of both
} Copy;

static bool fail_copy(const Store *store, const Copy *copy, int reason, Err *err)
{
    return err_set(err, ERR_FILE,
                   "the last write to the store %s was interrupted, and it cannot be copied to %s "
                   "(TMPDIR) to be read as it was before: %s",
                   store->path, copy->folder.data, strerror(reason));
}

// Takes the lock of readers; closing the file gives it up. Returns 0 or an errno.
static int lock_shared(int file)
{
    struct flock lock = {
        .l_type = F_RDLCK, .l_whence = SEEK_SET, .l_start = SHARED_FIRST, .l_len = SHARED_SIZE};
    for (int waited_us = 0; fcntl(file, F_OFD_SETLK, &lock) != 0; waited_us += LOCK_WAIT_US) {
        if ((errno != EACCES && errno != EAGAIN) || waited_us >= STORE_VIEW_WAIT_MS * 1000) {
            return errno;
        }
        usleep(LOCK_WAIT_US);
    }
    return 0;
}

// Writes all of one open file into another. Returns 0 or an errno.
static int pour(int from, int to, off_t *size)
{
    char block[BLOCK_SIZE];
    ssize_t count;
    while ((count = read(from, block, sizeof block)) > 0) {
        if (write(to, block, (size_t)count) != count) {
            return errno != 0 ? errno : ENOSPC;
        }
        *size += count;
    }
    return count < 0 ? errno : 0;
}

// Copies an open file to a new one. Returns 0 or an errno.
static int copy_open_file(int from, const char *path, off_t *size)
{
    const int to = open(path, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
    if (to < 0) {
        return errno;
    }
    errno = 0;
    const int reason = pour(from, to, size);
    const bool is_closed = close(to) == 0;
    return reason != 0 || is_closed ? reason : errno;
}

// Copies the journal of that path, if there still is one. Returns 0 or an errno.
static int copy_journal(const char *path, Copy *copy)
{
    const int journal = open(path, O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
    if (journal < 0) {
        return errno == ENOENT ? 0 : errno;
    }
    const int reason = copy_open_file(journal, copy->journal.data, &copy->size);
    close(journal);
    return reason;
}

// Copies the store of that path and its journal under the lock. Returns 0 or an errno.
static int copy_files(const char *path, Copy *copy)
{
    const int file = open(path, O_RDONLY | O_CLOEXEC);
    if (file < 0) {
        return errno;
    }
    Text journal;
    text_init(&journal);
    text_append(&journal, "%s-journal", path);
    int reason = lock_shared(file);
    if (reason == 0) {
        reason = copy_open_file(file, copy->file.data, &copy->size);
    }
    if (reason == 0) {
        reason = copy_journal(journal.data, copy);
    }
    text_finish(&journal);
    close(file);
    return reason;
}

static bool make_folder(Copy *copy)
{
    const char *parent = getenv("TMPDIR");
    text_append(&copy->folder, "%s/jointplay-store-XXXXXX",
                parent != NULL && parent[0] != '\0' ? parent : "/tmp");
    if (mkdtemp(copy->folder.data) == NULL) {
        return false;
    }
    text_append(&copy->file, "%s/store", copy->folder.data);
    text_append(&copy->journal, "%s-journal", copy->file.data);
    return true;
}

// Has SQLite undo the write in the copy, which is not worth waiting for a disk.
static bool undo(Store *store, const Copy *copy, Err *err)
{
    struct stat status;
    if (sqlite3_exec(store->base, "PRAGMA synchronous = OFF; PRAGMA schema_version", NULL, NULL,
                     NULL) != SQLITE_OK) {
        return store_fail(store, "read", err);
    }
    // no page may be missing: those that the file had lost were in the journal
    if (stat(copy->file.data, &status) != 0 || status.st_size > copy->size) {
        return store_fail_damaged(store, "its journal is that of a larger file", err);
    }
    return store_run_sql(store, "PRAGMA query_only = ON", err);
}

static void delete_files(const Copy *copy)
{
    unlink(copy->file.data);
    unlink(copy->journal.data);
    rmdir(copy->folder.data);
}

// Opens a copy of the store of that resolved path, in which the interrupted write is undone.
static bool store_copy_view(Store *store, const char *resolved, Err *err)
{
    Copy copy = {.size = 0};
    text_init(&copy.folder);
    text_init(&copy.file);
    text_init(&copy.journal);
    bool is_right = make_folder(&copy) || fail_copy(store, &copy, errno, err);
    if (is_right) {
        const int reason = copy_files(resolved, &copy);
        is_right = (reason == 0 || fail_copy(store, &copy, reason, err)) &&
                   store_file_connect(store, copy.file.data, true, err) && undo(store, &copy, err);
        // SQLite reads on in the file that it has open
        delete_files(&copy);
    }
    text_finish(&copy.folder);
    text_finish(&copy.file);
    text_finish(&copy.journal);
    return is_right;
}

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

static const char STORE_FILE_MAGIC[16] = "SQLite format 3";

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
    return memcmp(header, STORE_FILE_MAGIC, sizeof STORE_FILE_MAGIC) == 0 &&
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
    if (count < HEADER_SIZE || memcmp(header, STORE_FILE_MAGIC, sizeof STORE_FILE_MAGIC) != 0 ||
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
static bool store_file_check_kind(const Store *store, Err *err)
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

// Has SQLite open the file of that path, to work on it or to read it, after a look at what stands
// beside it.
static bool store_file_connect(Store *store, const char *path, bool is_to_work, Err *err)
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
static bool store_file_open_to_work(Store *store, Err *err)
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

// Opens the file of a store whose path is set, for writing: locked against other writers, created
// where there is none, refused where it is some other file. With `is_fresh` it may be of any
// version or damaged, and is emptied.
static bool store_file_open(Store *store, bool is_fresh, Err *err)
{
    if (!store_file_check_kind(store, err)) {
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
           store_file_open_to_work(store, err) && (!is_fresh || reset(store, err)) &&
           store_run_sql(store, "PRAGMA journal_mode = DELETE; PRAGMA synchronous = EXTRA", err);
}

bool store_file_view(Store *store, Err *err)
{
    if (!store_file_check_kind(store, err)) {
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

// Opens a store for reading or writing.

static Store *make_store(const char *path)
{
    Store *store = calloc(1, sizeof *store);
    assert(store != NULL);
    store->lock = -1;
    store->path = strdup(path);
    assert(store->path != NULL);
    return store;
}

static void destroy(Store *store)
{
    sqlite3_finalize(store->add_run);
    sqlite3_finalize(store->add_effort);
    sqlite3_finalize(store->find);
    sqlite3_finalize(store->rows);
    store_file_close(store);
    store_schema_finish(store);
    free(store->path);
    free(store);
}

// Creates the tables where there are none, and compares those that exist with what is expected.
static bool store_file_settle(Store *store, const StoreHead *head, const char *source, Err *err)
{
    bool is_there = false;
    if (!store_shape_is_there(store, &is_there, err) ||
        (!is_there && !store_schema_make(store, head, err))) {
        return false;
    }
    return store_schema_read(store, err) && store_schema_check(store, head, source, err) &&
           (!is_there || store_file_check(store, err));
}

static Store *store_open_open_to_work(const char *path, const StoreHead *head, bool is_fresh,
                                      const char *source, Err *err)
{
    assert(head->key_count <= STORE_KEY_MAX);
    Store *store = make_store(path);
    if (store_file_open(store, is_fresh, err) && store_file_settle(store, head, source, err)) {
        return store;
    }
    // a file that was not there before and did not become a store is deleted
    if (store->is_made) {
        unlink(path);
    }
    destroy(store);
    return NULL;
}

Store *store_open(const char *path, const StoreHead *head, bool is_fresh, Err *err)
{
    return store_open_open_to_work(path, head, is_fresh, NULL, err);
}

Store *store_open_target(const char *path, const StoreHead *head, const char *source, Err *err)
{
    return store_open_open_to_work(path, head, false, source, err);
}

Store *store_view(const char *path, Err *err)
{
    Store *store = make_store(path);
    if (store_file_view(store, err) && store_schema_read(store, err)) {
        return store;
    }
    destroy(store);
    return NULL;
}

bool store_close(Store *store, Err *err)
{
    if (store == NULL) {
        return true;
    }
    const bool is_committed = store_commit(store, err);
    destroy(store);
    return is_committed;
}

const Layout *store_layout(const Store *store)
{
    return store->layout;
}

const char *store_key(const Store *store, const char *name)
{
    for (size_t i = 0; i < store->key_count; i++) {
        if (strcmp(store->keys[i].name, name) == 0) {
            return store->keys[i].value;
        }
    }
    return NULL;
}
