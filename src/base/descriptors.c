// Takes the descriptors 0, 1 and 2 where the caller closed them.
//
// The system gives the lowest free number to whatever is opened next: with standard error closed, a
// store would become it, and take all messages.
#include "base/descriptors.h"

#include <errno.h>
#include <fcntl.h>
#include <string.h>
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
