// Does a store that cannot be read or written say so, and never give a wrong number?
#include "commands/study/store.h"

#include "sample.h"
#include "study_store.h"

#include <fcntl.h>
#include <signal.h>
#include <sqlite3.h>
#include <sys/resource.h>
#include <sys/stat.h>

enum { FILE_MAX = 1 << 17, STRIDE = 37, FEW = 30 };

static unsigned char content[FILE_MAX];
static size_t content_size;

static void read_content(void)
{
    FILE *stream = fopen(path, "rb");
    assert_non_null(stream);
    content_size = fread(content, 1, sizeof content, stream);
    fclose(stream);
    assert_true(content_size < sizeof content);
}

static void write_content(size_t size)
{
    FILE *stream = fopen(path, "wb");
    assert_non_null(stream);
    assert_int_equal(fwrite(content, 1, size, stream), size);
    fclose(stream);
}

// Counts the rows and holds each against what was written.
static bool hold_row(const Layout *layout, const Record *record, void *context, Err *err)
{
    (void)err;
    Record truth = study_record(layout, record->run);
    (*(uint64_t *)context)++;
    assert_int_equal(record->outcome, truth.outcome);
    assert_string_equal(record->reason, truth.reason);
    assert_true(record->hash == truth.hash);
    assert_near(record->wall_s, truth.wall_s, 0.0);
    assert_near(record->settings[0].number, truth.settings[0].number, 0.0);
    assert_string_equal(record->settings[2].word, truth.settings[2].word);
    for (size_t i = 0; i < layout->result_count; i++) {
        assert_true(is_same_cell(record->results[i], truth.results[i]));
    }
    return true;
}

// Whether the store can be viewed and read; every row it then gives must be right, and all there.
static bool is_read_right(void)
{
    Err err = {0};
    uint64_t count = 0;
    const Layout layout = study_layout();
    Store *store = store_view(path, &err);
    const bool is_right = store != NULL && store_each(store, hold_row, &count, &err);
    if (is_right) {
        assert_memory_equal(store_layout(store), &layout, sizeof layout);
        assert_string_equal(store_key(store, "study"), "9cd1");
        assert_int_equal(count, FEW);
    } else {
        assert_int_equal(err.kind, ERR_FILE);
        assert_non_null(strstr(err.text, path));
    }
    err = (Err){0};
    store_close(store, &err);
    return is_right;
}

static void a_byte_that_turned_never_makes_a_number(void **state)
{
    (void)state;
    make_store(FEW);
    assert_true(is_read_right());
    read_content();
    size_t told = 0;
    size_t harmless = 0;
    // every byte of the header, and then some of all pages
    for (size_t i = 0; i < content_size; i += i < 128 ? 1 : STRIDE * sample_stride()) {
        const unsigned char former = content[i];
        content[i] ^= (unsigned char)(1u << i % 8);
        write_content(content_size);
        *(is_read_right() ? &harmless : &told) += 1;
        content[i] = former;
    }
    // the control: most of the file is in use
    assert_true(told > harmless / 4 && told > 100);
}

static void change(const char *sql)
{
    sqlite3 *base = NULL;
    assert_int_equal(sqlite3_open(path, &base), SQLITE_OK);
    assert_int_equal(sqlite3_exec(base, sql, NULL, NULL, NULL), SQLITE_OK);
    assert_int_equal(sqlite3_changes(base), 1);
    sqlite3_close(base);
}

// Each reader as the first of its opening.
static bool read_by(int reader, Store *store, Err *err)
{
    StoreCount count;
    StoreReason reasons[4];
    size_t reason_count;
    Cell values[8];
    StoreSpread spread;
    uint64_t rows = 0;
    switch (reader) {
    case 0:
        return store_count(store, &count, err);
    case 1:
        return store_reasons(store, 4, reasons, &reason_count, err);
    case 2:
        return store_values(store, 0, 8, values, &reason_count, err);
    case 3:
        return store_spread(store, 4, &spread, err);
    default:
        return store_each(store, hold_row, &rows, err);
    }
}

enum { READERS = 5 };

static void every_reader_names_the_row_that_is_damaged(void **state)
{
    (void)state;
    static const char *const CHANGES[] = {
        "UPDATE run SET coupler_omega_max_rad_s = 7.7e8 WHERE run = 3",
        "UPDATE run SET drive_speed_rad_s = 1 WHERE run = 3",
        "UPDATE run SET outcome = 2 WHERE run = 3",
        "UPDATE run SET hash = 1 WHERE run = 3",
        "UPDATE effort SET wall_s = 1e9 WHERE run = 3",
        "DELETE FROM effort WHERE run = 3",
    };
    for (size_t i = 0; i < sizeof CHANGES / sizeof *CHANGES; i++) {
        unlink(path);
        make_store(FEW);
        for (int damaged = 0; damaged < 2; damaged++) {
            for (int reader = 0; reader < READERS; reader++) {
                Err err = {0};
                Store *store = store_view(path, &err);
                assert_non_null(store);
                // the control: without the change all of them read
                assert_int_equal(read_by(reader, store, &err), damaged == 0);
                if (damaged == 1) {
                    assert_int_equal(err.kind, ERR_FILE);
                    assert_non_null(strstr(err.text, "run 3 does not match its checksum"));
                }
                err = (Err){0};
                assert_true(store_close(store, &err));
            }
            if (damaged == 0) {
                change(CHANGES[i]);
            }
        }
    }
}

static void a_damaged_row_is_forgotten_and_made_again(void **state)
{
    (void)state;
    Err err;
    uint64_t forgotten = 0;
    bool has = true;
    const Layout layout = study_layout();
    make_store(FEW);
    change("UPDATE run SET coupler_omega_max_rad_s = 7.7e8 WHERE run = 3");
    change("UPDATE effort SET wall_s = 1e9 WHERE run = 4");
    change("UPDATE run SET run = 1000 WHERE run = 5");
    Store *store = open_study(&layout, false, &err);
    // run 7 has failed
    assert_true(store_forget_failed(store, &forgotten, &err));
    assert_int_equal(forgotten, 4);
    for (uint64_t run = 0; run < FEW; run++) {
        assert_true(store_has(store, run, &has, &err));
        assert_int_equal(has, !(run >= 3 && run <= 5) && run != 7);
        if (!has) {
            add_runs(store, &layout, run, run + 1);
        }
    }
    assert_true(store_close(store, &err));
    assert_true(is_read_right());
}

static void a_file_cut_short_is_told(void **state)
{
    (void)state;
    Err err;
    const Layout layout = study_layout();
    make_store(FEW);
    read_content();
    for (size_t size = 1; size < content_size; size += 1009) {
        write_content(size);
        assert_false(is_read_right());
        assert_null(open_study(&layout, false, &err));
        assert_int_equal(err.kind, ERR_FILE);
    }
    // an empty file has nothing to lose
    write_content(0);
    assert_false(is_read_right());
    make_store(FEW);
    assert_true(is_read_right());
}

static void a_damaged_store_is_made_anew(void **state)
{
    (void)state;
    Err err;
    const Layout layout = study_layout();
    make_store(FEW);
    read_content();
    for (size_t page = 0; page * 4096 < content_size; page++) {
        unsigned char former[4096];
        // all of a page but what tells that the file is a store
        const size_t first = page == 0 ? 100 : 0;
        memcpy(former, content + page * 4096, sizeof former);
        memset(content + page * 4096 + first, 0x5a, sizeof former - first);
        write_content(content_size);
        memcpy(content + page * 4096, former, sizeof former);
        assert_null(open_study(&layout, false, &err));
        assert_non_null(strstr(err.text, "is damaged"));
        Store *store = open_study(&layout, true, &err);
        assert_string_equal(err.text, "");
        add_runs(store, &layout, 0, FEW);
        assert_true(store_close(store, &err));
        assert_true(is_read_right());
    }
}

static void expect_left_alone(size_t size)
{
    const Layout layout = study_layout();
    for (int fresh = 0; fresh < 3; fresh++) {
        Err err = {0};
        const StoreHead head = study_head(&layout, RUNS);
        assert_null(fresh < 2 ? store_open(path, &head, fresh == 1, &err) : store_view(path, &err));
        assert_int_equal(err.kind, ERR_FILE);
        assert_non_null(strstr(err.text, "is not the store of a study"));
    }
    unsigned char former[FILE_MAX];
    memcpy(former, content, size);
    read_content();
    assert_int_equal(content_size, size);
    assert_memory_equal(content, former, size);
}

static void what_is_no_store_is_left_alone(void **state)
{
    (void)state;
    static const char *const WORDS[] = {"x", "my thesis\n", "SQLite format 3, a history"};
    for (int i = 0; i < 3; i++) {
        strcpy((char *)content, WORDS[i]);
        write_content(strlen(WORDS[i]));
        expect_left_alone(strlen(WORDS[i]));
    }
    memset(content, 'x', 10000);
    write_content(10000);
    expect_left_alone(10000);
    // the database of another program, one with tables of the same names
    unlink(path);
    sqlite3 *base = NULL;
    assert_int_equal(sqlite3_open(path, &base), SQLITE_OK);
    assert_int_equal(
        sqlite3_exec(base, "CREATE TABLE run(run); CREATE TABLE study(name)", NULL, NULL, NULL),
        SQLITE_OK);
    sqlite3_close(base);
    read_content();
    expect_left_alone(content_size);
}

// What a program leaves that is stopped between emptying a store and making its tables.
static void stop_half_way(void)
{
    sqlite3 *base;
    assert_int_equal(sqlite3_open(path, &base), SQLITE_OK);
    assert_int_equal(sqlite3_db_config(base, SQLITE_DBCONFIG_RESET_DATABASE, 1, NULL), SQLITE_OK);
    assert_int_equal(sqlite3_exec(base, "VACUUM", NULL, NULL, NULL), SQLITE_OK);
    sqlite3_close(base);
}

static void a_store_that_was_half_way_made_anew_is_made(void **state)
{
    (void)state;
    const Layout layout = study_layout();
    for (int is_fresh = 0; is_fresh < 2; is_fresh++) {
        make_store(FEW);
        stop_half_way();
        Err err;
        Store *store = open_study(&layout, is_fresh == 1, &err);
        assert_non_null(store);
        add_runs(store, &layout, 0, 1);
        assert_true(store_close(store, &err));
        unlink(path);
    }
    // the control: a table of someone else's
    sqlite3 *base;
    assert_int_equal(sqlite3_open(path, &base), SQLITE_OK);
    assert_int_equal(sqlite3_exec(base, "CREATE TABLE other (x)", NULL, NULL, NULL), SQLITE_OK);
    sqlite3_close(base);
    Err err;
    assert_null(open_study(&layout, true, &err));
    assert_non_null(strstr(err.text, "is not the store of a study"));
}

static void a_store_of_another_version_is_refused_and_made_anew(void **state)
{
    (void)state;
    Err err;
    const Layout layout = study_layout();
    make_store(FEW);
    sqlite3 *base = NULL;
    sqlite3_open(path, &base);
    sqlite3_exec(base, "PRAGMA user_version = 99", NULL, NULL, NULL);
    sqlite3_close(base);
    assert_null(open_study(&layout, false, &err));
    assert_non_null(strstr(err.text, "has tables of version 99"));
    Store *store = open_study(&layout, true, &err);
    assert_non_null(store);
    assert_true(store_close(store, &err));
}

static void a_place_that_is_no_file_is_told(void **state)
{
    (void)state;
    static const char *const PLACES[] = {"/nowhere/at/all", "/dev/full", "/dev/null", "/tmp", ""};
    const Layout layout = study_layout();
    const StoreHead head = study_head(&layout, RUNS);
    for (int i = 0; i < 5; i++) {
        Err err = {0};
        assert_null(store_open(PLACES[i], &head, i == 3, &err));
        assert_int_equal(err.kind, ERR_FILE);
        err = (Err){0};
        assert_null(store_view(PLACES[i], &err));
        assert_int_equal(err.kind, ERR_FILE);
    }
    Err err = {0};
    assert_null(store_view(path, &err));
    assert_non_null(strstr(err.text, "No such file or directory"));
    assert_int_equal(mkfifo(path, 0600), 0);
    err = (Err){0};
    assert_null(store_view(path, &err));
    assert_non_null(strstr(err.text, "is not the store of a study"));
}

// So that a full disk can be had anywhere: no file of the process can be longer than that.
static const rlim_t SPACE = 200000;

static int run_out_of_space(void)
{
    Err err;
    const Layout layout = study_layout();
    Store *store = open_study(&layout, false, &err);
    add_runs(store, &layout, 0, RUNS);
    const struct rlimit limit = {SPACE, SPACE};
    signal(SIGXFSZ, SIG_IGN);
    setrlimit(RLIMIT_FSIZE, &limit);
    if (!store_commit(store, &err)) {
        return 1;
    }
    // a transaction that does not fit, told at the row that spills or at the commit
    bool is_written = true;
    for (uint64_t run = RUNS; run < 20000 && is_written; run++) {
        const Record record = study_record(&layout, run);
        is_written = store_add(store, &record, &err);
    }
    is_written = is_written && store_commit(store, &err);
    if (is_written || err.kind != ERR_FILE || strstr(err.text, path) == NULL) {
        return 2;
    }
    // and all is as it was, in this very process, too
    bool has_last = false;
    bool has_next = true;
    err = (Err){0};
    if (!store_has(store, RUNS - 1, &has_last, &err) || !store_has(store, RUNS, &has_next, &err)) {
        return 3;
    }
    return has_last && !has_next && store_close(store, &err) ? 0 : 4;
}

static void what_was_committed_outlives_a_full_disk(void **state)
{
    (void)state;
    assert_int_equal(in_a_child(run_out_of_space), 0);
    assert_int_equal(count_right_rows(), RUNS);
    Err err;
    const Layout layout = study_layout();
    Store *store = open_study(&layout, false, &err);
    add_runs(store, &layout, RUNS, RUNS + 20);
    assert_true(store_close(store, &err));
    assert_int_equal(count_right_rows(), RUNS + 20);
}

static int make_without_space(void)
{
    Err err;
    const Layout layout = study_layout();
    const struct rlimit limit = {5000, 5000};
    signal(SIGXFSZ, SIG_IGN);
    setrlimit(RLIMIT_FSIZE, &limit);
    return open_study(&layout, false, &err) == NULL && err.kind == ERR_FILE &&
                   strstr(err.text, ": File too large") != NULL && access(path, F_OK) != 0
               ? 0
               : 1;
}

static void a_store_that_has_no_space_is_not_begun(void **state)
{
    (void)state;
    assert_int_equal(in_a_child(make_without_space), 0);
}

// Files of root's may be written whatever their mode says.
static int work_where_nothing_may_be_written(void)
{
    Err err;
    const Layout layout = study_layout();
    if (geteuid() == 0 && setuid(65534) != 0) {
        return 1;
    }
    if (open_study(&layout, false, &err) != NULL || err.kind != ERR_FILE ||
        strstr(err.text, "Permission denied") == NULL) {
        return 2;
    }
    // to be looked at it need not be written
    err = (Err){0};
    Store *store = store_view(path, &err);
    uint64_t count = 0;
    return store != NULL && store_each(store, hold_row, &count, &err) && count == FEW ? 0 : 3;
}

static void a_store_that_may_not_be_written_can_be_looked_at(void **state)
{
    (void)state;
    make_store(FEW);
    assert_int_equal(chmod(path, 0444) + chmod(folder, 0555), 0);
    assert_int_equal(in_a_child(work_where_nothing_may_be_written), 0);
    assert_int_equal(chmod(folder, 0755), 0);
}

static int work_in_a_folder_that_may_not_be_written(void)
{
    Err err;
    const Layout layout = study_layout();
    if (geteuid() == 0 && setuid(65534) != 0) {
        return 1;
    }
    Store *store = open_study(&layout, false, &err);
    const Record record = study_record(&layout, FEW);
    const bool is_written =
        store != NULL && store_add(store, &record, &err) && store_commit(store, &err);
    return !is_written && err.kind == ERR_FILE && strstr(err.text, path) != NULL ? 0 : 2;
}

static void a_folder_that_may_not_be_written_is_told(void **state)
{
    (void)state;
    make_store(FEW);
    // SQLite has its journal beside the store
    assert_int_equal(chmod(path, 0666) + chmod(folder, 0555), 0);
    assert_int_equal(in_a_child(work_in_a_folder_that_may_not_be_written), 0);
    assert_int_equal(chmod(folder, 0755), 0);
    assert_true(is_read_right());
}

static int deny_key(void *context, int action, const char *table, const char *column,
                    const char *base, const char *trigger)
{
    (void)context;
    (void)column;
    (void)base;
    (void)trigger;
    return action == SQLITE_INSERT && strcmp(table, "study") == 0 ? SQLITE_DENY : SQLITE_OK;
}

// What SQLite calls for every file that is opened from now on.
static int deny_in(sqlite3 *base, char **message, const void *routines)
{
    (void)message;
    (void)routines;
    return sqlite3_set_authorizer(base, deny_key, NULL);
}

static void expect_denied(void)
{
    Err err;
    const Layout layout = study_layout();
    assert_int_equal(sqlite3_auto_extension((void (*)(void))deny_in), SQLITE_OK);
    Store *store = open_study(&layout, false, &err);
    sqlite3_reset_auto_extension();
    assert_null(store);
    assert_int_equal(err.kind, ERR_FILE);
    assert_non_null(strstr(err.text, "not authorized"));
}

// Its tables can be made, but nothing put into the one that holds the key.
static void a_store_that_cannot_hold_its_key_is_not_begun(void **state)
{
    (void)state;
    expect_denied();
    assert_int_not_equal(access(path, F_OK), 0);
    make_store(FEW);
    assert_int_equal(count_right_rows(), FEW);
    // an empty file stays empty, and does not get tables without a key
    write_content(0);
    expect_denied();
    assert_int_equal(access(path, F_OK), 0);
    make_store(FEW);
    assert_int_equal(count_right_rows(), FEW);
}

#define STORE_TEST(name) cmocka_unit_test_setup_teardown(name, set_up, tear_down)

int main(void)
{
    const struct CMUnitTest tests[] = {
        STORE_TEST(a_byte_that_turned_never_makes_a_number),
        STORE_TEST(every_reader_names_the_row_that_is_damaged),
        STORE_TEST(a_damaged_row_is_forgotten_and_made_again),
        STORE_TEST(a_file_cut_short_is_told),
        STORE_TEST(a_damaged_store_is_made_anew),
        STORE_TEST(what_is_no_store_is_left_alone),
        STORE_TEST(a_store_that_was_half_way_made_anew_is_made),
        STORE_TEST(a_store_of_another_version_is_refused_and_made_anew),
        STORE_TEST(a_place_that_is_no_file_is_told),
        STORE_TEST(what_was_committed_outlives_a_full_disk),
        STORE_TEST(a_store_that_has_no_space_is_not_begun),
        STORE_TEST(a_store_that_cannot_hold_its_key_is_not_begun),
        STORE_TEST(a_store_that_may_not_be_written_can_be_looked_at),
        STORE_TEST(a_folder_that_may_not_be_written_is_told),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
