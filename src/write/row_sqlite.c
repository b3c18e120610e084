// Writes a table as an SQLite file.
//
// SQLite writes into the file beside the target that write/file.h has made, which takes the
// target's name when all of it stands: no journal is needed, for a file that was not finished is
// thrown away. Columns have no declared type: one declared REAL would store -0.0 as the whole
// number 0 and lose its sign. What they hold is of the storage class REAL, or TEXT, or NULL.
#include "base/zeroed.h"
#include "write/row_file.h"

#include <assert.h>
#include <errno.h>
#include <math.h>
#include <sqlite3.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>

enum { ROW_SQLITE_APPLICATION = 0x4a505352 }; // "JPSR"; stands in the file as application_id

typedef struct RowBase {
    sqlite3 *base;
    sqlite3_stmt *insert;
} RowBase;

static RowBase *base_of(const RowFile *file)
{
    return file->own;
}

// The errno of SQLite's last failure; EIO where there is none.
static int reason_of(sqlite3 *base)
{
    const int code = sqlite3_errcode(base) & 0xff;
    int reason = sqlite3_system_errno(base);
    if (reason == 0) {
        // after a failed commit only the file control has it
        sqlite3_file_control(base, "main", SQLITE_FCNTL_LAST_ERRNO, &reason);
    }
    return code == SQLITE_FULL    ? ENOSPC
           : code == SQLITE_NOMEM ? ENOMEM
           : reason != 0          ? reason
                                  : EIO;
}

// Remembers the first failure.
static void note(RowFile *file, bool is_good)
{
    if (!is_good && file->file.sink.reason == 0) {
        file->file.sink.reason = reason_of(base_of(file)->base);
    }
}

static void run_sql(RowFile *file, const char *sql)
{
    if (file->file.sink.reason == 0) {
        note(file, sqlite3_exec(base_of(file)->base, sql, NULL, NULL, NULL) == SQLITE_OK);
    }
}

static void append_quoted(Text *sql, const char *name)
{
    text_append(sql, "\"");
    for (; *name != '\0'; name++) {
        text_append(sql, *name == '"' ? "\"\"" : "%c", *name);
    }
    text_append(sql, "\"");
}

static void make_table(RowFile *file)
{
    Text sql;
    text_init(&sql);
    text_append(&sql, "CREATE TABLE ");
    append_quoted(&sql, file->head.table);
    for (size_t i = 0; i < file->head.count; i++) {
        text_append(&sql, i == 0 ? "(" : ", ");
        append_quoted(&sql, file->head.names[i]);
    }
    text_append(&sql, ")");
    run_sql(file, sql.data);
    text_finish(&sql);
}

static void prepare_insert(RowFile *file)
{
    Text sql;
    text_init(&sql);
    text_append(&sql, "INSERT INTO ");
    append_quoted(&sql, file->head.table);
    for (size_t i = 0; i < file->head.count; i++) {
        text_append(&sql, i == 0 ? " VALUES(?" : ", ?");
    }
    text_append(&sql, ")");
    if (file->file.sink.reason == 0) {
        note(file, sqlite3_prepare_v2(base_of(file)->base, sql.data, -1, &base_of(file)->insert,
                                      NULL) == SQLITE_OK);
    }
    text_finish(&sql);
}

static void sqlite_begin(RowFile *file)
{
    RowBase *own = zeroed(1, sizeof *own);
    file->own = own;
    // a name that begins with a colon or "file:" is a file's all the same
    Text path;
    text_init(&path);
    text_append(&path, "%s%s", file->file.temporary[0] == '/' ? "" : "./", file->file.temporary);
    note(file, sqlite3_open_v2(path.data, &own->base, SQLITE_OPEN_READWRITE | SQLITE_OPEN_NOMUTEX,
                               NULL) == SQLITE_OK);
    text_finish(&path);
    char sql[160];
    snprintf(
        sql, sizeof sql,
        "PRAGMA journal_mode = OFF; PRAGMA synchronous = OFF; PRAGMA application_id = %d; BEGIN",
        ROW_SQLITE_APPLICATION);
    run_sql(file, sql);
    make_table(file);
    prepare_insert(file);
}

static void sqlite_number(RowFile *file, double value)
{
    const int parameter = (int)file->cell + 1;
    if (file->file.sink.reason == 0) {
        note(file,
             (isfinite(value) ? sqlite3_bind_double(base_of(file)->insert, parameter, value)
                              : sqlite3_bind_null(base_of(file)->insert, parameter)) == SQLITE_OK);
    }
}

static void sqlite_word(RowFile *file, const char *text)
{
    if (file->file.sink.reason == 0) {
        note(file, sqlite3_bind_text(base_of(file)->insert, (int)file->cell + 1, text, -1,
                                     SQLITE_TRANSIENT) == SQLITE_OK);
    }
}

static void sqlite_end_row(RowFile *file)
{
    if (file->file.sink.reason == 0) {
        note(file, sqlite3_step(base_of(file)->insert) == SQLITE_DONE);
        sqlite3_reset(base_of(file)->insert);
    }
}

static void sqlite_end(RowFile *file)
{
    sqlite3_finalize(base_of(file)->insert);
    run_sql(file, "COMMIT");
    note(file, sqlite3_close(base_of(file)->base) == SQLITE_OK);
    free(file->own);
}

// What an SQLite of this build allows.
static size_t columns_most(void)
{
    sqlite3 *base = NULL;
    int most = 0;
    if (sqlite3_open(":memory:", &base) == SQLITE_OK) {
        const int columns = sqlite3_limit(base, SQLITE_LIMIT_COLUMN, -1);
        const int parameters = sqlite3_limit(base, SQLITE_LIMIT_VARIABLE_NUMBER, -1);
        most = columns < parameters ? columns : parameters;
    }
    sqlite3_close(base);
    return (size_t)most;
}

static int compare_names(const void *a, const void *b)
{
    return strcasecmp(*(const char *const *)a, *(const char *const *)b);
}

// SQLite takes names that differ in large and small letters alone for one.
static bool check_names(const char *user, const char *path, const RowHead *head, Err *err)
{
    const char **names = malloc(head->count * sizeof *names);
    assert(names != NULL);
    memcpy(names, head->names, head->count * sizeof *names);
    qsort(names, head->count, sizeof *names, compare_names);
    bool is_good = true;
    for (size_t i = 1; i < head->count && is_good; i++) {
        is_good = strcasecmp(names[i - 1], names[i]) != 0 ||
                  err_set(err, ERR_USAGE,
                          "%s cannot write %s: SQLite takes the columns '%s' and '%s' for one; "
                          "write .csv or .jsonl",
                          user, path, names[i - 1], names[i]);
    }
    free(names);
    return is_good;
}

// SQLite would apply such a file, which belongs to what stood there before, to the new one.
static bool check_beside(const char *user, const char *path, Err *err)
{
    static const char *const ENDINGS[] = {"-journal", "-wal"};
    char *resolved = realpath(path, NULL);
    bool is_good = true;
    for (size_t i = 0; i < sizeof ENDINGS / sizeof *ENDINGS && is_good; i++) {
        Text beside;
        struct stat status;
        text_init(&beside);
        text_append(&beside, "%s%s", resolved != NULL ? resolved : path, ENDINGS[i]);
        is_good = lstat(beside.data, &status) != 0 ||
                  err_set(err, ERR_FILE,
                          "%s cannot write %s: SQLite would take the file %s next to it for a part "
                          "of it; move that away",
                          user, path, beside.data);
        text_finish(&beside);
    }
    free(resolved);
    return is_good;
}

static bool sqlite_check(const char *user, const char *path, const RowHead *head, Err *err)
{
    if (file_is_stream(path)) {
        return err_set(err, ERR_USAGE,
                       "%s cannot write SQLite to %s, which is no regular file; a pipe or a device "
                       "takes .csv and .jsonl",
                       user, path);
    }
    const size_t most = columns_most();
    if (head->count > most) {
        return err_set(
            err, ERR_USAGE,
            "%s cannot write %s: it would have %zu columns, and a table of SQLite has at "
            "most %zu; choose some with --columns, or write .csv or .jsonl",
            user, path, head->count, most);
    }
    return check_names(user, path, head, err) && check_beside(user, path, err);
}

const RowForm row_form_sqlite = {
    .ending = ".sqlite",
    .kind = FILE_DATABASE,
    .check = sqlite_check,
    .begin = sqlite_begin,
    .number = sqlite_number,
    .word = sqlite_word,
    .end_row = sqlite_end_row,
    .end = sqlite_end,
};
