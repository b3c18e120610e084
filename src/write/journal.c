// Stores finished results line by line, so that they survive the end of the program.
//
// Each line carries a checksum over the bytes before it: a bit that turned on the disk would be
// another number.
#define _GNU_SOURCE // memrchr

#include "write/journal.h"
#include "base/hash.h"
#include "base/text.h"
#include "write/file.h"

#include <assert.h>
#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static const char CHECKSUM[] = "checksum";
enum {
    OPENING_SIZE = 64,
    SEAL_SIZE = sizeof CHECKSUM + 5 + 16 + 1, // ,"checksum":"0123456789abcdef"}
};

// 17 digits bring back every number as it was
static const size_t LINE_FLAGS = JSON_REAL_PRECISION(17) | JSON_COMPACT | JSON_SORT_KEYS;

const JournalKind JOURNAL_COMPARE = {"compare", "store", "comparison", "; --fresh starts it over"};
const JournalKind JOURNAL_BLESS = {"check", "file of kept starts", "baseline", ""};

static bool journal_fail(const Journal *journal, const char *what, Err *err)
{
    return err_set(err, ERR_FILE, "cannot %s the %s %s: %s", what, journal->kind->what,
                   journal->path, strerror(errno));
}

// The whole file, with a zero behind it; owned by the caller.
static bool journal_read_all(const Journal *journal, char **content, size_t *size, Err *err)
{
    struct stat status;
    // a device is written to and has nothing to be read, or has no end
    const bool is_file = fstat(journal->file, &status) == 0 && S_ISREG(status.st_mode);
    const size_t room = is_file ? (size_t)status.st_size : 0;
    ssize_t count = 0;
    *content = malloc(room + 1);
    assert(*content != NULL);
    *size = 0;
    while (*size < room && (count = read(journal->file, *content + *size, room - *size)) > 0) {
        *size += (size_t)count;
    }
    (*content)[*size] = '\0';
    return count >= 0 || journal_fail(journal, "read", err);
}

// Takes the next line that is whole, and ends it; NULL behind the last.
static char *next_line(char **rest, const char *end)
{
    char *line = *rest;
    char *stop = memchr(line, '\n', (size_t)(end - line));
    if (stop == NULL) {
        return NULL;
    }
    *stop = '\0';
    *rest = stop + 1;
    return line;
}

// The last member of a line, behind that many bytes of it.
static void make_seal(const char *line, size_t length, char seal[SEAL_SIZE + 1])
{
    snprintf(seal, SEAL_SIZE + 1, ",\"%s\":\"%016" PRIx64 "\"}", CHECKSUM,
             hash_bytes(HASH_START, line, length));
}

// What a line holds, without its checksum; NULL where it is not what was once written. A new
// reference.
static json_t *journal_read_line(const char *line, size_t length)
{
    char seal[SEAL_SIZE + 1];
    if (length <= SEAL_SIZE) {
        return NULL;
    }
    make_seal(line, length - SEAL_SIZE, seal);
    if (memcmp(line + length - SEAL_SIZE, seal, SEAL_SIZE) != 0) {
        return NULL;
    }
    json_t *entry = json_loadb(line, length, 0, NULL);
    json_object_del(entry, CHECKSUM);
    return entry;
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

// Whether the first line, which may have been cut short, is one of this kind of store.
static bool check_opening(const Journal *journal, const char *content, size_t size, Err *err)
{
    char opening[OPENING_SIZE];
    const int length = snprintf(opening, sizeof opening, "{\"%s\":", journal->kind->name);
    return memcmp(content, opening, size < (size_t)length ? size : (size_t)length) == 0 ||
           err_set(err, ERR_FILE, "%s is not a %s of jointplay %s", journal->path,
                   journal->kind->what, journal->kind->name);
}

static bool check_key(const Journal *journal, const char *line, size_t length, const json_t *key,
                      Err *err)
{
    const JournalKind *kind = journal->kind;
    json_t *head = journal_read_line(line, length);
    // one of an older program has no checksum, and says so by its key
    json_t *other = head != NULL ? json_incref(head) : json_loads(line, 0, NULL);
    const json_t *stored = json_object_get(other, kind->name);
    Text text;
    text_init(&text);
    bool is_right = true;
    if (stored == NULL || (head == NULL && json_equal(stored, key))) {
        is_right = err_set(err, ERR_FILE, "line 1 of the %s %s is damaged%s", kind->what,
                           journal->path, kind->remedy);
    } else if (find_difference(stored, key, "", &text)) {
        is_right = err_set(err, ERR_FILE, "the %s %s is of another %s: %s%s", kind->what,
                           journal->path, kind->work, text.data, kind->remedy);
    }
    text_finish(&text);
    json_decref(head);
    json_decref(other);
    return is_right;
}

static void journal_read_entries(Journal *journal, char *rest, const char *end)
{
    size_t number = 2;
    for (char *line = next_line(&rest, end); line != NULL; line = next_line(&rest, end)) {
        json_t *entry = journal_read_line(line, (size_t)(rest - 1 - line));
        if (entry == NULL) {
            journal->damaged_line = journal->damaged_count == 0 ? number : journal->damaged_line;
            journal->damaged_count++;
            entry = json_null();
        }
        json_array_append_new(journal->entries, entry);
        number++;
    }
}

// Takes in what stands in the store, up to the last line that is whole.
static bool take_in(Journal *journal, json_t *key, bool is_fresh, Err *err)
{
    char *content;
    size_t size;
    bool is_done = journal_read_all(journal, &content, &size, err) &&
                   check_opening(journal, content, size, err);
    const char *last = memrchr(content, '\n', size);
    const char *end = last == NULL ? content : last + 1;
    char *rest = content;
    const char *head = next_line(&rest, end);
    if (is_done && head != NULL && !is_fresh) {
        is_done = check_key(journal, head, (size_t)(rest - 1 - head), key, err);
        journal_read_entries(journal, rest, end);
    }
    is_done = is_done && (ftruncate(journal->file, is_fresh ? 0 : end - content) == 0 ||
                          journal_fail(journal, "cut", err));
    if (is_done && (is_fresh || head == NULL)) {
        is_done = journal_add(journal, json_pack("{s:O}", journal->kind->name, key), err);
    }
    free(content);
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
    bool is_open = journal->file >= 0 || journal_fail(journal, "open", err);
    if (is_open && work_lock_take(journal->file, 0) != 0) {
        is_open =
            err_set(err, ERR_FILE, "the %s %s is in use by another process", kind->what, path);
    }
    is_open = is_open && take_in(journal, key, is_fresh, err);
    if (!is_open) {
        journal_close(journal);
    }
    return is_open;
}

void journal_describe_damage(const Journal *journal, Text *text)
{
    if (journal->damaged_count == 0) {
        return;
    }
    text_append(text, "line %zu of the %s ", journal->damaged_line, journal->kind->what);
    text_append_shown(text, journal->path);
    if (journal->damaged_count > 1) {
        text_append(text, ", as %zu others,", journal->damaged_count - 1);
    }
    text_append(text, " is damaged and not used; its run is repeated\n");
}

// A line that does not fit is written as far as it does, and the reason is that of the rest.
static bool journal_write_all(int file, const char *bytes, size_t size)
{
    ssize_t count = 0;
    for (size_t sent = 0; sent < size && count >= 0; sent += count > 0 ? (size_t)count : 0) {
        count = write(file, bytes + sent, size - sent);
        count = count < 0 && errno == EINTR ? 0 : count;
    }
    return count >= 0;
}

bool journal_add(Journal *journal, json_t *entry, Err *err)
{
    char *words = json_dumps(entry, LINE_FLAGS);
    assert(words != NULL);
    char seal[SEAL_SIZE + 1];
    const size_t length = strlen(words) - 1;
    make_seal(words, length, seal);
    Text line;
    text_init(&line);
    text_append(&line, "%.*s%s\n", (int)length, words, seal);
    // a pipe or a device has no disk to reach
    const bool is_written = (journal_write_all(journal->file, line.data, line.length) &&
                             (fsync(journal->file) == 0 || errno == EINVAL || errno == EROFS)) ||
                            journal_fail(journal, "write", err);
    text_finish(&line);
    free(words);
    json_decref(entry);
    return is_written;
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
