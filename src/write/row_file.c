// Writes a table as CSV.
#include "write/row_file.h"
#include "write/csv.h"

#include <assert.h>
#include <math.h>
#include <string.h>
#include <strings.h>

// Where CSV under such a name would be a surprise.
static const char *const OTHER_ENDINGS[] = {".json",   ".jsonl",   ".ndjson",  ".db",
                                            ".sqlite", ".sqlite3", ".parquet", ".xlsx"};
enum { OTHER_COUNT = sizeof OTHER_ENDINGS / sizeof *OTHER_ENDINGS };

static bool check_ending(const char *user, const char *path, Err *err)
{
    const char *slash = strrchr(path, '/');
    const char *dot = strrchr(slash == NULL ? path : slash, '.');
    for (size_t i = 0; i < OTHER_COUNT && dot != NULL; i++) {
        if (strcasecmp(dot, OTHER_ENDINGS[i]) == 0) {
            return err_set(err, ERR_USAGE, "%s writes CSV, not %s: name the file FILE.csv", user,
                           path);
        }
    }
    return true;
}

bool row_file_claim(const char *user, const char *path, Err *err)
{
    return file_check_input(user, path, err) && check_ending(user, path, err) &&
           file_claim(user, FILE_TABLE, path, err);
}

bool row_file_begin(RowFile *file, const char *path, const char *const *names, size_t count,
                    Err *err)
{
    *file = (RowFile){.count = count};
    if (!check_ending("the output", path, err) || !file_begin(&file->file, FILE_TABLE, path, err)) {
        return false;
    }
    text_init(&file->row);
    for (size_t i = 0; i < count; i++) {
        fputs(i > 0 ? "," : "", file->file.stream);
        csv_write_word(file->file.stream, names[i]);
    }
    fputc('\n', file->file.stream);
    return true;
}

void row_file_number(RowFile *file, double value)
{
    assert(file->cell < file->count);
    text_append(&file->row, file->cell > 0 ? "," : "");
    if (isfinite(value)) {
        text_append_number(&file->row, value);
    }
    file->cell++;
}

static void write_row(RowFile *file)
{
    fwrite(file->row.data, 1, file->row.length, file->file.stream);
    file->row.length = 0;
    file->row.data[0] = '\0';
}

// Words are rare: what stands in the row so far goes before them.
void row_file_word(RowFile *file, const char *text)
{
    assert(file->cell < file->count);
    write_row(file);
    fputs(file->cell > 0 ? "," : "", file->file.stream);
    csv_write_word(file->file.stream, text);
    file->cell++;
}

void row_file_end_row(RowFile *file)
{
    assert(file->cell == file->count);
    text_append(&file->row, "\n");
    write_row(file);
    file->cell = 0;
}

bool row_file_end(RowFile *file, Err *err)
{
    text_finish(&file->row);
    return file_end(&file->file, err);
}
