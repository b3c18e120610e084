// How does a file come to be there whole or not at all?
#include "report/file.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static bool fail_to_write(const char *path, int reason, Err *err)
{
    return err_set(err, ERR_FILE, "cannot write %s: %s", path, strerror(reason));
}

// Follows symbolic links, so that the file they lead to is replaced and not the link.
static bool find_target(const char *path, char *target, bool *is_regular, Err *err)
{
    struct stat status;
    *is_regular = stat(path, &status) != 0 || S_ISREG(status.st_mode);
    char *resolved = realpath(path, NULL);
    const int written = snprintf(target, FILE_PATH_SIZE, "%s", resolved == NULL ? path : resolved);
    free(resolved);
    if (path[0] == '\0') {
        return err_set(err, ERR_FILE, "cannot write a file without a name");
    }
    return (written >= 0 && written < FILE_PATH_SIZE) || fail_to_write(path, ENAMETOOLONG, err);
}

bool file_begin(WholeFile *file, const char *path, Err *err)
{
    *file = (WholeFile){0};
    bool is_regular;
    if (!find_target(path, file->path, &is_regular, err)) {
        return false;
    }
    if (is_regular) {
        const int written = snprintf(file->temporary, sizeof file->temporary, "%s.part-%ld",
                                     file->path, (long)getpid());
        if (written < 0 || (size_t)written >= sizeof file->temporary) {
            return fail_to_write(path, ENAMETOOLONG, err);
        }
    }
    file->stream = fopen(is_regular ? file->temporary : file->path, is_regular ? "wx" : "w");
    return file->stream != NULL || fail_to_write(path, errno, err);
}

bool file_end(WholeFile *file, Err *err)
{
    // a write that failed earlier has left its mark on the stream, but not always its reason
    errno = 0;
    const bool is_written = fflush(file->stream) == 0 && !ferror(file->stream);
    const int reason = errno != 0 ? errno : EIO;
    if (!is_written) {
        file_abandon(file);
        return fail_to_write(file->path, reason, err);
    }
    const bool is_closed = fclose(file->stream) == 0;
    file->stream = NULL;
    if (!is_closed || (file->temporary[0] != '\0' && rename(file->temporary, file->path) != 0)) {
        const int late_reason = errno;
        file_abandon(file);
        return fail_to_write(file->path, late_reason, err);
    }
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
