// How does SQLite read a store without being able to write anything at all?
//
// It reaches files through our own VFS, which passes reads to the system's VFS and refuses writes
// and deletions. The VFS hides the journal: what an interrupted write has changed is read as it was
// before, see store_undo.c. The journal is read anew whenever SQLite begins to read; its shared
// lock then keeps the file unchanged.
#include "commands/study/store_inside.h"
#include "commands/study/store_undo.h"

#include <assert.h>
#include <sqlite3.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const char NAME[] = "jointplay-readonly";

// The file of a store; the system's own follows in the same memory.
typedef struct ReadonlyFile {
    sqlite3_file base;
    sqlite3_file *real;
    char *journal; // path; owned
    int level;     // of the lock
    Undo undo;
} ReadonlyFile;

static sqlite3_vfs *system_of(sqlite3_vfs *vfs)
{
    return vfs->pAppData;
}

static int readonly_close(sqlite3_file *base)
{
    ReadonlyFile *file = (ReadonlyFile *)base;
    undo_finish(&file->undo);
    free(file->journal);
    return file->real->pMethods->xClose(file->real);
}

// A part of a page as it was. Beyond the former end it is zero.
static int read_former(ReadonlyFile *file, void *target, int amount, sqlite3_int64 offset)
{
    const Undo *undo = &file->undo;
    const sqlite3_int64 size = undo->page_size;
    if (offset % size + amount > size) {
        return SQLITE_IOERR_READ;
    }
    if (offset / size >= undo->page_count) {
        memset(target, 0, (size_t)amount);
        return SQLITE_IOERR_SHORT_READ;
    }
    const off_t former = undo_find(undo, (uint32_t)(offset / size + 1));
    if (former < 0) {
        return file->real->pMethods->xRead(file->real, target, amount, offset);
    }
    return pread(undo->journal, target, (size_t)amount, former + offset % size) == amount
               ? SQLITE_OK
               : SQLITE_IOERR_READ;
}

static int readonly_read(sqlite3_file *base, void *target, int amount, sqlite3_int64 offset)
{
    ReadonlyFile *file = (ReadonlyFile *)base;
    return file->undo.is_needed ? read_former(file, target, amount, offset)
                                : file->real->pMethods->xRead(file->real, target, amount, offset);
}

static int readonly_write(sqlite3_file *base, const void *source, int amount, sqlite3_int64 offset)
{
    (void)base;
    (void)source;
    (void)amount;
    (void)offset;
    return SQLITE_READONLY;
}

static int readonly_truncate(sqlite3_file *base, sqlite3_int64 size)
{
    (void)base;
    (void)size;
    return SQLITE_READONLY;
}

static int readonly_sync(sqlite3_file *base, int flags)
{
    (void)base;
    (void)flags;
    return SQLITE_OK;
}

static int readonly_size(sqlite3_file *base, sqlite3_int64 *size)
{
    ReadonlyFile *file = (ReadonlyFile *)base;
    if (file->undo.is_needed) {
        *size = (sqlite3_int64)file->undo.page_size * file->undo.page_count;
        return SQLITE_OK;
    }
    return file->real->pMethods->xFileSize(file->real, size);
}

// Under the shared lock: a journal that no process is using belongs to an interrupted write.
static int find_former(ReadonlyFile *file)
{
    int is_at_work = 0;
    const int status = file->real->pMethods->xCheckReservedLock(file->real, &is_at_work);
    if (status != SQLITE_OK || is_at_work) {
        return status;
    }
    sqlite3_int64 size = 0;
    if (!undo_read(&file->undo, file->journal)) {
        return SQLITE_CANTOPEN;
    }
    // no page may be missing: those that the file has lost are in the journal
    const sqlite3_int64 former = (sqlite3_int64)file->undo.page_size * file->undo.page_count;
    const int is_sized = file->real->pMethods->xFileSize(file->real, &size);
    const bool is_right = !file->undo.is_needed || former <= size + file->undo.journal_size;
    return is_sized == SQLITE_OK && !is_right ? SQLITE_CORRUPT : is_sized;
}

static int readonly_lock(sqlite3_file *base, int level)
{
    ReadonlyFile *file = (ReadonlyFile *)base;
    if (level > SQLITE_LOCK_SHARED) {
        return SQLITE_READONLY;
    }
    int status = file->real->pMethods->xLock(file->real, level);
    if (status == SQLITE_OK && file->level < SQLITE_LOCK_SHARED) {
        undo_finish(&file->undo);
        status = find_former(file);
        if (status != SQLITE_OK) {
            file->real->pMethods->xUnlock(file->real, SQLITE_LOCK_NONE);
            return status;
        }
        file->level = level;
    }
    return status;
}

static int readonly_unlock(sqlite3_file *base, int level)
{
    ReadonlyFile *file = (ReadonlyFile *)base;
    if (level < SQLITE_LOCK_SHARED) {
        undo_finish(&file->undo);
    }
    file->level = level;
    return file->real->pMethods->xUnlock(file->real, level);
}

static int readonly_check_lock(sqlite3_file *base, int *is_taken)
{
    const ReadonlyFile *file = (ReadonlyFile *)base;
    return file->real->pMethods->xCheckReservedLock(file->real, is_taken);
}

static int readonly_control(sqlite3_file *base, int operation, void *argument)
{
    (void)base;
    (void)operation;
    (void)argument;
    return SQLITE_NOTFOUND;
}

static int readonly_sector(sqlite3_file *base)
{
    const ReadonlyFile *file = (ReadonlyFile *)base;
    return file->real->pMethods->xSectorSize(file->real);
}

static int readonly_characteristics(sqlite3_file *base)
{
    const ReadonlyFile *file = (ReadonlyFile *)base;
    return file->real->pMethods->xDeviceCharacteristics(file->real);
}

// of version 1: no memory that processes share, and so no write-ahead log
static const sqlite3_io_methods METHODS = {
    .iVersion = 1,
    .xClose = readonly_close,
    .xRead = readonly_read,
    .xWrite = readonly_write,
    .xTruncate = readonly_truncate,
    .xSync = readonly_sync,
    .xFileSize = readonly_size,
    .xLock = readonly_lock,
    .xUnlock = readonly_unlock,
    .xCheckReservedLock = readonly_check_lock,
    .xFileControl = readonly_control,
    .xSectorSize = readonly_sector,
    .xDeviceCharacteristics = readonly_characteristics,
};

static int readonly_open(sqlite3_vfs *vfs, const char *name, sqlite3_file *base, int flags,
                         int *flags_used)
{
    sqlite3_vfs *system = system_of(vfs);
    if ((flags & SQLITE_OPEN_MAIN_DB) == 0) {
        // temporary files for sorting have no name
        return name == NULL ? system->xOpen(system, name, base, flags, flags_used)
                            : SQLITE_CANTOPEN;
    }
    ReadonlyFile *file = (ReadonlyFile *)base;
    *file = (ReadonlyFile){.real = (sqlite3_file *)(file + 1)};
    const int status = system->xOpen(system, name, file->real, flags, flags_used);
    if (status != SQLITE_OK) {
        return status;
    }
    Text journal;
    text_init(&journal);
    text_append(&journal, "%s-journal", name);
    file->journal = strdup(journal.data);
    assert(file->journal != NULL);
    text_finish(&journal);
    file->base.pMethods = &METHODS;
    return SQLITE_OK;
}

static int readonly_delete(sqlite3_vfs *vfs, const char *name, int is_synced)
{
    (void)vfs;
    (void)name;
    (void)is_synced;
    return SQLITE_READONLY;
}

static int readonly_access(sqlite3_vfs *vfs, const char *name, int flags, int *is_there)
{
    (void)vfs;
    (void)name;
    (void)flags;
    *is_there = 0;
    return SQLITE_OK;
}

const char *store_readonly_vfs(void)
{
    static sqlite3_vfs vfs;
    if (sqlite3_vfs_find(NAME) == NULL) {
        sqlite3_vfs *system = sqlite3_vfs_find(NULL);
        assert(system != NULL);
        vfs = *system;
        vfs.zName = NAME;
        vfs.pNext = NULL;
        vfs.pAppData = system;
        vfs.szOsFile = (int)sizeof(ReadonlyFile) + system->szOsFile;
        vfs.xOpen = readonly_open;
        vfs.xDelete = readonly_delete;
        vfs.xAccess = readonly_access;
        sqlite3_vfs_register(&vfs, 0);
    }
    return NAME;
}
