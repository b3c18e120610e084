// How are the runs of a store counted, and their results distributed?
//
// Every row is checked against its checksum before any query, because SQL knows no checksums.
//
// Quantiles are values that occur, found by sorting in SQL: SQLite sorts in files where memory is
// short.
#include "commands/study/store_inside.h"

#include <math.h>
#include <sqlite3.h>
#include <string.h>

static bool count_row(const Layout *layout, const Record *record, void *context, Err *err)
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
    store->is_verified = store_each(store, count_row, count, err);
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

// The statement that counts the values, or that brings them in ascending order.
static bool prepare_values(Store *store, const Column *column, bool is_count,
                           sqlite3_stmt **statement, Err *err)
{
    Text sql;
    text_init(&sql);
    text_append(&sql, is_count ? "SELECT count(*) FROM run WHERE outcome = 0 AND "
                               : "SELECT * FROM (SELECT ");
    store_shape_quote(&sql, column->name);
    text_append(&sql, is_count ? " IS NOT NULL"
                               : " AS value FROM run WHERE outcome = 0) WHERE value IS NOT NULL "
                                 "ORDER BY value");
    const bool is_ready = store_prepare(store, sql.data, statement, err);
    text_finish(&sql);
    return is_ready;
}

// The rank, from 1, of a share of `count` values.
static uint64_t rank_of(double share, uint64_t count)
{
    const double rank = ceil(share * (double)count);
    return rank < 1.0 ? 1 : (uint64_t)rank;
}

bool store_spread(Store *store, size_t column, StoreSpread *spread, Err *err)
{
    static const double SHARES[] = {0.0, 0.05, 0.5, 0.95, 1.0};
    double *const targets[] = {&spread->least, &spread->low, &spread->median, &spread->high,
                               &spread->most};
    enum { SHARE_COUNT = sizeof SHARES / sizeof *SHARES };
    *spread = (StoreSpread){0, NAN, NAN, NAN, NAN, NAN};
    const Column *wanted = store_column_at(store->layout, column);
    sqlite3_stmt *row = NULL;
    bool is_read = verify(store, err) && prepare_values(store, wanted, true, &row, err);
    while (store_step(store, &row, &is_read, err)) {
        spread->count = (uint64_t)sqlite3_column_int64(row, 0);
    }
    is_read = is_read && prepare_values(store, wanted, false, &row, err);
    size_t next = 0;
    for (uint64_t rank = 1; store_step(store, &row, &is_read, err); rank++) {
        for (; next < SHARE_COUNT && rank_of(SHARES[next], spread->count) == rank; next++) {
            *targets[next] = sqlite3_column_double(row, 0);
        }
    }
    return is_read;
}
