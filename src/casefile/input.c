// Can the file be read, and is it text?
#include "casefile/input.h"

#include "casefile/source.h"

#include <assert.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

// Reads until the end of the file or one byte beyond the limit (a pipe has no size to ask for).
static bool read_all(const char *path, FILE *file, char **text, size_t *size, Err *err)
{
    char *data = malloc(INPUT_SIZE_MAX + 1);
    assert(data != NULL);
    const size_t length = fread(data, 1, INPUT_SIZE_MAX + 1, file);
    if (ferror(file)) {
        err_set(err, ERR_FILE, "%s: cannot be read: %s", path, strerror(errno));
        goto done;
    }
    if (length > INPUT_SIZE_MAX) {
        err_set(err, ERR_CASE, "%s: too large for a case file\nallowed: at most %d bytes", path,
                INPUT_SIZE_MAX);
        goto done;
    }
    data[length] = '\0';
    *text = data;
    *size = length;
    return true;

done:
    free(data);
    return false;
}

bool input_read(const char *path, char **text, size_t *size, Err *err)
{
    struct stat status;
    if (stat(path, &status) != 0) {
        return err_set(err, ERR_FILE, "%s: cannot be read: %s", path, strerror(errno));
    }
    if (S_ISDIR(status.st_mode)) {
        return err_set(err, ERR_CASE, "%s: is a directory\nallowed: a case file", path);
    }
    if (S_ISREG(status.st_mode) && status.st_size > INPUT_SIZE_MAX) {
        return err_set(err, ERR_CASE,
                       "%s: %lld bytes are too large for a case file\nallowed: at most %d bytes",
                       path, (long long)status.st_size, INPUT_SIZE_MAX);
    }
    FILE *file = fopen(path, "rb");
    if (file == NULL) {
        return err_set(err, ERR_FILE, "%s: cannot be read: %s", path, strerror(errno));
    }
    const bool is_read = read_all(path, file, text, size, err);
    fclose(file);
    return is_read;
}

bool input_check(const char *name, const char *text, size_t size, Err *err)
{
    if (size == 0) {
        return err_set(err, ERR_CASE, "%s: the file is empty\nallowed: a case in YAML", name);
    }
    const size_t good = source_text_length(text, size);
    if (good < size) {
        return err_set(err, ERR_CASE,
                       "%s: byte %zu (0x%02x) is not text: the file is binary, damaged or not in "
                       "UTF-8\nallowed: a case in YAML",
                       name, good, (unsigned)(unsigned char)text[good]);
    }
    return true;
}
