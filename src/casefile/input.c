// Reads a file, and checks that it is text.
#define _GNU_SOURCE // memfd_create
#include "casefile/input.h"

#include "base/claims.h"
#include "base/descriptors.h"
#include "base/shell.h"
#include "base/shipped.h"
#include "base/text.h"

#include <assert.h>
#include <dirent.h>
#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

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

enum { NAMES_MOST = 256 }; // of a folder that are looked at: no user's folder of cases has more

// Appends the file of the same folder whose name is nearest to a path; nothing where none is near.
static void append_nearest(const char *path, Text *text)
{
    const char *slash = strrchr(path, '/');
    const char *name = slash != NULL ? slash + 1 : path;
    char folder[PATH_MAX];
    snprintf(folder, sizeof folder, "%.*s", slash != NULL ? (int)(name - path) : 1,
             slash != NULL ? path : ".");
    DIR *opened = opendir(folder);
    char *names[NAMES_MOST];
    size_t count = 0;
    for (const struct dirent *entry;
         opened != NULL && count < NAMES_MOST && (entry = readdir(opened)) != NULL;) {
        if (entry->d_name[0] != '.') {
            names[count++] = strdup(entry->d_name);
            assert(names[count - 1] != NULL);
        }
    }
    if (opened != NULL) {
        closedir(opened);
    }
    const char *nearest = text_nearest(name, (const char *const *)names, count);
    if (nearest != NULL) {
        text_append(text, "; did you mean '%.*s%s'?", (int)(name - path), path, nearest);
    }
    for (size_t i = 0; i < count; i++) {
        free(names[i]);
    }
}

static bool refuse_missing(const char *path, int reason, Err *err)
{
    Text nearest;
    text_init(&nearest);
    if (reason == ENOENT) {
        append_nearest(path, &nearest);
    }
    err_set(err, ERR_FILE, "%s: cannot be read: %s%s", path, strerror(reason), nearest.data);
    text_finish(&nearest);
    return false;
}

bool input_read(const char *what, const char *path, char **text, size_t *size, Err *err)
{
    struct stat status;
    char found[PATH_MAX];
    shipped_find(path, found, sizeof found);
    if (stat(found, &status) != 0) {
        return refuse_missing(path, errno, err);
    }
    if (S_ISDIR(status.st_mode)) {
        return err_set(err, ERR_CASE, "%s: is a directory\nallowed: a %s file", path, what);
    }
    if (S_ISREG(status.st_mode) && status.st_size > INPUT_SIZE_MAX) {
        return err_set(err, ERR_CASE,
                       "%s: %lld bytes are too large for a %s file\nallowed: at most %d bytes",
                       path, (long long)status.st_size, what, INPUT_SIZE_MAX);
    }
    const char *reason;
    FILE *file = descriptors_open_file(found, &reason);
    if (file == NULL) {
        return err_set(err, ERR_FILE, "%s: cannot be read: %s", path, reason);
    }
    claims_note_read(what, found);
    const bool is_read = read_all(what, path, file, text, size, err);
    fclose(file);
    return is_read;
}

// Puts what a pipe still holds in its place: standard input can then be read any number of times.
static bool keep_stdin(Err *err)
{
    const int kept = memfd_create(INPUT_STDIN, MFD_CLOEXEC);
    char part[1 << 14];
    size_t total = 0;
    ssize_t count = 0;
    bool is_kept = kept >= 0;
    while (is_kept && total <= INPUT_SIZE_MAX &&
           (count = read(STDIN_FILENO, part, sizeof part)) > 0) {
        total += (size_t)count;
        is_kept = write(kept, part, (size_t)count) == count;
    }
    is_kept = is_kept && count >= 0 && lseek(kept, 0, SEEK_SET) == 0 &&
              dup2(kept, STDIN_FILENO) == STDIN_FILENO;
    if (!is_kept) {
        err_set(err, ERR_FILE, "%s: cannot be read: %s", INPUT_STDIN, strerror(errno));
    }
    if (kept >= 0) {
        close(kept);
    }
    return is_kept;
}

bool input_read_stdin(const char *what, char **text, size_t *size, Err *err)
{
    off_t start = lseek(STDIN_FILENO, 0, SEEK_CUR);
    if (start < 0) {
        if (!keep_stdin(err)) {
            return false;
        }
        start = 0;
    }
    FILE *file = descriptors_stream(STDIN_FILENO, "rb");
    if (file == NULL) {
        return err_set(err, ERR_FILE, "%s: cannot be read: %s", INPUT_STDIN, strerror(errno));
    }
    claims_note_read(what, "/dev/stdin");
    const bool is_read = read_all(what, INPUT_STDIN, file, text, size, err);
    fclose(file);
    lseek(STDIN_FILENO, start, SEEK_SET);
    return is_read;
}

static bool has_key(const Node *root, const char *key)
{
    for (const Node *value = root->kind == NODE_MAP ? root->first : NULL; value != NULL;
         value = value->next) {
        if (value->key != NULL && value->key->text != NULL && strcmp(value->key->text, key) == 0) {
            return true;
        }
    }
    return false;
}

static bool refuse_kind(const char *what, const char *command, const char *name, Err *err)
{
    char *path = shell_copy_path(strcmp(name, INPUT_STDIN) == 0 ? "FILE" : name);
    err_set(err, ERR_USAGE, "%s: %s\nallowed: jointplay %s %s", name, what, command, path);
    free(path);
    return false;
}

// A study has the file of a case, and a case a mechanism: one in place of the other has a command
// of its own.
static bool check_kind(const char *what, const char *name, const Node *root, Err *err)
{
    const bool has_mechanism = has_key(root, "four-bar") || has_key(root, "bodies");
    const bool has_case = has_key(root, "case");
    if (strcmp(what, "case") == 0 && has_case && !has_mechanism) {
        return refuse_kind("is a study and not a case", "study", name, err);
    }
    return strcmp(what, "study") != 0 || has_case || !has_mechanism ||
           refuse_kind("is a case and not a study", "run", name, err);
}

bool input_is_study(const char *path)
{
    Err unread = {ERR_NONE, ""};
    char *text = NULL;
    size_t size = 0;
    Source source = {.name = path, .what = "study"};
    Node *root = NULL;
    const bool is_read = strcmp(path, INPUT_STDIN) != 0 &&
                         input_read("study", path, &text, &size, &unread) &&
                         document_parse(&source, text, size, &root, &unread) && root != NULL;
    const bool is_study =
        is_read && has_key(root, "case") && !has_key(root, "four-bar") && !has_key(root, "bodies");
    document_destroy(root);
    free(text);
    return is_study;
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
    if (!check_kind(what, name, *root, err)) {
        document_destroy(*root);
        *root = NULL;
        return false;
    }
    return true;
}
