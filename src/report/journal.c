// How does what is finished survive the end of the program?
#include "report/journal.h"

#include "base/text.h"
#include "base/work_lock.h"

#include <assert.h>
#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { READ_SIZE = 1 << 16, OPENING_SIZE = 64 };

// 17 digits bring back every number as it was
static const size_t LINE_FLAGS = JSON_REAL_PRECISION(17) | JSON_COMPACT | JSON_SORT_KEYS;

const JournalKind JOURNAL_COMPARE = {"compare", "store", "comparison", "; --fresh starts it over"};
const JournalKind JOURNAL_BLESS = {"check", "file of kept starts", "baseline", ""};

static bool fail(const Journal *journal, const char *what, Err *err)
{
    return err_set(err, ERR_FILE, "cannot %s the %s %s: %s", what, journal->kind->what,
                   journal->path, strerror(errno));
}

static bool refuse_stranger(const Journal *journal, Err *err)
{
    return err_set(err, ERR_FILE, "%s is not a %s of jointplay %s", journal->path,
                   journal->kind->what, journal->kind->name);
}

static bool read_all(const Journal *journal, Text *text, Err *err)
{
    char *buffer = malloc(READ_SIZE + 1);
    assert(buffer != NULL);
    ssize_t count;
    while ((count = read(journal->file, buffer, READ_SIZE)) > 0) {
        // a zero can only stand in a line that is damaged, and ends it
        buffer[count] = '\0';
        text_append(text, "%s", buffer);
        if (strlen(buffer) < (size_t)count) {
            break;
        }
    }
    free(buffer);
    return count >= 0 || fail(journal, "read", err);
}

// Takes the next line that is whole, and ends it; NULL behind the last.
static char *next_line(char **rest)
{
    char *line = *rest;
    char *end = strchr(line, '\n');
    if (end == NULL) {
        return NULL;
    }
    *end = '\0';
    *rest = end + 1;
    return line;
}

// The first thing in which two values differ, by its path; false where nothing does.
static bool find_difference(const json_t *there, const json_t *here, const char *path, Text *text)
{
    if (json_is_object(there) && json_is_object(here)) {
        const char *name;
        json_t *value;
        json_object_foreach((json_t *)here, name, value)
        {
            char inner[256];
            snprintf(inner, sizeof inner, "%s%s%s", path, path[0] != '\0' ? "." : "", name);
            if (find_difference(json_object_get(there, name), value, inner, text)) {
                return true;
            }
        }
    } else if (!json_equal(there, here)) {
        char *was =
            there == NULL ? NULL : json_dumps(there, JSON_ENCODE_ANY | JSON_REAL_PRECISION(6));
        char *is = json_dumps(here, JSON_ENCODE_ANY | JSON_REAL_PRECISION(6));
        text_append(text, "%s is %s there and %s here", path, was == NULL ? "missing" : was, is);
        free(was);
        free(is);
        return true;
    }
    return false;
}

static bool check_key(const Journal *journal, const char *line, const json_t *key, bool is_fresh,
                      Err *err)
{
    json_t *head = json_loads(line, 0, NULL);
    const JournalKind *kind = journal->kind;
    const json_t *stored = json_object_get(head, kind->name);
    Text text;
    text_init(&text);
    bool is_right = true;
    if (stored == NULL) {
        is_right = refuse_stranger(journal, err);
    } else if (!is_fresh && find_difference(stored, key, "", &text)) {
        is_right = err_set(err, ERR_FILE, "the %s %s is of another %s: %s%s", kind->what,
                           journal->path, kind->work, text.data, kind->remedy);
    }
    text_finish(&text);
    json_decref(head);
    return is_right;
}

static bool read_entries(Journal *journal, char *rest, Err *err)
{
    size_t number = 2;
    for (char *line = next_line(&rest); line != NULL; line = next_line(&rest), number++) {
        json_t *entry = json_loads(line, 0, NULL);
        if (entry == NULL) {
            return err_set(err, ERR_FILE, "line %zu of the %s %s is damaged%s", number,
                           journal->kind->what, journal->path, journal->kind->remedy);
        }
        json_array_append_new(journal->entries, entry);
    }
    return true;
}

// Takes in what stands in the store, up to the last line that is whole.
static bool take_in(Journal *journal, json_t *key, bool is_fresh, Err *err)
{
    Text text;
    text_init(&text);
    bool is_done = read_all(journal, &text, err);
    const char *last = strrchr(text.data, '\n');
    const off_t whole = last == NULL ? 0 : last + 1 - text.data;
    char *rest = text.data;
    char *head = whole > 0 ? next_line(&rest) : NULL;
    // a first line without an end is our own where it begins like one
    const bool is_started = head == NULL && text.length > 0;
    char opening[OPENING_SIZE];
    snprintf(opening, sizeof opening, "{\"%s\":", journal->kind->name);
    const size_t begun = text.length < strlen(opening) ? text.length : strlen(opening);
    if (is_started && strncmp(text.data, opening, begun) != 0) {
        is_done = refuse_stranger(journal, err);
    }
    is_done = is_done && (head == NULL || check_key(journal, head, key, is_fresh, err)) &&
              (is_fresh || read_entries(journal, rest, err)) &&
              (ftruncate(journal->file, is_fresh ? 0 : whole) == 0 || fail(journal, "cut", err));
    if (is_done && (is_fresh || head == NULL)) {
        is_done = journal_add(journal, json_pack("{s:O}", journal->kind->name, key), err);
    }
    text_finish(&text);
    return is_done;
}

bool journal_open(Journal *journal, const JournalKind *kind, const char *path, json_t *key,
                  bool is_fresh, Err *err)
{
    *journal = (Journal){
        .kind = kind,
        .file = open(path, O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC, 0666),
        .path = strdup(path),
        .entries = json_array(),
    };
    assert(journal->path != NULL && journal->entries != NULL);
    bool is_open = journal->file >= 0 || fail(journal, "open", err);
    if (is_open && work_lock_take(journal->file, 0) != 0) {
        is_open =
            err_set(err, ERR_FILE, "the %s %s is at work in another process", kind->what, path);
    }
    is_open = is_open && take_in(journal, key, is_fresh, err);
    if (!is_open) {
        journal_close(journal);
    }
    return is_open;
}

bool journal_add(Journal *journal, json_t *entry, Err *err)
{
    char *words = json_dumps(entry, LINE_FLAGS);
    assert(words != NULL);
    Text line;
    text_init(&line);
    text_append(&line, "%s\n", words);
    errno = 0;
    const ssize_t count = write(journal->file, line.data, line.length);
    // a pipe or a device has no disk to reach
    const bool is_written = count == (ssize_t)line.length &&
                            (fsync(journal->file) == 0 || errno == EINVAL || errno == EROFS);
    if (count >= 0 && count != (ssize_t)line.length) {
        errno = ENOSPC;
    }
    text_finish(&line);
    free(words);
    json_decref(entry);
    return is_written || fail(journal, "write", err);
}

void journal_close(Journal *journal)
{
    if (journal->path != NULL && journal->file >= 0) {
        work_lock_give(journal->file, 0);
        close(journal->file);
    }
    free(journal->path);
    json_decref(journal->entries);
    *journal = (Journal){.file = -1};
}

void journal_discard(Journal *journal)
{
    if (journal->path != NULL && journal->file >= 0) {
        unlink(journal->path);
    }
    journal_close(journal);
}
