// Which files next to a store would make SQLite write or delete a file that is not the store's?
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
#include "commands/study/store_inside.h"

#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { MAGIC_SIZE = 8 };

// The first bytes of a journal, and the last ones of the name of a super-journal.
static const unsigned char MAGIC[MAGIC_SIZE] = {0xd9, 0xd5, 0x05, 0xf9, 0x20, 0xa1, 0x63, 0xd7};
// Those of a journal that is not in use.
static const unsigned char NOTHING[MAGIC_SIZE] = {0};

static bool refuse(const Store *store, const char *beside, const char *why, Err *err)
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
        (memcmp(first, MAGIC, MAGIC_SIZE) != 0 && memcmp(first, NOTHING, MAGIC_SIZE) != 0)) {
        return "is not its journal, and would be deleted as one";
    }
    if (size > MAGIC_SIZE && (pread(journal, last, MAGIC_SIZE, size - MAGIC_SIZE) != MAGIC_SIZE ||
                              memcmp(last, MAGIC, MAGIC_SIZE) == 0)) {
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
               refuse(store, path, errno == ELOOP ? "is a link" : "cannot be read", err);
    }
    const char *fault = "is not a file of a single name";
    if (fstat(journal, &status) == 0 && S_ISREG(status.st_mode) && status.st_nlink <= 1) {
        fault = status.st_nlink == 0 ? NULL : find_fault(journal, status.st_size);
    }
    // a journal that has been deleted since is none
    struct stat later;
    const bool is_wrong = fault != NULL && (fstat(journal, &later) != 0 || later.st_nlink != 0);
    close(journal);
    return !is_wrong || refuse(store, path, fault, err);
}

bool store_beside_check(const Store *store, const char *resolved, Err *err)
{
    struct stat status;
    Text path;
    text_init(&path);
    text_append(&path, "%s-wal", resolved);
    bool is_right = lstat(path.data, &status) != 0 ||
                    refuse(store, path.data, "is a write-ahead log, which no store has", err);
    text_finish(&path);
    text_init(&path);
    text_append(&path, "%s-journal", resolved);
    is_right = is_right && check_journal(store, path.data, err);
    text_finish(&path);
    return is_right;
}
