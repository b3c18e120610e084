// Which half-written files were left by a process that was killed, and belong to no process?
//
// A part has its process in its name and is locked by it. The lock alone is not enough, for it ends
// just before the part takes its target's name; the process alone is not, for on a shared disk it
// may be one of another machine. A part without either is of no use to anyone.
#include "write/file_parts.h"

#include "write/work_lock.h"

#include <ctype.h>
#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static const char MARK[] = ".part-";

bool file_parts_name(const char *target, char *part, size_t size)
{
    const int length = snprintf(part, size, "%s%s%ld", target, MARK, (long)getpid());
    return length >= 0 && (size_t)length < size;
}

// The process that a name says it is a part of; 0 where it is no part of that target.
static long process_of(const char *name, const char *target)
{
    const size_t length = strlen(target);
    if (strncmp(name, target, length) != 0 || strncmp(name + length, MARK, sizeof MARK - 1) != 0) {
        return 0;
    }
    const char *digits = name + length + sizeof MARK - 1;
    char *end;
    errno = 0;
    const long process = isdigit((unsigned char)digits[0]) ? strtol(digits, &end, 10) : 0;
    return process > 0 && errno == 0 && *end == '\0' ? process : 0;
}

static bool is_abandoned(int folder, const char *name, long process)
{
    if (kill((pid_t)process, 0) == 0 || errno != ESRCH) {
        return false;
    }
    struct stat status;
    const int part = openat(folder, name, O_RDWR | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
    const bool is_left = part >= 0 && fstat(part, &status) == 0 && S_ISREG(status.st_mode) &&
                         !work_lock_is_taken(part, 0);
    if (part >= 0) {
        close(part);
    }
    return is_left;
}

static void clear(const char *target)
{
    const char *slash = strrchr(target, '/');
    const char *name = slash == NULL ? target : slash + 1;
    char *path = slash == NULL ? strdup(".") : strndup(target, (size_t)(name - target));
    DIR *folder = path == NULL ? NULL : opendir(path);
    free(path);
    if (folder == NULL) {
        return;
    }
    for (const struct dirent *entry; (entry = readdir(folder)) != NULL;) {
        const long process = process_of(entry->d_name, name);
        if (process > 0 && is_abandoned(dirfd(folder), entry->d_name, process)) {
            unlinkat(dirfd(folder), entry->d_name, 0);
        }
    }
    closedir(folder);
}

int file_parts_make(const char *target, const char *part)
{
    struct stat former;
    const bool is_there = stat(target, &former) == 0;
    clear(target);
    // no one else reads the part of a private file while it is written
    const int file = open(part, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, is_there ? 0600 : 0666);
    if (file < 0) {
        return -1;
    }
    // a file system without locks, or without modes, is no reason not to write
    work_lock_take(file, 0);
    if (is_there && fchmod(file, former.st_mode & 0777) != 0) {
        errno = 0;
    }
    return file;
}
