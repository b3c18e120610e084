// How does a file come to be there whole or not at all?
//
// It is written under a temporary name beside its target and renamed when complete. A run that is
// interrupted meanwhile removes the temporary file. What it replaces must be of its own kind, and
// not a file that the command reads: checked before the work, and again before the file is begun.
#include "write/file.h"

#include "base/claims.h"
#include "write/file_parts.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

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

static void take_away(int signal_number)
{
    if (pending[0] != '\0') {
        unlink(pending);
    }
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
static int descriptor_of(const char *path)
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
    return descriptor_of(path) >= 0 || (stat(path, &status) == 0 && !S_ISREG(status.st_mode));
}

// What a message and the list of claims call the target.
static const char *name_of(const char *path)
{
    return descriptor_of(path) == STDOUT_FILENO ? "-" : path;
}

bool file_check_input(const char *user, const char *path, Err *err)
{
    Claim claim;
    return !claims_find(name_of(path), &claim) || !claim.is_read ||
           err_set(err, ERR_USAGE,
                   "%s would replace %s, which is the %s that this command reads; name another "
                   "file",
                   user, path, claim.user);
}

// Whether this command does not read that file, has no other output for it where one is to be
// claimed, and nothing of another kind stands there.
static bool check_target(const char *user, FileKind kind, const char *path, bool is_new, Err *err)
{
    Claim claim;
    if (!file_check_input(user, path, err)) {
        return false;
    }
    const bool is_claimed = claims_find(name_of(path), &claim);
    if (is_claimed && is_new && strcmp(claim.user, user) != 0) {
        return err_set(err, ERR_USAGE, "%s and %s would both write %s", claim.user, user, path);
    }
    return descriptor_of(path) >= 0 ||
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
static int open_target(const WholeFile *file, const char *path)
{
    const int descriptor = descriptor_of(path);
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
    const int target = open_target(file, path);
    file->stream = target < 0 ? NULL : sink_open(&file->sink, target);
    if (file->stream == NULL) {
        return fail_to_write(path, errno, err);
    }
    watch_signals(file->temporary);
    return true;
}

bool file_begin(WholeFile *file, FileKind kind, const char *path, Err *err)
{
    return check_target("the output", kind, path, false, err) && begin(file, path, err);
}

// Whether the file could be written, by writing nothing to it.
static bool probe(const char *path, Err *err)
{
    struct stat status;
    const int descriptor = descriptor_of(path);
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
    if (!check_target(user, kind, path, true, err) ||
        (!file_kind_is_kept(kind) && !probe(path, err))) {
        return false;
    }
    claims_note_written(user, name_of(path));
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
    if (!file_is_stream(path) && check_target("the output", kind, path, false, &err)) {
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
