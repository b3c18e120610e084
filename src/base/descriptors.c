// Takes the descriptors 0, 1 and 2 where the caller closed them, and opens files to be read.
//
// The system gives the lowest free number to whatever is opened next: with standard error closed, a
// store would become it, and take all messages.
#include "base/descriptors.h"

#include <errno.h>
#include <fcntl.h>
#include <stdbool.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

bool descriptors_reserve(Err *err)
{
    static const char *const NAMES[] = {"standard input", "standard output", "standard error"};
    // input and output are opened the wrong way round, so that using them is an error still
    static const int MODES[] = {O_WRONLY, O_RDONLY, O_WRONLY};
    for (int i = STDIN_FILENO; i <= STDERR_FILENO; i++) {
        if (fcntl(i, F_GETFD) < 0 && open("/dev/null", MODES[i]) != i) {
            return err_set(err, ERR_FILE, "%s is closed, and /dev/null cannot be opened for it: %s",
                           NAMES[i], strerror(errno));
        }
    }
    return true;
}

FILE *descriptors_stream(int descriptor, const char *mode)
{
    const int copy = fcntl(descriptor, F_DUPFD_CLOEXEC, STDERR_FILENO + 1);
    FILE *stream = copy >= 0 ? fdopen(copy, mode) : NULL;
    if (stream == NULL && copy >= 0) {
        close(copy);
        // the C library finds that it is open the wrong way round, and calls it an argument
        errno = EBADF;
    }
    return stream;
}

// Whether a path names what the caller opened.
static bool is_of_caller(const char *path)
{
    return strcmp(path, "/dev/stdin") == 0 || strncmp(path, "/dev/fd/", 8) == 0 ||
           strncmp(path, "/proc/self/fd/", 14) == 0;
}

FILE *descriptors_open_file(const char *path, const char **reason)
{
    // without waiting for a writer, which a regular file has no need of
    const bool may_wait = is_of_caller(path);
    const int file = open(path, O_RDONLY | O_CLOEXEC | (may_wait ? 0 : O_NONBLOCK));
    struct stat status;
    if (file < 0 || fstat(file, &status) != 0) {
        *reason = strerror(errno);
    } else if (!S_ISREG(status.st_mode) && !(may_wait && !S_ISDIR(status.st_mode))) {
        *reason = S_ISDIR(status.st_mode) ? "it is a folder" : "it is no regular file";
    } else {
        FILE *stream = fdopen(file, "rb");
        if (stream != NULL) {
            return stream;
        }
        *reason = strerror(errno);
    }
    if (file >= 0) {
        close(file);
    }
    return NULL;
}
