// How is a store read whose last writer was killed in mid-write?
//
// SQLite undoes an interrupted write when it opens the file to work, from the journal next to it. A
// reader writes nothing, so that SQLite undoes it in a copy of both files, in a folder of its own
// that is gone again as soon as the copy is open. While it copies, the reader holds the lock that
// SQLite's readers hold: nobody may write to the file or undo anything in it. A journal that is at
// work then belongs to a write that has not yet reached the file, and undoing it changes nothing.
#define _GNU_SOURCE // locks of an open file

#include "commands/study/store_inside.h"

#include <errno.h>
#include <fcntl.h>
#include <sqlite3.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

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

bool store_copy_view(Store *store, const char *resolved, Err *err)
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
