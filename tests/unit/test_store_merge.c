// Is the merge of the shards of a study the study, and is nothing merged that does not belong
// together?
#include "commands/study/store.h"

#include "base/text.h"

#include "study_store.h"

#include <signal.h>
#include <sqlite3.h>
#include <sys/stat.h>

enum { SHARDS = 3, MANY = 24, SOURCE_MAX = 40 };

static char shards[SOURCE_MAX][PATH_SIZE];
static const char *sources[SOURCE_MAX];

static int set_up_shards(void **state)
{
    const int status = set_up(state);
    for (int i = 0; i < SOURCE_MAX; i++) {
        snprintf(shards[i], PATH_SIZE, "%s/shard-%d.sqlite", folder, i);
        sources[i] = shards[i];
    }
    return status;
}

static int tear_down_shards(void **state)
{
    for (int i = 0; i < SOURCE_MAX; i++) {
        unlink(shards[i]);
    }
    return tear_down(state);
}

// The runs first, first + stride, ... below the end.
static void make_shard(const char *name, const StoreHead *head, uint64_t first, uint64_t stride,
                       uint64_t end)
{
    Err err = {0};
    Store *store = store_open(name, head, false, &err);
    assert_string_equal(err.text, "");
    for (uint64_t run = first; run < end; run += stride) {
        Record record = study_record(head->layout, run);
        assert_true(store_add(store, &record, &err));
    }
    assert_true(store_close(store, &err));
}

static void make_shards(uint64_t count, uint64_t runs)
{
    const Layout layout = study_layout();
    const StoreHead head = study_head(&layout, RUNS);
    for (uint64_t i = 0; i < count; i++) {
        make_shard(shards[i], &head, i, count, runs);
    }
}

static uint64_t merge_of(size_t count)
{
    Err err = {0};
    uint64_t added = 0;
    assert_true(store_merge(path, sources, count, &added, &err) || err.text[0] == '\0');
    assert_string_equal(err.text, "");
    return added;
}

static void expect_no_merge(size_t count, const char *words, const char *other_words)
{
    Err err = {0};
    uint64_t added = 77;
    assert_false(store_merge(path, sources, count, &added, &err));
    assert_int_equal(err.kind, ERR_FILE);
    assert_non_null(strstr(err.text, words));
    assert_non_null(strstr(err.text, other_words));
    assert_int_equal(added, 77);
}

// All that SQL has to say about the tables, as text.
static void dump(const char *name, Text *text)
{
    static const char *const QUERIES[] = {"SELECT * FROM study", "SELECT * FROM run",
                                          "SELECT * FROM effort", "SELECT sql FROM sqlite_schema"};
    sqlite3 *base = NULL;
    assert_int_equal(sqlite3_open(name, &base), SQLITE_OK);
    for (int i = 0; i < 4; i++) {
        sqlite3_stmt *statement = NULL;
        assert_int_equal(sqlite3_prepare_v2(base, QUERIES[i], -1, &statement, NULL), SQLITE_OK);
        while (sqlite3_step(statement) == SQLITE_ROW) {
            for (int k = 0; k < sqlite3_column_count(statement); k++) {
                if (sqlite3_column_type(statement, k) == SQLITE_FLOAT) {
                    text_append(text, "%a|", sqlite3_column_double(statement, k));
                } else {
                    text_append(text, "%s|", (const char *)sqlite3_column_text(statement, k));
                }
            }
            text_append(text, "\n");
        }
        sqlite3_finalize(statement);
    }
    sqlite3_close(base);
}

static void merged_shards_are_the_whole_study_row_for_row(void **state)
{
    (void)state;
    Text merged;
    Text whole;
    text_init(&merged);
    text_init(&whole);
    make_shards(MANY, RUNS);
    assert_int_equal(merge_of(MANY), RUNS);
    assert_int_equal(count_right_rows(), RUNS);
    dump(path, &merged);
    unlink(path);
    make_store(RUNS);
    dump(path, &whole);
    assert_true(whole.length > 50000);
    assert_string_equal(merged.data, whole.data);
    text_finish(&merged);
    text_finish(&whole);
}

static void a_merge_can_be_made_in_parts_and_again(void **state)
{
    (void)state;
    make_shards(SHARDS, RUNS);
    assert_int_equal(merge_of(1), 67);
    assert_int_equal(merge_of(SHARDS), RUNS - 67);
    assert_int_equal(merge_of(SHARDS), 0);
    assert_int_equal(count_right_rows(), RUNS);
    // the target may be named among the sources, as may one source twice
    snprintf(shards[SHARDS], PATH_SIZE, "%s", path);
    snprintf(shards[SHARDS + 1], PATH_SIZE, "%s", shards[0]);
    assert_int_equal(merge_of(SHARDS + 2), 0);
    sources[0] = path;
    assert_int_equal(merge_of(1), 0);
    assert_int_equal(count_right_rows(), RUNS);
}

static void the_wall_time_of_a_run_made_twice_is_that_of_the_first(void **state)
{
    (void)state;
    Err err = {0};
    const Layout layout = study_layout();
    make_shards(SHARDS, RUNS);
    // the same run, made by another shard in another time
    const StoreHead head = study_head(&layout, RUNS);
    Store *store = store_open(shards[2], &head, false, &err);
    Record record = study_record(&layout, 0);
    record.wall_s = 123.0;
    assert_true(store_add(store, &record, &err));
    assert_true(store_close(store, &err));
    assert_int_equal(merge_of(SHARDS), RUNS);
    assert_int_equal(count_right_rows(), RUNS);
}

// One result of one run becomes another, in a store that is whole.
static void change_a_result(const char *name, uint64_t run)
{
    Err err = {0};
    const Layout layout = study_layout();
    const StoreHead head = study_head(&layout, RUNS);
    Store *store = store_open(name, &head, true, &err);
    Record record = study_record(&layout, run);
    record.results[5] = nextafter(record.results[5], INFINITY);
    assert_true(store_add(store, &record, &err));
    assert_true(store_close(store, &err));
}

static void a_run_with_two_results_is_told_and_nothing_is_merged(void **state)
{
    (void)state;
    make_shards(SHARDS, RUNS);
    change_a_result(shards[SHARDS], 131);
    expect_no_merge(SHARDS + 1, "run 131 has different results in", shards[2]);
    expect_no_merge(SHARDS + 1, shards[SHARDS], shards[2]);
    // nothing is left of a target that was not there
    assert_int_not_equal(access(path, F_OK), 0);
    // and one that was there is as it was
    assert_int_equal(merge_of(SHARDS), RUNS);
    sources[0] = shards[SHARDS];
    expect_no_merge(1, "run 131 has different results in", path);
    assert_int_equal(count_right_rows(), RUNS);
    // whatever else was added before the mistake was found
    unlink(path);
    sources[0] = shards[0];
    assert_int_equal(merge_of(1), 67);
    expect_no_merge(SHARDS + 1, "run 131 has different results in", shards[SHARDS]);
    assert_int_equal(count_right_rows(), 67);
}

// A store of one run, as it is or cut off by the time limit.
static void make_one(const char *name, uint64_t run, bool is_cut_off)
{
    Err err = {0};
    const Layout layout = study_layout();
    const StoreHead head = study_head(&layout, RUNS);
    Store *store = store_open(name, &head, true, &err);
    Record record = study_record(&layout, run);
    if (is_cut_off) {
        record.outcome = RUN_OUTCOME_TIMED_OUT;
        record.hash = 0;
        strcpy(record.reason, "took longer than its limit of 2 s");
        for (size_t i = 0; i < layout.result_count; i++) {
            record.results[i] = NAN;
        }
    }
    assert_true(store_add(store, &record, &err));
    assert_true(store_close(store, &err));
}

static void a_run_that_was_cut_off_gives_way_to_its_result(void **state)
{
    (void)state;
    // among the sources, whichever comes first
    for (int i = 0; i < 2; i++) {
        make_one(shards[0], 5, i == 0);
        make_one(shards[1], 5, i == 1);
        assert_int_equal(merge_of(2), 1);
        assert_int_equal(count_right_rows(), 1);
        unlink(path);
    }
    // and in the target, which then keeps the result
    make_one(shards[0], 5, true);
    assert_int_equal(merge_of(1), 1);
    make_one(shards[0], 5, false);
    assert_int_equal(merge_of(1), 0);
    assert_int_equal(count_right_rows(), 1);
    make_one(shards[0], 5, true);
    assert_int_equal(merge_of(1), 0);
    assert_int_equal(count_right_rows(), 1);
}

static void stores_of_two_studies_are_not_merged(void **state)
{
    (void)state;
    Layout layout = study_layout();
    StoreHead head = study_head(&layout, RUNS);
    make_shards(SHARDS, RUNS);
    head.keys[1].value = "0.2.0";
    make_shard(shards[SHARDS], &head, 3, 7, RUNS);
    expect_no_merge(SHARDS + 1, "cannot be merged with", shards[SHARDS]);
    expect_no_merge(SHARDS + 1, "the program is another one (program is 0.2.0 there and",
                    shards[0]);
    unlink(shards[SHARDS]);
    head = study_head(&layout, RUNS + 2);
    make_shard(shards[SHARDS], &head, 3, 7, RUNS);
    expect_no_merge(SHARDS + 1, "the study has 202 runs there and 200 here", shards[SHARDS]);
    unlink(shards[SHARDS]);
    head = study_head(&layout, RUNS);
    layout.result_count--;
    make_shard(shards[SHARDS], &head, 3, 7, RUNS);
    expect_no_merge(SHARDS + 1, "result 25 is missing there and evaluations here", shards[0]);
    assert_int_not_equal(access(path, F_OK), 0);
    // the target counts, too
    make_shard(path, &head, 3, 7, RUNS);
    expect_no_merge(SHARDS, "cannot be merged with", path);
}

static void a_source_that_is_missing_or_damaged_is_named(void **state)
{
    (void)state;
    make_shards(SHARDS, RUNS);
    expect_no_merge(SHARDS + 1, shards[SHARDS], "No such file or directory");
    FILE *stream = fopen(shards[SHARDS], "w");
    fputs("my thesis", stream);
    fclose(stream);
    expect_no_merge(SHARDS + 1, shards[SHARDS], "is not the store of a study");
    // a page of rows in the middle of a shard
    stream = fopen(shards[1], "r+b");
    fseek(stream, 7 * 4096 + 2000, SEEK_SET);
    for (int i = 0; i < 100; i++) {
        fputc('x', stream);
    }
    fclose(stream);
    expect_no_merge(SHARDS, shards[1], "is damaged");
    assert_int_not_equal(access(path, F_OK), 0);
}

static int pipes[2];

static int work_on_the_shard(void)
{
    Err err = {0};
    const Layout layout = study_layout();
    const StoreHead head = study_head(&layout, RUNS);
    Store *store = store_open(shards[1], &head, false, &err);
    char word = store != NULL ? 'y' : 'n';
    if (write(pipes[1], &word, 1) != 1) {
        return 1;
    }
    pause();
    return 0;
}

static void a_source_at_work_is_waited_for_by_people(void **state)
{
    (void)state;
    make_shards(SHARDS, RUNS);
    assert_int_equal(pipe(pipes), 0);
    fflush(stdout);
    const pid_t worker = fork();
    if (worker == 0) {
        _exit(work_on_the_shard());
    }
    char word = 'n';
    assert_int_equal(read(pipes[0], &word, 1), 1);
    assert_int_equal(word, 'y');
    expect_no_merge(SHARDS, shards[1], "is in use by another process");
    kill(worker, SIGKILL);
    waitpid(worker, NULL, 0);
    close(pipes[0]);
    close(pipes[1]);
    assert_int_equal(merge_of(SHARDS), RUNS);
}

// What a killed shard had not committed is not merged, what it had is.
static int die_in_mid_transaction(void)
{
    Err err = {0};
    const Layout layout = study_layout();
    const StoreHead head = study_head(&layout, RUNS);
    Store *store = store_open(shards[0], &head, false, &err);
    for (uint64_t run = 1000; run < 21000; run++) {
        const Record record = study_record(&layout, run);
        store_add(store, &record, &err);
    }
    raise(SIGKILL);
    return 0;
}

static void a_shard_killed_in_mid_write_is_merged_as_it_was(void **state)
{
    (void)state;
    make_shards(SHARDS, RUNS);
    assert_int_equal(in_a_child(die_in_mid_transaction), -SIGKILL);
    assert_int_equal(merge_of(SHARDS), RUNS);
    assert_int_equal(count_right_rows(), RUNS);
    // a source is left as it is
    char journal[PATH_SIZE + 16];
    snprintf(journal, sizeof journal, "%s-journal", shards[0]);
    assert_int_equal(unlink(journal), 0);
}

static int die_in_a_first_write(void)
{
    sqlite3 *base = NULL;
    sqlite3_open(path, &base);
    // as a merge that is killed while it makes its tables
    sqlite3_exec(base,
                 "PRAGMA cache_size = 1; PRAGMA application_id = 1246778196; "
                 "PRAGMA user_version = 3; BEGIN IMMEDIATE; CREATE TABLE study(name); "
                 "WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n WHERE i < 2000) "
                 "INSERT INTO study SELECT hex(randomblob(500)) FROM n",
                 NULL, NULL, NULL);
    raise(SIGKILL);
    return 0;
}

static void a_merge_that_was_killed_is_made_by_the_next(void **state)
{
    (void)state;
    struct stat status;
    make_shards(SHARDS, RUNS);
    assert_int_equal(in_a_child(die_in_a_first_write), -SIGKILL);
    // the control: there is something to be taken back
    assert_int_equal(stat(path, &status), 0);
    assert_true(status.st_size > 100000);
    assert_int_equal(merge_of(SHARDS), RUNS);
    assert_int_equal(count_right_rows(), RUNS);
}

enum { BIG = 20000, BYTES_A_RUN = 400 };

static double size_of(const char *name)
{
    struct stat status;
    assert_int_equal(stat(name, &status), 0);
    return (double)status.st_size;
}

// Makes and merges two shards of so many runs; the most memory that SQLite had of it.
static sqlite3_int64 memory_of(uint64_t runs)
{
    const Layout layout = study_layout();
    const StoreHead head = study_head(&layout, BIG);
    sqlite3_memory_highwater(1);
    make_shard(shards[0], &head, 0, 2, runs);
    make_shard(shards[1], &head, 1, 2, runs);
    assert_int_equal(merge_of(2), runs);
    assert_int_equal(count_right_rows(), runs);
    const sqlite3_int64 memory = sqlite3_memory_highwater(1);
    // small enough for a study of 1e9 runs, beyond what it varies and with it
    Layout bare = layout;
    bare.setting_count = 0;
    const StoreHead bare_head = study_head(&bare, BIG);
    assert_true(size_of(path) < BYTES_A_RUN * (double)runs + 65536.0);
    make_shard(shards[2], &bare_head, 0, 1, runs);
    assert_true(size_of(shards[2]) < BYTES_A_RUN * (double)runs + 65536.0);
    for (int i = 0; i < 3; i++) {
        unlink(shards[i]);
    }
    unlink(path);
    return memory;
}

static void runs_take_few_bytes_and_no_memory(void **state)
{
    (void)state;
    // both are more than SQLite's own share of memory for pages, 2 MB a store
    const sqlite3_int64 few = memory_of(BIG / 2);
    const sqlite3_int64 many = memory_of(BIG);
    // the control: it has been measured; twice the rows are another 3 MB
    assert_true(few > 1000000);
    assert_true(many < few + 100000);
}

#define MERGE_TEST(name) cmocka_unit_test_setup_teardown(name, set_up_shards, tear_down_shards)

int main(void)
{
    const struct CMUnitTest tests[] = {
        MERGE_TEST(merged_shards_are_the_whole_study_row_for_row),
        MERGE_TEST(a_merge_can_be_made_in_parts_and_again),
        MERGE_TEST(the_wall_time_of_a_run_made_twice_is_that_of_the_first),
        MERGE_TEST(a_run_with_two_results_is_told_and_nothing_is_merged),
        MERGE_TEST(a_run_that_was_cut_off_gives_way_to_its_result),
        MERGE_TEST(stores_of_two_studies_are_not_merged),
        MERGE_TEST(a_source_that_is_missing_or_damaged_is_named),
        MERGE_TEST(a_source_at_work_is_waited_for_by_people),
        MERGE_TEST(a_shard_killed_in_mid_write_is_merged_as_it_was),
        MERGE_TEST(a_merge_that_was_killed_is_made_by_the_next),
        MERGE_TEST(runs_take_few_bytes_and_no_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
