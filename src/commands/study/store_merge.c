// Merges the stores of shards, and counts the runs of a store.
//
// All sources are read side by side, each by rising number of run, and the run with the lowest
// number is taken next: the target grows at its end alone. Its pages are full, nothing that is
// written is written again, and of each source one row is in memory.
//
// A merge is one transaction, so that one that is interrupted leaves nothing behind. A target that
// it created is deleted again.
#include "base/sorted.h"
#include "base/zeroed.h"
#include "commands/study/store_inside.h"

#include <assert.h>
#include <inttypes.h>
#include <math.h>
#include <sqlite3.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

// The counts of a store and the distributions of its results.
//
// Every row is checked against its checksum before any query, because SQL knows no checksums.
//
// Quantiles are values that occur, found by sorting in SQL: SQLite sorts in files where memory is
// short.

static bool store_merge_count_row(const Layout *layout, const Record *record, void *context,
                                  Err *err)
{
    (void)layout;
    (void)err;
    StoreCount *count = context;
    count->rows++;
    count->outcomes[record->outcome]++;
    count->wall_s += record->wall_s;
    return true;
}

bool store_count(Store *store, StoreCount *count, Err *err)
{
    *count = (StoreCount){.run_count = store->run_count};
    store->is_verified = store_each(store, store_merge_count_row, count, err);
    return store->is_verified;
}

// Checks all rows against their checksums, once.
static bool verify(Store *store, Err *err)
{
    StoreCount count;
    return store->is_verified || store_count(store, &count, err);
}

bool store_reasons(Store *store, size_t most, StoreReason *reasons, size_t *count, Err *err)
{
    sqlite3_stmt *row = NULL;
    bool is_read =
        verify(store, err) &&
        store_prepare(
            store,
            "SELECT outcome, reason, count(*) AS runs, min(run) FROM run WHERE outcome <> 0 "
            "GROUP BY outcome, reason ORDER BY runs DESC, min(run)",
            &row, err);
    *count = 0;
    while (store_step(store, &row, &is_read, err)) {
        const int outcome = sqlite3_column_int(row, 0);
        if (outcome > RUN_OUTCOME_OK && outcome < RUN_OUTCOME_COUNT && *count < most) {
            StoreReason *reason = &reasons[(*count)++];
            *reason = (StoreReason){.outcome = (RunOutcome)outcome,
                                    .count = (uint64_t)sqlite3_column_int64(row, 2),
                                    .example = (uint64_t)sqlite3_column_int64(row, 3)};
            store_take_words(row, 1, reason->reason, sizeof reason->reason);
        }
    }
    return is_read;
}

const Column *store_column_at(const Layout *layout, size_t column)
{
    return column < layout->setting_count ? &layout->settings[column]
                                          : &layout->results[column - layout->setting_count];
}

size_t store_column(const Layout *layout, const char *name)
{
    const size_t count = layout->setting_count + layout->result_count;
    size_t column = 0;
    while (column < count && strcmp(store_column_at(layout, column)->name, name) != 0) {
        column++;
    }
    return column;
}

bool store_values(Store *store, size_t column, size_t most, Cell *values, size_t *count, Err *err)
{
    const Column *wanted = store_column_at(store->layout, column);
    sqlite3_stmt *row = NULL;
    Text sql;
    text_init(&sql);
    text_append(&sql, "SELECT DISTINCT ");
    store_shape_quote(&sql, wanted->name);
    text_append(&sql, " AS value FROM run WHERE value IS NOT NULL ORDER BY value LIMIT %zu",
                most + 1);
    bool is_read = verify(store, err) && store_prepare(store, sql.data, &row, err);
    text_finish(&sql);
    for (*count = 0; store_step(store, &row, &is_read, err); (*count)++) {
        if (*count < most && wanted->kind == COLUMN_WORD) {
            store_take_words(row, 0, values[*count].word, RECORD_WORD_SIZE);
        } else if (*count < most) {
            values[*count].number = sqlite3_column_double(row, 0);
        }
    }
    return is_read;
}

// Numbers that are held at a time: 32 MB. Of one column all are, 8 bytes a run.
enum { HELD_MAX = 1 << 22 };

// The statement that brings the values of so many columns, of the runs that are complete.
static bool prepare_values(Store *store, size_t column, size_t count, sqlite3_stmt **statement,
                           Err *err)
{
    Text sql;
    text_init(&sql);
    text_append(&sql, "SELECT ");
    for (size_t i = 0; i < count; i++) {
        text_append(&sql, i > 0 ? ", " : "");
        store_shape_quote(&sql, store_column_at(store->layout, column + i)->name);
    }
    text_append(&sql, " FROM run WHERE outcome = 0");
    const bool is_ready = store_prepare(store, sql.data, statement, err);
    text_finish(&sql);
    return is_ready;
}

static StoreSpread spread_of(double *values, uint64_t count)
{
    StoreSpread spread = {count, NAN, NAN, NAN, NAN, NAN};
    if (count > 0) {
        sorted_make(values, count);
        spread.least = values[0];
        spread.low = sorted_quantile(values, count, 0.05);
        spread.median = sorted_quantile(values, count, 0.5);
        spread.high = sorted_quantile(values, count, 0.95);
        spread.most = values[count - 1];
    }
    return spread;
}

// of the larger of two numbers: they are printed with three digits
static const double SPREADS_ALIKE = 5e-4;

bool store_spreads_alike(const StoreSpread *a, const StoreSpread *b)
{
    const double first[] = {a->least, a->low, a->median, a->high, a->most};
    const double second[] = {b->least, b->low, b->median, b->high, b->most};
    bool are_alike = a->count == b->count;
    for (size_t i = 0; i < sizeof first / sizeof *first; i++) {
        are_alike = are_alike && fabs(first[i] - second[i]) <=
                                     SPREADS_ALIKE * fmax(fabs(first[i]), fabs(second[i]));
    }
    return are_alike;
}

// Goes through the rows once for as many columns as can be held, which have room for all rows.
static bool find_spreads(Store *store, size_t column, size_t count, size_t room, double *values,
                         StoreSpread *spreads, Err *err)
{
    sqlite3_stmt *row = NULL;
    bool is_read = prepare_values(store, column, count, &row, err);
    for (size_t i = 0; i < count; i++) {
        spreads[i].count = 0;
    }
    for (uint64_t rows = 0; rows < room && store_step(store, &row, &is_read, err); rows++) {
        for (size_t i = 0; i < count; i++) {
            if (sqlite3_column_type(row, (int)i) != SQLITE_NULL) {
                values[i * room + spreads[i].count++] = sqlite3_column_double(row, (int)i);
            }
        }
    }
    sqlite3_finalize(row);
    for (size_t i = 0; i < count; i++) {
        spreads[i] = spread_of(values + i * room, spreads[i].count);
    }
    return is_read;
}

bool store_spreads(Store *store, size_t column, size_t count, StoreSpread *spreads, Err *err)
{
    StoreCount known;
    if (!store_count(store, &known, err)) {
        return false;
    }
    const size_t room = (size_t)known.rows + 1;
    const size_t most = room < HELD_MAX ? HELD_MAX / room : 1;
    const size_t width = count < most ? count : most;
    double *values = zeroed(width * room, sizeof *values);
    bool is_read = true;
    for (size_t i = 0; i < count && is_read; i += width) {
        const size_t left = count - i;
        is_read = find_spreads(store, column + i, left < width ? left : width, room, values,
                               &spreads[i], err);
    }
    free(values);
    return is_read;
}

bool store_spread(Store *store, size_t column, StoreSpread *spread, Err *err)
{
    return store_spreads(store, column, 1, spread, err);
}

enum { SPARE_FILES = 64 }; // beside one a source

// A source, and the row of it that is next.
typedef struct Cursor {
    Store *store;
    struct sqlite3_stmt *rows;
    Record record;
} Cursor;

typedef struct Merge {
    size_t count;
    Cursor *cursors;
    size_t waiting; // of the cursors that have a row, as a heap: the lowest run first
    Cursor **heap;
    Store *target;
    Record last; // the row taken last, and whose it was
    const char *last_path;
    uint64_t added;
} Merge;

static bool is_same_file(const char *path, const char *other)
{
    struct stat a;
    struct stat b;
    return stat(path, &a) == 0 && stat(other, &b) == 0 && a.st_dev == b.st_dev &&
           a.st_ino == b.st_ino;
}

// By default a process may have some 1000 files open; it can ask for more.
static void allow_files(size_t count)
{
    struct rlimit limit;
    if (getrlimit(RLIMIT_NOFILE, &limit) == 0 && limit.rlim_cur < count + SPARE_FILES) {
        limit.rlim_cur =
            limit.rlim_max < count + SPARE_FILES ? limit.rlim_max : count + SPARE_FILES;
        setrlimit(RLIMIT_NOFILE, &limit);
    }
}

static bool is_before(const Cursor *a, const Cursor *b)
{
    // for one run the source given first comes first, so that messages name them in that order
    return a->record.run != b->record.run ? a->record.run < b->record.run : a < b;
}

static void sink(Merge *merge, size_t i)
{
    for (size_t child; (child = 2 * i + 1) < merge->waiting; i = child) {
        if (child + 1 < merge->waiting && is_before(merge->heap[child + 1], merge->heap[child])) {
            child++;
        }
        if (is_before(merge->heap[i], merge->heap[child])) {
            return;
        }
        Cursor *lifted = merge->heap[child];
        merge->heap[child] = merge->heap[i];
        merge->heap[i] = lifted;
    }
}

// Brings the next row of a source, if there is one.
static bool store_merge_advance(Cursor *cursor, bool *has_row, Err *err)
{
    const uint64_t former = cursor->record.run;
    const int status = sqlite3_step(cursor->rows);
    *has_row = status == SQLITE_ROW;
    if (status == SQLITE_DONE) {
        return true;
    }
    if (status != SQLITE_ROW) {
        return store_fail(cursor->store, "read", err);
    }
    return store_row_take(cursor->store, cursor->rows, &cursor->record, err) &&
           (former == UINT64_MAX || cursor->record.run > former ||
            store_fail_damaged(cursor->store, "its runs are out of order", err));
}

static bool open_source(Merge *merge, const char *path, Err *err)
{
    Cursor *cursor = &merge->cursors[merge->count];
    cursor->record.run = UINT64_MAX;
    if (store_file_is_at_work(path)) {
        return err_set(err, ERR_FILE, "the store %s is in use by another process", path);
    }
    cursor->store = store_view(path, err);
    if (cursor->store == NULL) {
        return false;
    }
    merge->count++;
    bool has_row = false;
    const StoreHead head = store_schema_head(merge->cursors[0].store);
    if (!store_schema_check(cursor->store, &head, merge->cursors[0].store->path, err) ||
        !store_file_check(cursor->store, err) ||
        !store_run_sql(cursor->store, "PRAGMA cache_size = 16", err) ||
        !store_row_prepare(cursor->store, &cursor->rows, err)) {
        return false;
    }
    sqlite3_bind_int64(cursor->rows, 1, -1);
    sqlite3_bind_int64(cursor->rows, 2, -1);
    if (!store_merge_advance(cursor, &has_row, err)) {
        return false;
    }
    if (has_row) {
        merge->heap[merge->waiting++] = cursor;
    }
    return true;
}

static bool open_sources(Merge *merge, const char *target, const char *const *sources,
                         size_t source_count, Err *err)
{
    allow_files(source_count);
    merge->cursors = calloc(source_count + 1, sizeof *merge->cursors);
    merge->heap = calloc(source_count + 1, sizeof(Cursor *));
    assert(merge->cursors != NULL && merge->heap != NULL);
    for (size_t i = 0; i < source_count; i++) {
        if (!is_same_file(sources[i], target) && !open_source(merge, sources[i], err)) {
            return false;
        }
    }
    for (size_t i = merge->waiting; i-- > 0;) {
        sink(merge, i);
    }
    return true;
}

// Opening it for writing undoes what a killed merge has left.
static bool store_merge_open_target(Merge *merge, const char *path, Err *err)
{
    const Store *first = merge->cursors[0].store;
    const StoreHead head = store_schema_head(first);
    merge->target = store_open_target(path, &head, first->path, err);
    return merge->target != NULL;
}

// A run that was cut off may be the machine's fault, and is no result.
static bool is_cut_off(const Record *record)
{
    return record->outcome == RUN_OUTCOME_ENDED || record->outcome == RUN_OUTCOME_TIMED_OUT ||
           record->outcome == RUN_OUTCOME_NO_MEMORY;
}

// Whether a row lacks errors, because its truth could not be computed.
static bool lacks_errors(const Layout *layout, const Record *record)
{
    const size_t column = store_column(layout, STORE_ERROR_COLUMN);
    return column < layout->setting_count + layout->result_count &&
           isnan(record->results[column - layout->setting_count]);
}

// Compares a row with the other one of its run. Both must be the same, or one cut off or without a
// truth: then the better one stays.
static bool store_merge_compare(const Merge *merge, const Record *record, const char *path,
                                const Record *other, const char *other_path, bool *is_better,
                                Err *err)
{
    const Layout *layout = merge->target->layout;
    *is_better = is_cut_off(other) && !is_cut_off(record);
    if (record->outcome == RUN_OUTCOME_OK && other->outcome == RUN_OUTCOME_OK &&
        record->hash == other->hash &&
        lacks_errors(layout, record) != lacks_errors(layout, other)) {
        *is_better = lacks_errors(layout, other);
        return true;
    }
    return is_cut_off(other) || is_cut_off(record) || store_row_is_same(layout, record, other) ||
           err_set(err, ERR_FILE, "run %" PRIu64 " has different results in %s and in %s",
                   record->run, other_path, path);
}

// Whether the target had the run before; it must then be the same, or the better one stays.
static bool look_up(Merge *merge, const Record *record, const char *path, bool *is_there, Err *err)
{
    Store *target = merge->target;
    if (!store_has(target, record->run, is_there, err)) {
        return false;
    }
    if (!*is_there) {
        return true;
    }
    Record there;
    bool is_better = false;
    if (!store_row_prepare(target, &target->rows, err)) {
        return false;
    }
    sqlite3_bind_int64(target->rows, 1, (sqlite3_int64)record->run - 1);
    sqlite3_bind_int64(target->rows, 2, 1);
    const bool is_read =
        sqlite3_step(target->rows) == SQLITE_ROW || store_fail(target, "read", err);
    const bool is_same =
        is_read && store_row_take(target, target->rows, &there, err) &&
        store_merge_compare(merge, record, path, &there, target->path, &is_better, err);
    sqlite3_reset(target->rows);
    return is_same && (!is_better || store_replace(target, record, err));
}

static bool store_merge_take_row(Merge *merge, const Record *record, const char *path, Err *err)
{
    bool is_there = false;
    if (merge->last_path != NULL && merge->last.run == record->run) {
        bool is_better = false;
        if (!store_merge_compare(merge, record, path, &merge->last, merge->last_path, &is_better,
                                 err)) {
            return false;
        }
        if (!is_better) {
            return true;
        }
        merge->last = *record;
        merge->last_path = path;
        return look_up(merge, record, path, &is_there, err);
    }
    merge->last = *record;
    merge->last_path = path;
    if (!merge->target->is_made && !look_up(merge, record, path, &is_there, err)) {
        return false;
    }
    merge->added += is_there ? 0 : 1;
    return is_there || store_add(merge->target, record, err);
}

static bool store_merge_take_all(Merge *merge, Err *err)
{
    while (merge->waiting > 0) {
        Cursor *first = merge->heap[0];
        bool has_row;
        if (!store_merge_take_row(merge, &first->record, first->store->path, err) ||
            !store_merge_advance(first, &has_row, err)) {
            return false;
        }
        if (!has_row) {
            merge->heap[0] = merge->heap[--merge->waiting];
        }
        sink(merge, 0);
    }
    return store_commit(merge->target, err);
}

bool store_merge(const char *target, const char *const *sources, size_t source_count,
                 uint64_t *added, Err *err)
{
    Merge merge = {0};
    bool is_done = open_sources(&merge, target, sources, source_count, err);
    // a store merged only with itself stays as it is
    if (is_done && merge.count > 0) {
        is_done = store_merge_open_target(&merge, target, err) && store_merge_take_all(&merge, err);
    }
    if (merge.target != NULL && !is_done) {
        sqlite3_exec(merge.target->base, "ROLLBACK", NULL, NULL, NULL);
        merge.target->is_changing = false;
        // while it is locked: later it may belong to another process
        if (merge.target->is_made) {
            unlink(target);
        }
    }
    is_done = store_close(merge.target, err) && is_done;
    for (size_t i = 0; i < merge.count; i++) {
        sqlite3_finalize(merge.cursors[i].rows);
        store_close(merge.cursors[i].store, err);
    }
    free(merge.cursors);
    free(merge.heap);
    if (is_done) {
        *added = merge.added;
    }
    return is_done;
}
