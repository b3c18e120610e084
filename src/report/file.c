// How does a file come to be there whole or not at all?
//
// It is written beside its place and renamed when complete. A run that is interrupted meanwhile
// takes what it had begun away with it.
#include "report/file.h"

#include "report/file_parts.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

// A reader that has gone away has what it wanted, and needs no words.
static bool fail_to_write(const char *path, int reason, Err *err)
{
    if (reason == EPIPE) {
        return err_set(err, ERR_FILE, "%s", "");
    }
    return err_set(err, ERR_FILE, "cannot write %s: %s", path, strerror(reason));
}

// What a signal has to take away: the one file that is being written.
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

static bool is_standard_output(const char *path)
{
    return strcmp(path, "-") == 0 || strcmp(path, "/dev/stdout") == 0;
}

bool file_is_stream(const char *path)
{
    struct stat status;
    return is_standard_output(path) || strncmp(path, "/dev/", 5) == 0 ||
           strncmp(path, "/proc/", 6) == 0 ||
           (stat(path, &status) == 0 && !S_ISREG(status.st_mode));
}

// A path without links and dots: its own where it is there, else that of the folder it is for.
static void resolve(const char *path, char target[FILE_PATH_SIZE])
{
    char folder[FILE_PATH_SIZE];
    const char *slash = strrchr(path, '/');
    const char *name = slash == NULL ? path : slash + 1;
    snprintf(folder, sizeof folder, "%.*s.", (int)(name - path), path);
    char *whole = realpath(path, NULL);
    char *above = realpath(folder, NULL);
    if (whole == NULL && above != NULL) {
        snprintf(target, FILE_PATH_SIZE, "%s/%s", above, name);
    } else {
        snprintf(target, FILE_PATH_SIZE, "%s", whole != NULL ? whole : path);
    }
    free(whole);
    free(above);
}

bool file_is_same(const char *path, const char *other)
{
    if (path == NULL || other == NULL) {
        return false;
    }
    char first[FILE_PATH_SIZE];
    char second[FILE_PATH_SIZE];
    resolve(path, first);
    resolve(other, second);
    return strcmp(first, second) == 0;
}

// Follows symbolic links, so that the file they lead to is replaced and not the link.
static bool find_target(const char *path, char *target, bool *is_regular, Err *err)
{
    *is_regular = !file_is_stream(path);
    char *resolved = realpath(path, NULL);
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
    if (is_standard_output(path)) {
        // beside the program's own words, wherever they go
        fflush(stdout);
        return fcntl(STDOUT_FILENO, F_DUPFD_CLOEXEC, STDERR_FILENO + 1);
    }
    return file->temporary[0] != '\0' ? file_parts_make(file->path, file->temporary)
                                      : open(path, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
}

bool file_begin(WholeFile *file, const char *path, Err *err)
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

bool file_probe(const char *path, Err *err)
{
    struct stat status;
    if (!file_is_stream(path)) {
        WholeFile file;
        const bool is_begun = file_begin(&file, path, err);
        if (is_begun) {
            file_abandon(&file);
        }
        return is_begun;
    }
    if (is_standard_output(path)) {
        return true;
    }
    // a stream is only asked: opening a pipe would wait for its reader
    if (stat(path, &status) == 0 && S_ISDIR(status.st_mode)) {
        return fail_to_write(path, EISDIR, err);
    }
    return access(path, W_OK) == 0 || fail_to_write(path, errno, err);
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

bool file_write_text(const char *path, const char *text, Err *err)
{
    WholeFile file;
    if (!file_begin(&file, path, err)) {
        return false;
    }
    fputs(text, file.stream);
    return file_end(&file, err);
}
