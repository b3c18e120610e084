// How does a run become a row, and the row the run again, bit for bit?
//
// SQLite has no checksums: a bit that turned on the disk would be another number. So each row
// carries one of its own over all that is written, 32 bits of it. NAN is NULL. The sign of a zero
// is lost: a REAL without a fraction is kept as a whole number, which also makes it short.
//
// Rows are read in portions, and the file is unlocked in between, so that a reader never blocks the
// process that writes.
#include "base/hash.h"
#include "commands/study/store_inside.h"

#include <assert.h>
#include <inttypes.h>
#include <math.h>
#include <sqlite3.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { PORTION = 64 }; // rows at a time, of some 5 kB each

// Whole numbers of this size and below have a double of their own.
static const double WHOLE_MAX = 9007199254740992.0; // 2^53

static uint64_t hash_value(uint64_t hash, double value)
{
    // one NAN and one zero of each kind; the sum makes a zero positive
    return hash_number(hash, isnan(value) ? (double)NAN : value + 0.0);
}

static int32_t make_checksum(const Layout *layout, const Record *record)
{
    uint64_t hash = hash_number(HASH_START, (double)record->run);
    hash = hash_number(hash, record->outcome);
    hash = hash_bytes(hash, record->reason, strlen(record->reason));
    for (size_t i = 0; i < layout->setting_count; i++) {
        const Cell *cell = &record->settings[i];
        hash = layout->settings[i].kind == COLUMN_WORD
                   ? hash_bytes(hash, cell->word, strlen(cell->word) + 1)
                   : hash_value(hash, cell->number);
    }
    for (size_t i = 0; i < layout->result_count; i++) {
        hash = hash_value(hash, record->results[i]);
    }
    hash = hash_bytes(hash, &record->hash, sizeof record->hash);
    return (int32_t)(uint32_t)(hash >> 32);
}

int32_t store_row_effort_checksum(uint64_t run, double wall_s)
{
    const uint64_t hash = hash_value(hash_number(HASH_START, (double)run), wall_s);
    return (int32_t)(uint32_t)(hash >> 32);
}

static bool is_same_number(double a, double b)
{
    return a == b || (isnan(a) && isnan(b));
}

bool store_row_is_same(const Layout *layout, const Record *a, const Record *b)
{
    bool is_same = a->run == b->run && a->outcome == b->outcome && a->hash == b->hash;
    RecordField field;
    for (size_t i = 0; record_field(layout, i, &field) && field.kind != COLUMN_HASH; i++) {
        const bool is_text = field.kind == COLUMN_WORD || field.kind == COLUMN_REASON;
        const bool is_number = field.kind == COLUMN_REAL || field.kind == COLUMN_WHOLE;
        is_same =
            is_same && (!is_text || strcmp(record_text(a, &field), record_text(b, &field)) == 0) &&
            (!is_number || is_same_number(record_number(a, &field), record_number(b, &field)));
    }
    return is_same;
}

static void bind_number(sqlite3_stmt *statement, int parameter, double value, ColumnKind kind)
{
    if (kind == COLUMN_WHOLE && fabs(value) <= WHOLE_MAX && value == rint(value)) {
        sqlite3_bind_int64(statement, parameter, (sqlite3_int64)value);
    } else {
        sqlite3_bind_double(statement, parameter, value);
    }
}

void store_row_bind(const Layout *layout, sqlite3_stmt *statement, const Record *record)
{
    int parameter = 1;
    RecordField field = {.kind = COLUMN_RUN};
    for (size_t i = 0; field.kind != COLUMN_HASH; i++, parameter++) {
        record_field(layout, i, &field);
        switch (field.kind) {
        case COLUMN_RUN:
            sqlite3_bind_int64(statement, parameter, (sqlite3_int64)record->run);
            break;
        case COLUMN_FATE:
            sqlite3_bind_int(statement, parameter, (int)record->outcome);
            break;
        case COLUMN_WORD:
            sqlite3_bind_text(statement, parameter, record_text(record, &field), -1, SQLITE_STATIC);
            break;
        case COLUMN_REASON:
            sqlite3_bind_text(statement, parameter,
                              record->reason[0] == '\0' ? NULL : record->reason, -1, SQLITE_STATIC);
            break;
        case COLUMN_HASH:
            sqlite3_bind_int64(statement, parameter, (sqlite3_int64)record->hash);
            break;
        case COLUMN_REAL:
        case COLUMN_WHOLE:
            bind_number(statement, parameter, record_number(record, &field), field.kind);
            break;
        }
    }
    sqlite3_bind_int(statement, parameter, make_checksum(layout, record));
}

bool store_row_prepare(Store *store, sqlite3_stmt **statement, Err *err)
{
    return store_prepare(store,
                         "SELECT run.*, effort.wall_s, effort.checksum FROM run LEFT JOIN effort "
                         "USING (run) WHERE run.run > ? ORDER BY run.run LIMIT ?",
                         statement, err);
}

static double column_number(sqlite3_stmt *statement, int column)
{
    return sqlite3_column_type(statement, column) == SQLITE_NULL
               ? NAN
               : sqlite3_column_double(statement, column);
}

bool store_row_take(const Store *store, sqlite3_stmt *statement, Record *record, Err *err)
{
    int column = 0;
    int outcome = 0;
    RecordField field = {.kind = COLUMN_RUN};
    for (size_t i = 0; field.kind != COLUMN_HASH; i++, column++) {
        record_field(store->layout, i, &field);
        void *target = record_target(record, &field);
        switch (field.kind) {
        case COLUMN_RUN:
        case COLUMN_HASH:
            *(uint64_t *)target = (uint64_t)sqlite3_column_int64(statement, column);
            break;
        case COLUMN_FATE:
            outcome = sqlite3_column_int(statement, column);
            record->outcome = (RunOutcome)outcome;
            break;
        case COLUMN_WORD:
            store_take_words(statement, column, target, RECORD_WORD_SIZE);
            break;
        case COLUMN_REASON:
            store_take_words(statement, column, target, RECORD_REASON_SIZE);
            break;
        case COLUMN_REAL:
        case COLUMN_WHOLE:
            *(double *)target = column_number(statement, column);
            break;
        }
    }
    const sqlite3_int64 checksum = sqlite3_column_int64(statement, column++);
    record->wall_s = column_number(statement, column++);
    const bool is_effort = sqlite3_column_type(statement, column) != SQLITE_NULL &&
                           sqlite3_column_int64(statement, column) ==
                               store_row_effort_checksum(record->run, record->wall_s);
    if (outcome >= 0 && outcome < RUN_OUTCOME_COUNT && is_effort &&
        checksum == make_checksum(store->layout, record)) {
        return true;
    }
    char words[STORE_WORDS_SIZE];
    snprintf(words, sizeof words,
             "run %" PRIu64 " does not match its checksum; 'jointplay study FILE --retry-failed' "
             "makes it again",
             record->run);
    return store_fail_damaged(store, words, err);
}

// Reads the rows behind a number into the portion; their count.
static bool read_portion(Store *store, sqlite3_int64 behind, Record *portion, size_t *count,
                         Err *err)
{
    sqlite3_bind_int64(store->rows, 1, behind);
    sqlite3_bind_int(store->rows, 2, PORTION);
    *count = 0;
    int status;
    bool is_read = true;
    while (is_read && (status = sqlite3_step(store->rows)) == SQLITE_ROW) {
        is_read = store_row_take(store, store->rows, &portion[*count], err);
        // a damaged tree may come back to where it was
        if (is_read && (sqlite3_int64)portion[*count].run <= behind) {
            is_read = store_fail_damaged(store, "its runs are out of order", err);
        }
        behind = (sqlite3_int64)portion[*count].run;
        (*count)++;
    }
    is_read = is_read && (status == SQLITE_DONE || store_fail(store, "read", err));
    sqlite3_reset(store->rows);
    return is_read;
}

bool store_each(Store *store, StoreTaker take, void *context, Err *err)
{
    if (!store_file_check(store, err) || !store_row_prepare(store, &store->rows, err)) {
        return false;
    }
    Record *portion = calloc(PORTION, sizeof *portion);
    assert(portion != NULL);
    sqlite3_int64 behind = -1;
    size_t count = PORTION;
    bool is_done = true;
    while (is_done && count == PORTION) {
        is_done = read_portion(store, behind, portion, &count, err);
        for (size_t i = 0; i < count && is_done; i++) {
            is_done = take(store->layout, &portion[i], context, err);
        }
        behind = count > 0 ? (sqlite3_int64)portion[count - 1].run : behind;
    }
    free(portion);
    return is_done;
}
