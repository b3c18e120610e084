// Does a store give back what was put in, whatever happens to its process, and refuse what is not
// its own?
#include "commands/study/store.h"

#include "study_store.h"

#include <fcntl.h>
#include <signal.h>
#include <sqlite3.h>
#include <sys/stat.h>
#include <sys/wait.h>

static void rows_come_back_bit_for_bit(void **state)
{
    (void)state;
    make_store(RUNS);
    assert_int_equal(count_right_rows(), RUNS);
    Err err = {0};
    const Layout layout = study_layout();
    Store *store = store_view(path, &err);
    assert_memory_equal(store_layout(store), &layout, sizeof layout);
    assert_string_equal(store_key(store, "study"), "9cd1");
    assert_null(store_key(store, "stud"));
    store_close(store, &err);
}

static const double EDGES[] = {0.0,
                               -0.0,
                               1.0 / 3.0,
                               5e-324,
                               1.7976931348623157e308,
                               INFINITY,
                               -(INFINITY),
                               (double)NAN,
                               1e15,
                               -9223372036854775808.0,
                               9007199254740992.0,
                               9007199254740993.0 * 4.0,
                               0.1 + 0.2,
                               -1.5};
enum { EDGE_COUNT = sizeof EDGES / sizeof *EDGES };

static bool check_edges(const Layout *layout, const Record *record, void *context, Err *err)
{
    (void)layout;
    (void)context;
    (void)err;
    assert_true(record->hash == UINT64_MAX);
    assert_string_equal(record->settings[0].word, "it's \"100 %\" µ");
    for (size_t i = 0; i < 2 * EDGE_COUNT; i++) {
        assert_true(is_same_cell(record->results[i], EDGES[i % EDGE_COUNT]));
    }
    assert_true(isnan(record->settings[1].number));
    assert_true(isnan(record->wall_s));
    return true;
}

static void numbers_at_the_edge_come_back(void **state)
{
    (void)state;
    Err err;
    Layout layout = {0};
    study_add_column(layout.settings, &layout.setting_count, "word", COLUMN_WORD);
    study_add_column(layout.settings, &layout.setting_count, "select", COLUMN_REAL);
    for (int i = 0; i < 2 * EDGE_COUNT; i++) {
        char name[32];
        snprintf(name, sizeof name, "a \"quoted\" %d", i);
        study_add_column(layout.results, &layout.result_count, name,
                         i < EDGE_COUNT ? COLUMN_REAL : COLUMN_WHOLE);
    }
    Store *store = open_study(&layout, false, &err);
    Record record = {.run = 9007199254740991u, .hash = UINT64_MAX, .wall_s = NAN};
    strcpy(record.settings[0].word, "it's \"100 %\" µ");
    record.settings[1].number = NAN;
    for (int i = 0; i < 2 * EDGE_COUNT; i++) {
        record.results[i] = EDGES[i % EDGE_COUNT];
    }
    assert_true(store_add(store, &record, &err));
    assert_true(store_close(store, &err));
    store = store_view(path, &err);
    assert_true(store_each(store, check_edges, NULL, &err));
    store_close(store, &err);
}

static void a_run_is_never_there_twice(void **state)
{
    (void)state;
    Err err;
    bool has;
    const Layout layout = study_layout();
    make_store(20);
    Store *store = open_study(&layout, false, &err);
    const Record record = study_record(&layout, 3);
    assert_true(store_has(store, 3, &has, &err) && has);
    assert_true(store_has(store, 20, &has, &err) && !has);
    assert_false(store_add(store, &record, &err));
    assert_int_equal(err.kind, ERR_FILE);
    assert_non_null(strstr(err.text, "run 3 is in the store"));
    err = (Err){0};
    assert_true(store_close(store, &err));
    assert_int_equal(count_right_rows(), 20);
}

static const uint64_t COMMITTED = 40;

// More rows than SQLite keeps in memory are in the file already when the process dies.
static int die_in_mid_transaction(void)
{
    Err err;
    const Layout layout = study_layout();
    Store *store = open_study(&layout, false, &err);
    add_runs(store, &layout, 0, COMMITTED);
    store_commit(store, &err);
    add_runs(store, &layout, COMMITTED, COMMITTED + 20000);
    raise(SIGKILL);
    return 0;
}

static uint64_t hash_file(uint64_t hash, const char *name)
{
    static unsigned char content[1 << 16];
    FILE *stream = fopen(name, "rb");
    assert_non_null(stream);
    for (size_t count; (count = fread(content, 1, sizeof content, stream)) > 0;) {
        hash = hash_bytes(hash, content, count);
    }
    fclose(stream);
    return hash;
}

static uint64_t hash_files(const char *journal)
{
    return hash_file(hash_file(HASH_START, path), journal);
}

static void what_was_committed_outlives_a_kill(void **state)
{
    (void)state;
    char journal[PATH_SIZE + 16];
    struct stat status;
    snprintf(journal, sizeof journal, "%s-journal", path);
    assert_int_equal(in_a_child(die_in_mid_transaction), -SIGKILL);
    // the control: there is something to be taken back
    assert_int_equal(stat(journal, &status), 0);
    assert_true(status.st_size > 0);
    assert_int_equal(stat(path, &status), 0);
    assert_true(status.st_size > 1000000);
    // who looks sees it as it was, and changes nothing
    const uint64_t before = hash_files(journal);
    assert_int_equal(count_right_rows(), COMMITTED);
    assert_true(hash_files(journal) == before);
    // and the study goes on
    Err err;
    const Layout layout = study_layout();
    Store *store = open_study(&layout, false, &err);
    assert_non_null(store);
    add_runs(store, &layout, COMMITTED, RUNS);
    assert_true(store_close(store, &err));
    assert_int_equal(count_right_rows(), RUNS);
    assert_int_not_equal(stat(journal, &status), 0);
}

// Pipes to a process that works while this one looks.
static int orders[2];
static int answers[2];

// On '+' it adds a row and does not commit it, on '!' it commits; any other order ends it.
static int work_by_order(void)
{
    Err err;
    const Layout layout = study_layout();
    Store *store = open_study(&layout, false, &err);
    char order;
    uint64_t run = COMMITTED;
    while (read(orders[0], &order, 1) == 1 && (order == '+' || order == '!')) {
        if (order == '+') {
            add_runs(store, &layout, run, run + 1);
            run++;
        }
        const char answer = order == '+' || store_commit(store, &err) ? 'y' : 'n';
        if (write(answers[1], &answer, 1) != 1) {
            return 1;
        }
    }
    return store_close(store, &err) ? 0 : 1;
}

static pid_t hire(void)
{
    assert_int_equal(pipe(orders) + pipe(answers), 0);
    fflush(stdout);
    const pid_t worker = fork();
    if (worker == 0) {
        _exit(work_by_order());
    }
    return worker;
}

static void order(const char *words)
{
    for (; *words != '\0'; words++) {
        char answer = 'n';
        assert_int_equal(write(orders[1], words, 1), 1);
        assert_int_equal(read(answers[0], &answer, 1), 1);
        assert_int_equal(answer, 'y');
    }
}

static void dismiss(pid_t worker)
{
    int status;
    assert_int_equal(write(orders[1], "-", 1), 1);
    waitpid(worker, &status, 0);
    assert_int_equal(status, 0);
    for (int i = 0; i < 2; i++) {
        close(orders[i]);
        close(answers[i]);
    }
}

static void expect_at_work(void)
{
    Err err;
    const Layout layout = study_layout();
    for (int fresh = 0; fresh < 2; fresh++) {
        assert_null(open_study(&layout, fresh == 1, &err));
        assert_int_equal(err.kind, ERR_FILE);
        assert_non_null(strstr(err.text, "is in use by another process"));
    }
}

static void a_store_at_work_is_looked_at_and_not_worked_on(void **state)
{
    (void)state;
    make_store(COMMITTED);
    const pid_t worker = hire();
    // in a transaction as well as between two
    order("+");
    expect_at_work();
    assert_int_equal(count_right_rows(), COMMITTED);
    order("!");
    expect_at_work();
    assert_int_equal(count_right_rows(), COMMITTED + 1);
    order("+");
    dismiss(worker);
    // what was not yet committed is so at the end
    assert_int_equal(count_right_rows(), COMMITTED + 2);
    Err err;
    const Layout layout = study_layout();
    Store *store = open_study(&layout, false, &err);
    assert_non_null(store);
    store_close(store, &err);
}

static bool have_a_row_committed(const Layout *layout, const Record *record, void *context,
                                 Err *err)
{
    (void)layout;
    (void)err;
    (*(uint64_t *)context)++;
    order(record->run < 3 ? "+!" : "");
    return true;
}

static void who_looks_holds_up_nobody(void **state)
{
    (void)state;
    make_store(COMMITTED);
    const pid_t worker = hire();
    Err err = {0};
    uint64_t count = 0;
    Store *store = store_view(path, &err);
    assert_non_null(store);
    assert_true(store_each(store, have_a_row_committed, &count, &err));
    store_close(store, &err);
    assert_true(count >= COMMITTED);
    dismiss(worker);
    assert_int_equal(count_right_rows(), COMMITTED + 3);
}

static void expect_refusal(const StoreHead *head, const char *words)
{
    Err err = {0};
    assert_null(store_open(path, head, false, &err));
    assert_int_equal(err.kind, ERR_FILE);
    assert_non_null(strstr(err.text, words));
    assert_non_null(strstr(err.text, "--fresh starts it over"));
}

static void another_study_is_refused_with_what_differs(void **state)
{
    (void)state;
    make_store(20);
    Err err = {0};
    Layout layout = study_layout();
    StoreHead head = study_head(&layout, RUNS);
    head.keys[0].value = "1234";
    expect_refusal(&head, "the study file has changed (study is 9cd1 there and 1234 here)");
    head = study_head(&layout, RUNS + 1);
    expect_refusal(&head, "the study has 200 runs there and 201 here");
    head = study_head(&layout, RUNS);
    head.keys[1].name = "machine";
    expect_refusal(&head, "(machine is missing there");
    head = study_head(&layout, RUNS);
    head.key_count = 1;
    expect_refusal(&head, "its key has 2 parts there and 1 here");
    head = study_head(&layout, RUNS);
    strcpy(layout.results[2].name, "else");
    expect_refusal(&head, "result 3 is coupler_alpha_max_rad_s2 there and else here");
    // nothing was lost by asking
    assert_int_equal(count_right_rows(), 20);
    Store *store = store_open(path, &head, true, &err);
    assert_non_null(store);
    assert_true(store_close(store, &err));
    assert_int_equal(count_right_rows(), 0);
    store = store_view(path, &err);
    assert_string_equal(store_layout(store)->results[2].name, "else");
    store_close(store, &err);
}

static void columns_of_one_name_are_a_mistake_of_the_case(void **state)
{
    (void)state;
    static const char *const NAMES[] = {"Steps", "outcome", "DRIVE_SPEED_RAD_S", "wall_s"};
    for (int i = 0; i < 4; i++) {
        Err err;
        Layout layout = study_layout();
        strcpy(layout.results[0].name, NAMES[i]);
        assert_null(open_study(&layout, false, &err));
        assert_int_equal(err.kind, ERR_CASE);
        assert_non_null(strstr(err.text, "two columns of the study would be called"));
        assert_int_not_equal(access(path, F_OK), 0);
    }
}

static void a_sweep_forgets_what_failed(void **state)
{
    (void)state;
    Err err;
    uint64_t forgotten = 0;
    bool has;
    const Layout layout = study_layout();
    make_store(RUNS);
    Store *store = open_study(&layout, false, &err);
    assert_true(store_forget_failed(store, &forgotten, &err));
    assert_int_equal(forgotten, 4);
    assert_true(store_has(store, 57, &has, &err) && !has);
    assert_true(store_close(store, &err));
    assert_int_equal(count_right_rows(), RUNS - 4);
}

static void a_run_that_missed_its_truth_is_made_again(void **state)
{
    (void)state;
    Err err;
    uint64_t forgotten = 0;
    bool has;
    const Layout layout = study_layout();
    Store *store = open_study(&layout, false, &err);
    for (uint64_t run = 0; run < 3; run++) {
        Record record = study_record(&layout, run);
        if (run == 1) {
            record.results[store_column(&layout, "error_max") - layout.setting_count] = NAN;
        }
        assert_true(store_add(store, &record, &err));
    }
    assert_true(store_forget_failed(store, &forgotten, &err));
    assert_int_equal(forgotten, 1);
    assert_true(store_has(store, 1, &has, &err) && !has);
    assert_true(store_close(store, &err));
    assert_int_equal(count_right_rows(), 2);
}

static bool refuse_third(const Layout *layout, const Record *record, void *context, Err *err)
{
    (void)layout;
    (void)context;
    return record->run < 2 || err_set(err, ERR_USAGE, "enough");
}

static void a_taker_that_fails_ends_it_with_its_error(void **state)
{
    (void)state;
    Err err = {0};
    make_store(20);
    Store *store = store_view(path, &err);
    assert_false(store_each(store, refuse_third, NULL, &err));
    assert_string_equal(err.text, "enough");
    store_close(store, &err);
    assert_true(store_close(NULL, &err));
}

static void what_is_looked_at_cannot_be_written(void **state)
{
    (void)state;
    Err err = {0};
    const Layout layout = study_layout();
    make_store(20);
    Store *store = store_view(path, &err);
    const Record record = study_record(&layout, 30);
    assert_false(store_add(store, &record, &err) && store_commit(store, &err));
    assert_int_equal(err.kind, ERR_FILE);
    err = (Err){0};
    store_close(store, &err);
    assert_int_equal(count_right_rows(), 20);
}

#define STORE_TEST(name) cmocka_unit_test_setup_teardown(name, set_up, tear_down)

int main(void)
{
    const struct CMUnitTest tests[] = {
        STORE_TEST(rows_come_back_bit_for_bit),
        STORE_TEST(numbers_at_the_edge_come_back),
        STORE_TEST(a_run_is_never_there_twice),
        STORE_TEST(what_was_committed_outlives_a_kill),
        STORE_TEST(a_store_at_work_is_looked_at_and_not_worked_on),
        STORE_TEST(who_looks_holds_up_nobody),
        STORE_TEST(another_study_is_refused_with_what_differs),
        STORE_TEST(columns_of_one_name_are_a_mistake_of_the_case),
        STORE_TEST(a_sweep_forgets_what_failed),
        STORE_TEST(a_run_that_missed_its_truth_is_made_again),
        STORE_TEST(a_taker_that_fails_ends_it_with_its_error),
        STORE_TEST(what_is_looked_at_cannot_be_written),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
