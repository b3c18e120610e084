// One test a row of a table of bad documents: each must be refused with the message of its row.
//
// A table is text. A row begins with `=== NAME`, has a document below that, then a line `>>>` and
// the message, of a file NAME.yaml. `=== NAME, as OTHER but` needs only the lines that differ from
// the document of `=== OTHER, which is good`: a line takes the place of the one with the same key
// at the same indentation; what has no such line comes below the line before it in the row, or at
// the end.
// `<0x1b>` is a byte that text cannot hold. With --write the messages are written into the table,
// to be read in the difference to what was there before; with --files FOLDER the documents are.
#pragma once

#include "base/err.h"

#include "close.h"

#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum {
    BAD_TABLE_SIZE = 1 << 20,
    BAD_DOCUMENT_SIZE = 1 << 16,
    BAD_ROWS_MOST = 1000,
    BAD_NAME_SIZE = 128
};

typedef struct BadRow {
    char name[BAD_NAME_SIZE];
    char other[BAD_NAME_SIZE]; // whose lines it changes, or ""
    bool is_good;              // a document for others to change
    const char *head;          // its line in the table, and
    const char *lines;         // those of its document, up to
    const char *message;       // `>>>`: what follows that, or NULL
    const char *end;
} BadRow;

// What opens a file, NULL where it is accepted whole.
typedef bool BadOpen(const char *path, Err *err);

static char bad_table[BAD_TABLE_SIZE];
static BadRow bad_rows[BAD_ROWS_MOST];
static int bad_row_count;
static BadOpen *bad_open;

static inline const char *bad_line_end(const char *line)
{
    const char *end = strchr(line, '\n');
    return end == NULL ? strchr(line, '\0') : end + 1;
}

// The length of what names a line: its indentation and key, or 0 where it has none.
static inline size_t bad_key_length(const char *line)
{
    const size_t length = strcspn(line, ":\n");
    return line[length] == ':' ? length + 1 : 0;
}

static inline const BadRow *bad_row_find(const char *name)
{
    for (int i = 0; i < bad_row_count; i++) {
        if (strcmp(bad_rows[i].name, name) == 0) {
            return &bad_rows[i];
        }
    }
    return NULL;
}

// Takes the table apart; ends the program where it is no table.
static inline void bad_rows_read(void)
{
    BadRow *row = NULL;
    for (const char *line = bad_table; *line != '\0'; line = bad_line_end(line)) {
        if (strncmp(line, "=== ", 4) == 0) {
            assert_true(bad_row_count < BAD_ROWS_MOST);
            row = &bad_rows[bad_row_count];
            *row = (BadRow){.head = line, .lines = bad_line_end(line)};
            char rest[32] = "";
            sscanf(line, "=== %127[^,\n], as %127[^ \n] but", row->name, row->other);
            sscanf(line, "=== %*[^,\n], %31[^\n]", rest);
            row->is_good = strcmp(rest, "which is good") == 0;
            assert_null(bad_row_find(row->name));
            bad_row_count++;
        } else if (row != NULL && row->message == NULL && strncmp(line, ">>>\n", 4) == 0) {
            row->message = bad_line_end(line);
        }
        if (row != NULL) {
            row->end = bad_line_end(line);
        }
    }
}

// Puts `size` bytes in place of `old_size` at a place of a document.
static inline void bad_replace(char *document, char *at, size_t old_size, const char *text,
                               size_t size)
{
    const size_t rest = strlen(at + old_size) + 1;
    assert_true((size_t)(at - document) + size + rest <= BAD_DOCUMENT_SIZE);
    memmove(at + size, at + old_size, rest);
    memcpy(at, text, size);
}

// The line of a document that has the key of a given one, or NULL.
static inline char *bad_line_of_key(char *document, const char *given)
{
    const size_t length = bad_key_length(given);
    for (char *line = document; length > 0 && *line != '\0'; line += strcspn(line, "\n") + 1) {
        if (strncmp(line, given, length) == 0) {
            return line;
        }
    }
    return NULL;
}

// The bytes of a row's document, of which there are as many as it returns.
static inline size_t bad_document(const BadRow *row, char document[BAD_DOCUMENT_SIZE])
{
    const char *end = row->message == NULL ? row->end : row->message - strlen(">>>\n");
    // between two rows is an empty line
    end -= row->message == NULL && row->end[0] != '\0' ? 1 : 0;
    document[0] = '\0';
    if (row->other[0] != '\0') {
        const BadRow *other = bad_row_find(row->other);
        assert_non_null(other);
        assert_true(other->is_good);
        bad_document(other, document);
    }
    char *at = strchr(document, '\0');
    for (const char *line = row->lines; line < end; line = bad_line_end(line)) {
        const size_t size = (size_t)(bad_line_end(line) - line);
        char *same = row->other[0] == '\0' ? NULL : bad_line_of_key(document, line);
        at = same == NULL ? at : same;
        bad_replace(document, at, same == NULL ? 0 : strcspn(same, "\n") + 1, line, size);
        at += size;
    }
    size_t size = 0;
    for (const char *from = document; *from != '\0'; size++) {
        unsigned byte = 0;
        int length = 0;
        if (sscanf(from, "<0x%2x>%n", &byte, &length) != 1 || length == 0) {
            byte = (unsigned char)*from;
            length = 1;
        }
        from += length;
        document[size] = (char)byte;
    }
    return size;
}

// Writes the document of a row into a folder.
static inline void bad_file_write(const BadRow *row, const char *folder)
{
    static char document[BAD_DOCUMENT_SIZE];
    char path[PATH_MAX];
    snprintf(path, sizeof path, "%s/%.*s.yaml", folder, BAD_NAME_SIZE, row->name);
    const size_t size = bad_document(row, document);
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(document, 1, size, file), size);
    assert_int_equal(fclose(file), 0);
}

// The message that a row has now, or that it is good.
static inline void bad_row_open(const BadRow *row, Err *err)
{
    char path[PATH_MAX];
    // in a folder that is named, beside which another file may be
    snprintf(path, sizeof path, "./%.*s.yaml", BAD_NAME_SIZE, row->name);
    bad_file_write(row, ".");
    assert_int_equal(bad_open(path, err), row->is_good);
    assert_int_equal(err->kind, row->is_good ? ERR_NONE : ERR_CASE);
    // a message begins with the name of the file
    const size_t folder = strncmp(err->text, "./", 2) == 0 ? 2 : 0;
    memmove(err->text, err->text + folder, strlen(err->text + folder) + 1);
}

static inline void bad_row_check(void **state)
{
    const BadRow *row = *state;
    Err err = {0};
    bad_row_open(row, &err);
    if (row->is_good) {
        return;
    }
    if (row->message == NULL) {
        fail_msg("%s has no message", row->name);
    }
    // between two rows is an empty line
    const char *end = row->end[0] == '\0' ? row->end : row->end - 1;
    char expected[ERR_TEXT_SIZE + 2];
    snprintf(expected, sizeof expected, "%.*s", (int)(end - row->message), row->message);
    char message[ERR_TEXT_SIZE + 2];
    snprintf(message, sizeof message, "%s\n", err.text);
    assert_string_equal(message, expected);
}

// Writes the table anew, with the messages that its rows have now.
static inline void bad_table_write(FILE *file)
{
    fprintf(file, "%.*s", (int)(bad_rows[0].head - bad_table), bad_table);
    for (int i = 0; i < bad_row_count; i++) {
        const BadRow *row = &bad_rows[i];
        Err err = {0};
        bad_row_open(row, &err);
        const char *end = row->message == NULL ? row->end : row->message;
        end -= row->message == NULL && row->end[0] != '\0' ? 1 : 0;
        const char *last = row->end[0] == '\0' ? "" : "\n";
        if (row->is_good) {
            fprintf(file, "%.*s", (int)(row->end - row->head), row->head);
        } else {
            fprintf(file, "%.*s%s%s\n%s", (int)(end - row->head), row->head,
                    row->message == NULL ? ">>>\n" : "", err.text, last);
        }
    }
}

// Reads a table, and in a folder of its own, which has the cases of the sources, runs a test for
// every row, or does what an option asks for.
static inline int bad_table_run(int argc, char **argv, const char *table, BadOpen *open)
{
    char root[PATH_MAX];
    char path[PATH_MAX + 128];
    char folder[] = "/tmp/jointplay-bad-XXXXXX";
    assert_non_null(getcwd(root, sizeof root));
    snprintf(path, sizeof path, "%s/%s", root, table);
    FILE *file = fopen(path, "rb");
    if (file == NULL) {
        fprintf(stderr, "no %s here; run from the source root\n", table);
        return 1;
    }
    const size_t size = fread(bad_table, 1, sizeof bad_table - 1, file);
    fclose(file);
    assert_true(size < sizeof bad_table - 1);
    bad_rows_read();
    if (argc == 3 && strcmp(argv[1], "--files") == 0) {
        for (int i = 0; i < bad_row_count; i++) {
            bad_file_write(&bad_rows[i], argv[2]);
        }
        return 0;
    }
    bad_open = open;
    assert_non_null(mkdtemp(folder));
    assert_int_equal(chdir(folder), 0);
    char cases[PATH_MAX + 16];
    snprintf(cases, sizeof cases, "%s/cases", root);
    assert_int_equal(symlink(cases, "cases"), 0);
    int failed = 0;
    if (argc == 2 && strcmp(argv[1], "--write") == 0) {
        file = fopen(path, "wb");
        assert_non_null(file);
        bad_table_write(file);
        assert_int_equal(fclose(file), 0);
    } else {
        static struct CMUnitTest tests[BAD_ROWS_MOST];
        for (int i = 0; i < bad_row_count; i++) {
            tests[i] = (struct CMUnitTest){.name = bad_rows[i].name,
                                           .test_func = bad_row_check,
                                           .initial_state = &bad_rows[i]};
        }
        // what the macro does, for a number of tests known only now
        failed = _cmocka_run_group_tests(table, tests, (size_t)bad_row_count, NULL, NULL);
    }
    for (int i = 0; i < bad_row_count; i++) {
        snprintf(path, sizeof path, "%.*s.yaml", BAD_NAME_SIZE, bad_rows[i].name);
        remove(path);
    }
    remove("cases");
    assert_int_equal(chdir(root), 0);
    rmdir(folder);
    return failed;
}
