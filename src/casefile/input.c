// Can the file be read, and is it text?
#include "casefile/input.h"

#include <assert.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

// Reads until the end of the file or one byte beyond the limit (a pipe has no size to ask for).
static bool read_all(const char *what, const char *path, FILE *file, char **text, size_t *size,
                     Err *err)
{
    char *data = malloc(INPUT_SIZE_MAX + 1);
    assert(data != NULL);
    const size_t length = fread(data, 1, INPUT_SIZE_MAX + 1, file);
    if (ferror(file)) {
        err_set(err, ERR_FILE, "%s: cannot be read: %s", path, strerror(errno));
        goto done;
    }
    if (length > INPUT_SIZE_MAX) {
        err_set(err, ERR_CASE, "%s: too large for a %s file\nallowed: at most %d bytes", path, what,
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

bool input_read(const char *what, const char *path, char **text, size_t *size, Err *err)
{
    struct stat status;
    if (stat(path, &status) != 0) {
        return err_set(err, ERR_FILE, "%s: cannot be read: %s", path, strerror(errno));
    }
    if (S_ISDIR(status.st_mode)) {
        return err_set(err, ERR_CASE, "%s: is a directory\nallowed: a %s file", path, what);
    }
    if (S_ISREG(status.st_mode) && status.st_size > INPUT_SIZE_MAX) {
        return err_set(err, ERR_CASE,
                       "%s: %lld bytes are too large for a %s file\nallowed: at most %d bytes",
                       path, (long long)status.st_size, what, INPUT_SIZE_MAX);
    }
    FILE *file = fopen(path, "rb");
    if (file == NULL) {
        return err_set(err, ERR_FILE, "%s: cannot be read: %s", path, strerror(errno));
    }
    const bool is_read = read_all(what, path, file, text, size, err);
    fclose(file);
    return is_read;
}

static bool check_text(const char *what, const char *name, const char *text, size_t size, Err *err)
{
    if (size == 0) {
        return err_set(err, ERR_CASE, "%s: the file is empty\nallowed: a %s in YAML", name, what);
    }
    const size_t good = source_text_length(text, size);
    if (good < size) {
        return err_set(err, ERR_CASE,
                       "%s: byte %zu (0x%02x) is not text: the file is binary, damaged or not in "
                       "UTF-8\nallowed: a %s in YAML",
                       name, good, (unsigned)(unsigned char)text[good], what);
    }
    return true;
}

bool input_parse(const char *what, const char *name, const char *text, size_t size, Source *source,
                 Node **root, Err *err)
{
    if (!check_text(what, name, text, size, err)) {
        return false;
    }
    // a byte order mark is no part of the text
    const size_t mark = size >= 3 && memcmp(text, "\xef\xbb\xbf", 3) == 0 ? 3 : 0;
    *source = (Source){.name = name, .text = text + mark, .size = size - mark, .what = what};
    if (!document_parse(source, source->text, source->size, root, err)) {
        return false;
    }
    if (*root == NULL) {
        return err_set(err, ERR_CASE, "%s: the file holds no %s\nallowed: a %s in YAML", name, what,
                       what);
    }
    return true;
}
