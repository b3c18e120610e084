// Writes a file whole or not at all, and replaces only files of its own kind.
//
// It is written under a temporary name beside its target and renamed when complete. A run that is
// interrupted meanwhile removes the temporary file. What it replaces must be of its own kind, and
// not a file that the command reads: checked before the work, and again before the file is begun.
#define _GNU_SOURCE // memmem
#define _GNU_SOURCE // locks of an open file
#define _GNU_SOURCE // fopencookie

#include "write/file.h"
#include "base/claims.h"
#include "base/err.h"

#include <assert.h>
#include <ctype.h>
#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/types.h>
#include <unistd.h>

// The lock of a process that works on a file.

enum {
    TRIES = 100, // a second in all: children of a killed process were seen to live on for 0.3 s
    WAIT_US = 10000,
};

static struct flock lock_of(short type, off_t byte)
{
    return (struct flock){.l_type = type, .l_whence = SEEK_SET, .l_start = byte, .l_len = 1};
}

int work_lock_take(int file, off_t byte)
{
    struct flock lock = lock_of(F_WRLCK, byte);
    for (int i = 0; fcntl(file, F_OFD_SETLK, &lock) != 0; i++) {
        if (errno != EACCES && errno != EAGAIN) {
            return errno;
        }
        if (i == TRIES) {
            return EAGAIN;
        }
        usleep(WAIT_US);
    }
    return 0;
}

void work_lock_give(int file, off_t byte)
{
    struct flock lock = lock_of(F_UNLCK, byte);
    fcntl(file, F_OFD_SETLK, &lock);
}

bool work_lock_is_taken(int file, off_t byte)
{
    struct flock lock = lock_of(F_WRLCK, byte);
    return file >= 0 && fcntl(file, F_OFD_GETLK, &lock) == 0 && lock.l_type != F_UNLCK;
}

// Files half-written by a process that was killed.
//
// A part has its process in its name and is locked by it. The lock alone is not enough, for it ends
// just before the part takes its target's name; the process alone is not, for on a shared disk it
// may be one of another machine. A part without either is of no use to anyone.

static const char MARK[] = ".part-";

// The name of the part of this process: <target>.part-<process>. False where it is too long.
static bool file_parts_name(const char *target, char *part, size_t size)
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

// Makes and locks the part, and takes away those that processes which are no more have left of the
// same target. It is as open to others as the target is, where there is one. Its descriptor; -1,
// with errno set.
static int file_parts_make(const char *target, const char *part)
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

// The kind of a file, by how it begins.
//
// A user's own table, drawing or script is none of ours, whatever its name ends in: only what
// begins as this program begins such a file is replaced. A new beginning needs a mark here; the old
// one stays, for the files that have it.

enum {
    MARK_MAX = 5,        // beginnings of one kind
    HEAD_SIZE = 1 << 16, // bytes that are looked at: the first line of a study's table is long
    SHOWN_SIZE = 33,     // of the beginning of a file that is no kind of ours
    APPLICATION_AT = 68, // the application_id of an SQLite file
};

// How a file begins, blanks and line ends aside, and what stands further down.
typedef struct Mark {
    const char *opening;
    const char *further; // NULL: nothing more is asked
} Mark;

typedef struct Kind {
    const char *name; // in a message
    Mark marks[MARK_MAX];
} Kind;

static const Kind KINDS[FILE_KIND_COUNT] = {
    [FILE_TABLE] = {"a table of jointplay (CSV)",
                    {{"time_s,", NULL},
                     {"joint,onset_s,", NULL},
                     {"scheme,step_s,", NULL},
                     {"joint,law,map,step_s,", NULL},
                     {"run,", ",outcome,reason,"}}},
    [FILE_PICTURE] = {"a picture of jointplay (SVG)",
                      {{"<svg xmlns=\"http://www.w3.org/2000/svg\" width=", "<style>text{"}}},
    [FILE_RESULT] = {"a result of jointplay (JSON)", {{"{\"tool\": {\"version\":", "\"ode\":"}}},
    [FILE_REPORT] = {"a report of jointplay (text)",
                     {{"", "\n\n  case    "}, {"A lone contact", "\n\n  valid    "}}},
    [FILE_PAGE] = {"a page of jointplay report (HTML)",
                   {{"<!DOCTYPE html>", "content=\"jointplay report\""}}},
    [FILE_CODE] = {"C code of jointplay tune",
                   {{"// A mechanism with play in its joints in the Open Dynamics Engine,",
                     "`jointplay tune`"}}},
    [FILE_SDF] = {"SDF of jointplay tune", {{"<!-- error with these constants, measured:", NULL}}},
    [FILE_MJCF] = {"MJCF of jointplay tune",
                   {{"<!-- spring ", "not run here; for bodies"},
                    {"<!-- spring ", "limits of the tendons"}}},
    [FILE_JUNIT] = {"JUnit XML of jointplay check",
                    {{"<?xml version=\"1.0\" encoding=\"UTF-8\"?><testsuites name=\"jointplay "
                      "check\"",
                      NULL}}},
    [FILE_COMMENT] = {"a comment of jointplay check (Markdown)", {{"### jointplay check", NULL}}},
    [FILE_BASELINE] = {"a baseline of jointplay check",
                       {{"{\"format\": \"jointplay baseline", NULL}}},
    [FILE_ROWS] = {"rows of jointplay (JSON Lines)", {{"{\"run\":", "\"outcome\":"}}},
    [FILE_CASE] = {"a case of jointplay new (YAML)", {{"# Written by 'jointplay new", NULL}}},
    [FILE_SCRIPT] = {"a script of jointplay study slurm",
                     {{"#!/bin/bash", "Written by 'jointplay study slurm'"}}},
    [FILE_STORE] = {"a store of a study", {{"SQLite format 3", "JPST"}}},
    [FILE_JOURNAL] = {"a store of a comparison", {{"{\"compare\":", NULL}}},
};

static bool begins_with(const char *head, size_t size, const char *opening)
{
    size_t i = 0;
    for (; *opening != '\0'; opening++) {
        if (isspace((unsigned char)*opening)) {
            continue;
        }
        while (i < size && isspace((unsigned char)head[i])) {
            i++;
        }
        if (i == size || head[i] != *opening) {
            return false;
        }
        i++;
    }
    return true;
}

// Where what stands further down in a file of a kind does, in bytes; 0: anywhere.
static const size_t FURTHER_AT[FILE_KIND_COUNT] = {[FILE_STORE] = APPLICATION_AT};

static bool goes_on_with(const char *head, size_t size, const char *further, size_t at)
{
    const size_t length = further != NULL ? strlen(further) : 0;
    if (at > 0) {
        return size >= at + length && memcmp(head + at, further, length) == 0;
    }
    return length == 0 || memmem(head, size, further, length) != NULL;
}

static bool is_of_kind(FileKind kind, const char *head, size_t size)
{
    const Mark *marks = KINDS[kind].marks;
    for (size_t i = 0; i < MARK_MAX && marks[i].opening != NULL; i++) {
        if (begins_with(head, size, marks[i].opening) &&
            goes_on_with(head, size, marks[i].further, FURTHER_AT[kind])) {
            return true;
        }
    }
    return false;
}

// The first line, or what there is room for of it.
static void show_head(const char *head, size_t size, char shown[SHOWN_SIZE])
{
    size_t start = 0;
    while (start < size && isspace((unsigned char)head[start])) {
        start++;
    }
    size_t length = 0;
    for (; start + length < size && length < SHOWN_SIZE - 1; length++) {
        const char letter = head[start + length];
        if (letter == '\n' || letter == '\r') {
            break;
        }
        shown[length] = (char)(letter >= ' ' && letter <= '~' ? letter : '?');
    }
    shown[length] = '\0';
}

static bool file_refuse(const char *user, const char *path, const char *what, const Kind *kind,
                        Err *err)
{
    return err_set(err, ERR_FILE,
                   "%s would replace %s, which %s and is not %s; delete it first or name another "
                   "file",
                   user, path, what, kind->name);
}

static bool refuse_head(const char *user, const char *path, const char *head, size_t size,
                        const Kind *kind, Err *err)
{
    char what[2 * SHOWN_SIZE + 64];
    for (size_t i = 0; i < FILE_KIND_COUNT; i++) {
        if (is_of_kind((FileKind)i, head, size)) {
            snprintf(what, sizeof what, "is %s", KINDS[i].name);
            return file_refuse(user, path, what, kind, err);
        }
    }
    char shown[SHOWN_SIZE];
    show_head(head, size, shown);
    snprintf(what, sizeof what, "begins '%s'", shown);
    return file_refuse(user, path, what, kind, err);
}

static bool read_head(const char *path, char *head, size_t *size)
{
    FILE *stream = fopen(path, "rb");
    if (stream == NULL) {
        return false;
    }
    *size = fread(head, 1, HEAD_SIZE, stream);
    const bool is_read = !ferror(stream);
    fclose(stream);
    return is_read;
}

// Whether a file may be written over with one of a kind: it is not there, is empty, is no regular
// file or is of that kind. Fails with ERR_FILE, saying what is in it; `user` is what writes it,
// such as "--plot".
static bool file_kind_check(FileKind kind, const char *user, const char *path, Err *err)
{
    struct stat status;
    if (stat(path, &status) != 0 || !S_ISREG(status.st_mode) || status.st_size == 0) {
        return true;
    }
    char *head = malloc(HEAD_SIZE);
    assert(head != NULL);
    size_t size = 0;
    bool is_own = false;
    if (!read_head(path, head, &size)) {
        char what[128];
        snprintf(what, sizeof what, "cannot be read (%s)", strerror(errno));
        file_refuse(user, path, what, &KINDS[kind], err);
    } else {
        is_own =
            is_of_kind(kind, head, size) || refuse_head(user, path, head, size, &KINDS[kind], err);
    }
    free(head);
    return is_own;
}

// Whether files of a kind are written in place, by what opens them and knows them for its own.
static bool file_kind_is_kept(FileKind kind)
{
    return kind == FILE_STORE || kind == FILE_JOURNAL;
}

// A stream that remembers why a write failed.

static ssize_t sink_write(void *context, const char *bytes, size_t size)
{
    Sink *sink = context;
    size_t sent = 0;
    while (sent < size && sink->reason == 0) {
        const ssize_t count = write(sink->file, bytes + sent, size - sent);
        sent += count > 0 ? (size_t)count : 0;
        if (count < 0 && errno != EINTR) {
            sink->reason = errno;
        }
    }
    return (ssize_t)sent;
}

// A network file system may report only now that there was no space.
static int sink_close(void *context)
{
    Sink *sink = context;
    const int status = close(sink->file);
    if (status != 0 && sink->reason == 0) {
        sink->reason = errno;
    }
    return status;
}

FILE *sink_open(Sink *sink, int file)
{
    *sink = (Sink){.file = file};
    const cookie_io_functions_t functions = {.write = sink_write, .close = sink_close};
    return fopencookie(sink, "w", functions);
}

enum { DIGIT_MAX = 9 }; // of a descriptor

// A reader that has gone away has what it wanted, and needs no words.
static bool fail_to_write(const char *path, int reason, Err *err)
{
    if (reason == EPIPE) {
        return err_set(err, ERR_FILE, "%s", "");
    }
    return err_set(err, ERR_FILE, "cannot write %s: %s", path, strerror(reason));
}

// What a signal handler has to remove: the one file that is being written.
static char pending[FILE_PATH_SIZE];

void file_take_away_pending(void)
{
    if (pending[0] != '\0') {
        unlink(pending);
    }
}

static void take_away(int signal_number)
{
    file_take_away_pending();
    signal(signal_number, SIG_DFL);
    raise(signal_number);
}

static void watch_signals(const char *temporary)
{
    const int signals[] = {SIGINT, SIGTERM, SIGHUP};
    snprintf(pending, sizeof pending, "%s", temporary);
    for (size_t i = 0; i < sizeof signals / sizeof *signals; i++) {
        struct sigaction former;
        // what the caller ignores stays ignored
        if (sigaction(signals[i], NULL, &former) == 0 && former.sa_handler == SIG_DFL) {
            signal(signals[i], take_away);
        }
    }
}

// The descriptor that a path names, which the caller opened; -1 where it names none.
static int file_descriptor_of(const char *path)
{
    static const char *const FOLDERS[] = {"/dev/fd/", "/proc/self/fd/"};
    if (strcmp(path, "-") == 0 || strcmp(path, "/dev/stdout") == 0) {
        return STDOUT_FILENO;
    }
    if (strcmp(path, "/dev/stderr") == 0) {
        return STDERR_FILENO;
    }
    for (size_t i = 0; i < sizeof FOLDERS / sizeof *FOLDERS; i++) {
        const size_t length = strlen(FOLDERS[i]);
        const char *digits = path + length;
        if (strncmp(path, FOLDERS[i], length) == 0 && digits[0] != '\0' &&
            strlen(digits) <= DIGIT_MAX && strspn(digits, "0123456789") == strlen(digits)) {
            return atoi(digits);
        }
    }
    return -1;
}

// Whether a descriptor is the caller's and can be written to; errno says why not. Those that the
// program opened itself are closed where another program is started.
static bool is_callers(int descriptor)
{
    const int flags = fcntl(descriptor, F_GETFD);
    const int mode = fcntl(descriptor, F_GETFL);
    errno = EBADF;
    return flags >= 0 && (flags & FD_CLOEXEC) == 0 && (mode & O_ACCMODE) != O_RDONLY;
}

bool file_is_stream(const char *path)
{
    struct stat status;
    return file_descriptor_of(path) >= 0 || (stat(path, &status) == 0 && !S_ISREG(status.st_mode));
}

// What a message and the list of claims call the target.
static const char *file_name_of(const char *path)
{
    return file_descriptor_of(path) == STDOUT_FILENO ? "-" : path;
}

bool file_check_input(const char *user, const char *path, Err *err)
{
    Claim claim;
    return !claims_find(file_name_of(path), &claim) || !claim.is_read ||
           err_set(err, ERR_USAGE,
                   "%s would replace %s, which is the %s that this command reads; name another "
                   "file",
                   user, path, claim.user);
}

// Whether this command does not read that file, has no other output for it where one is to be
// claimed, and nothing of another kind stands there.
static bool file_check_target(const char *user, FileKind kind, const char *path, bool is_new,
                              Err *err)
{
    Claim claim;
    if (!file_check_input(user, path, err)) {
        return false;
    }
    const bool is_claimed = claims_find(file_name_of(path), &claim);
    if (is_claimed && is_new && strcmp(claim.user, user) != 0) {
        return err_set(err, ERR_USAGE, "%s and %s would both write %s", claim.user, user, path);
    }
    return file_descriptor_of(path) >= 0 ||
           file_kind_check(kind, is_claimed ? claim.user : user, path, err);
}

// Follows symbolic links, so that the file they lead to is replaced and not the link.
static bool find_target(const char *path, char *target, bool *is_regular, Err *err)
{
    *is_regular = !file_is_stream(path);
    char *resolved = *is_regular ? realpath(path, NULL) : NULL;
    const int written = snprintf(target, FILE_PATH_SIZE, "%s", resolved == NULL ? path : resolved);
    free(resolved);
    if (path[0] == '\0') {
        return err_set(err, ERR_FILE, "cannot write a file without a name");
    }
    return (written >= 0 && written < FILE_PATH_SIZE) || fail_to_write(path, ENAMETOOLONG, err);
}

// A descriptor of its own; -1, with errno set.
static int file_open_target(const WholeFile *file, const char *path)
{
    const int descriptor = file_descriptor_of(path);
    if (descriptor >= 0) {
        // beside the program's own words, wherever they go
        fflush(stdout);
        return is_callers(descriptor) ? fcntl(descriptor, F_DUPFD_CLOEXEC, STDERR_FILENO + 1) : -1;
    }
    return file->temporary[0] != '\0' ? file_parts_make(file->path, file->temporary)
                                      : open(path, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
}

// Opens what takes the text; not yet the file itself, but for a stream.
static bool begin(WholeFile *file, const char *path, Err *err)
{
    *file = (WholeFile){0};
    bool is_regular;
    if (!find_target(path, file->path, &is_regular, err)) {
        return false;
    }
    if (is_regular && !file_parts_name(file->path, file->temporary, sizeof file->temporary)) {
        return fail_to_write(path, ENAMETOOLONG, err);
    }
    const int target = file_open_target(file, path);
    file->stream = target < 0 ? NULL : sink_open(&file->sink, target);
    if (file->stream == NULL) {
        return fail_to_write(path, errno, err);
    }
    watch_signals(file->temporary);
    return true;
}

bool file_begin(WholeFile *file, FileKind kind, const char *path, Err *err)
{
    return file_check_target("the output", kind, path, false, err) && begin(file, path, err);
}

// Whether the file could be written, by writing nothing to it.
static bool probe(const char *path, Err *err)
{
    struct stat status;
    const int descriptor = file_descriptor_of(path);
    if (descriptor >= 0) {
        // a closed standard output is reported where it is written to
        return descriptor == STDOUT_FILENO || is_callers(descriptor) ||
               fail_to_write(path, errno, err);
    }
    if (!file_is_stream(path)) {
        WholeFile file;
        const bool is_begun = begin(&file, path, err);
        if (is_begun) {
            file_abandon(&file);
        }
        return is_begun;
    }
    // a stream is only asked: opening a pipe would wait for its reader
    if (stat(path, &status) == 0 && S_ISDIR(status.st_mode)) {
        return fail_to_write(path, EISDIR, err);
    }
    return access(path, W_OK) == 0 || fail_to_write(path, errno, err);
}

bool file_claim(const char *user, FileKind kind, const char *path, Err *err)
{
    if (!file_check_target(user, kind, path, true, err) ||
        (!file_kind_is_kept(kind) && !probe(path, err))) {
        return false;
    }
    claims_note_written(user, file_name_of(path));
    return true;
}

bool file_check(const WholeFile *file, Err *err)
{
    return file->sink.reason == 0 || fail_to_write(file->path, file->sink.reason, err);
}

bool file_end(WholeFile *file, Err *err)
{
    const bool is_closed = fclose(file->stream) == 0;
    file->stream = NULL;
    if (!is_closed || file->sink.reason != 0 ||
        (file->temporary[0] != '\0' && rename(file->temporary, file->path) != 0)) {
        const int reason = file->sink.reason != 0 ? file->sink.reason : errno;
        file_abandon(file);
        return fail_to_write(file->path, reason, err);
    }
    pending[0] = '\0';
    return true;
}

void file_abandon(WholeFile *file)
{
    if (file->stream != NULL) {
        fclose(file->stream);
        file->stream = NULL;
    }
    if (file->temporary[0] != '\0') {
        unlink(file->temporary);
    }
    pending[0] = '\0';
}

bool file_write_text(FileKind kind, const char *path, const char *text, Err *err)
{
    WholeFile file;
    if (!file_begin(&file, kind, path, err)) {
        return false;
    }
    fputs(text, file.stream);
    return file_end(&file, err);
}

void file_remove(FileKind kind, const char *path)
{
    Err err = {0};
    if (!file_is_stream(path) && file_check_target("the output", kind, path, false, &err)) {
        unlink(path);
    }
}

bool file_make_folder(const char *folder, Err *err)
{
    char path[FILE_PATH_SIZE];
    const int written = snprintf(path, sizeof path, "%s", folder);
    if (written <= 0 || (size_t)written >= sizeof path) {
        return err_set(err, ERR_FILE, "cannot make a folder of such a name");
    }
    // every part that ends in a slash, then the whole
    for (char *slash = strchr(path + 1, '/'); slash != NULL; slash = strchr(slash + 1, '/')) {
        *slash = '\0';
        mkdir(path, 0777);
        *slash = '/';
    }
    struct stat status;
    if (mkdir(path, 0777) != 0 && errno != EEXIST) {
        return err_set(err, ERR_FILE, "cannot make the folder %s: %s", folder, strerror(errno));
    }
    if (stat(path, &status) != 0 || !S_ISDIR(status.st_mode)) {
        return err_set(err, ERR_FILE, "cannot make the folder %s: it is a file", folder);
    }
    return true;
}

void file_stem(const char *path, char *name, size_t size)
{
    const char *slash = strrchr(path, '/');
    const char *base = slash == NULL ? path : slash + 1;
    const char *dot = strrchr(base, '.');
    const size_t length = dot == NULL || dot == base ? strlen(base) : (size_t)(dot - base);
    snprintf(name, size, "%.*s", (int)length, base);
}
