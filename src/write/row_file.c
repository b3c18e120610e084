// Writes a table as CSV or JSON Lines, and finds the form that a file's name asks for.
#include "write/row_file.h"
#include "base/zeroed.h"
#include "write/csv.h"
#include "write/json_value.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

// CSV: the names of the columns, then a line a row.

static void csv_begin(RowFile *file)
{
    for (size_t i = 0; i < file->head.count; i++) {
        fputs(i > 0 ? "," : "", file->file.stream);
        csv_write_word(file->file.stream, file->head.names[i]);
    }
    fputc('\n', file->file.stream);
}

static void csv_number(RowFile *file, double value)
{
    text_append(&file->row, file->cell > 0 ? "," : "");
    if (isfinite(value)) {
        text_append_number(&file->row, value);
    }
}

// Words are rare: what stands in the row so far goes before them.
static void csv_word(RowFile *file, const char *text)
{
    fputs(file->row.data, file->file.stream);
    fputs(file->cell > 0 ? "," : "", file->file.stream);
    csv_write_word(file->file.stream, text);
    file->row.length = 0;
    file->row.data[0] = '\0';
}

static void text_end_row(RowFile *file)
{
    text_append(&file->row, "\n");
    fwrite(file->row.data, 1, file->row.length, file->file.stream);
    file->row.length = 0;
    file->row.data[0] = '\0';
}

static const RowForm ROW_FORM_CSV = {
    .ending = ".csv",
    .kind = FILE_TABLE,
    .begin = csv_begin,
    .number = csv_number,
    .word = csv_word,
    .end_row = text_end_row,
};

// JSON Lines: an object a row.

static void append_word(Text *row, const char *word)
{
    json_t *value = json_value_text(word);
    json_value_write(value, JSON_ENCODE_ANY | JSON_COMPACT, row);
    json_decref(value);
}

// The columns as they stand before their values: {"time_s": and ,"crank_deg":
static void jsonl_begin(RowFile *file)
{
    Text *keys = zeroed(file->head.count, sizeof *keys);
    for (size_t i = 0; i < file->head.count; i++) {
        text_init(&keys[i]);
        text_append(&keys[i], i > 0 ? "," : "{");
        append_word(&keys[i], file->head.names[i]);
        text_append(&keys[i], ":");
    }
    file->own = keys;
}

static void jsonl_end(RowFile *file)
{
    Text *keys = file->own;
    for (size_t i = 0; i < file->head.count; i++) {
        text_finish(&keys[i]);
    }
    free(keys);
}

static void append_key(RowFile *file)
{
    const Text *keys = file->own;
    text_append_bytes(&file->row, keys[file->cell].data, keys[file->cell].length);
}

// Readers take a number without a point for a whole one, whose zero has no sign.
static void jsonl_number(RowFile *file, double value)
{
    append_key(file);
    if (!isfinite(value)) {
        text_append(&file->row, "null");
    } else if (value == 0.0) {
        text_append(&file->row, signbit(value) ? "-0.0" : "0.0");
    } else {
        text_append_number(&file->row, value);
    }
}

static void jsonl_word(RowFile *file, const char *text)
{
    append_key(file);
    append_word(&file->row, text);
}

static void jsonl_end_row(RowFile *file)
{
    text_append(&file->row, "}");
    text_end_row(file);
}

static const RowForm ROW_FORM_JSONL = {
    .ending = ".jsonl",
    .kind = FILE_ROWS,
    .begin = jsonl_begin,
    .number = jsonl_number,
    .word = jsonl_word,
    .end_row = jsonl_end_row,
    .end = jsonl_end,
};

// The form that a name asks for.

static const RowForm *const FORMS[] = {&ROW_FORM_CSV, &ROW_FORM_JSONL, &row_form_sqlite};
enum { FORM_COUNT = sizeof FORMS / sizeof *FORMS };

// Where CSV under such a name would be a surprise.
static const char *const OTHER_ENDINGS[] = {".json", ".ndjson", ".db", ".sqlite3"};
enum { OTHER_COUNT = sizeof OTHER_ENDINGS / sizeof *OTHER_ENDINGS };

static const char *ending_of(const char *path)
{
    const char *slash = strrchr(path, '/');
    const char *dot = strrchr(slash == NULL ? path : slash, '.');
    return dot == NULL ? "" : dot;
}

// Any other ending, and none, is CSV.
static const RowForm *find_form(const char *path)
{
    for (size_t i = 0; i < FORM_COUNT; i++) {
        if (strcasecmp(ending_of(path), FORMS[i]->ending) == 0) {
            return FORMS[i];
        }
    }
    return &ROW_FORM_CSV;
}

static bool check_ending(const char *user, const char *path, Err *err)
{
    for (size_t i = 0; i < OTHER_COUNT; i++) {
        if (strcasecmp(ending_of(path), OTHER_ENDINGS[i]) == 0) {
            return err_set(err, ERR_USAGE,
                           "%s does not write %s: name the file .csv, .jsonl for JSON Lines or "
                           ".sqlite for SQLite",
                           user, path);
        }
    }
    return true;
}

static bool check_form(const char *user, const char *path, const RowHead *head, Err *err)
{
    const RowForm *form = find_form(path);
    return check_ending(user, path, err) &&
           (form->check == NULL || form->check(user, path, head, err));
}

bool row_file_claim(const char *user, const char *path, const RowHead *head, Err *err)
{
    return file_check_input(user, path, err) && check_form(user, path, head, err) &&
           file_claim(user, find_form(path)->kind, path, err);
}

bool row_file_begin(RowFile *file, const char *path, const RowHead *head, Err *err)
{
    *file = (RowFile){.form = find_form(path), .head = *head};
    if (!check_form("the output", path, head, err) ||
        !file_begin(&file->file, file->form->kind, path, err)) {
        return false;
    }
    text_init(&file->row);
    file->form->begin(file);
    return true;
}

void row_file_number(RowFile *file, double value)
{
    assert(file->cell < file->head.count);
    file->form->number(file, value);
    file->cell++;
}

void row_file_word(RowFile *file, const char *text)
{
    assert(file->cell < file->head.count);
    file->form->word(file, text);
    file->cell++;
}

void row_file_end_row(RowFile *file)
{
    assert(file->cell == file->head.count);
    file->form->end_row(file);
    file->cell = 0;
}

bool row_file_end(RowFile *file, Err *err)
{
    if (file->form->end != NULL) {
        file->form->end(file);
    }
    text_finish(&file->row);
    return file_end(&file->file, err);
}
