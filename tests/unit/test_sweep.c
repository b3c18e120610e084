// Does every run of a study become a row, whatever becomes of it, and nothing else suffer?
//
// The work of the processes is put in their place: each run does, by its number, what a run must
// not do.
#include "commands/study/sweep.h"

#include "complete_run.h"
#include "measure/child.h"
#include "scratch.h"

#include <assert.h>
#include <signal.h>
#include <string.h>
#include <sys/mman.h>
#include <time.h>

// lines of noise: more than any pipe holds; and bytes of memory a time
enum { RUN_MAX = 64, PATH_SIZE = 512, NOISE = 1 << 16, BITE = 1 << 20 };

// What the processes of a sweep tell the test, in memory that all of them share.
typedef struct Board {
    unsigned started[RUN_MAX]; // times a run was begun
    unsigned certified;        // truths begun
    unsigned at_work;          // now
    unsigned at_work_max;
    unsigned with_truth; // runs that had one
    unsigned processes;  // that made runs
    unsigned spoilt;     // runs that ended in a process that had made others
} Board;

static Board *board;

typedef struct Study {
    char path[PATH_SIZE];
    char store_path[PATH_SIZE];
    Spec spec;
    Layout layout;
    Store *store;
    size_t row_count;
    Record rows[RUN_MAX];
    uint64_t stop_at; // runs made, after which it is to stop; 0: never
    SweepState state;
} Study;

static void rest(double seconds)
{
    const struct timespec time = {(time_t)seconds,
                                  (long)(1e9 * (seconds - (double)(time_t)seconds))};
    nanosleep(&time, NULL);
}

// The runs: three speeds, each a truth of its own, and so many steps.
static void write_study(Study *study, int steps, bool has_truth, const char *limits)
{
    FILE *stream = fopen(study->path, "w");
    char folder[PATH_SIZE];
    assert_non_null(stream);
    assert_non_null(getcwd(folder, sizeof folder));
    char step[64] = "50 us"; // a range has at least two numbers
    if (steps > 1) {
        snprintf(step, sizeof step, "{from: 50 us, to: 100 us, count: %d}", steps);
    }
    fprintf(stream,
            "title: a test\ncase: %s/cases/paper/ideal-nominal.yaml\n"
            "set: {run.samples: 36}\n"
            "vary:\n  drive.speed: [500 rpm, 1000 rpm, 1500 rpm]\n"
            "  run.step: %s\n"
            "truth: %s\nlimits: %s\n",
            folder, step, has_truth ? "true" : "false", limits);
    fclose(stream);
}

static void open_store(Study *study)
{
    Err err = {0};
    const StoreHead head = {
        .layout = &study->layout, .run_count = design_run_count(&study->spec), .key_count = 0};
    study->store = store_open(study->store_path, &head, false, &err);
    if (study->store == NULL) {
        fail_msg("%s", err.text);
    }
}

static void open_study(Study *study, int steps, bool has_truth, const char *limits)
{
    Err err = {0};
    Cell values[RECORD_SETTING_MAX];
    BackendKind backend;
    Scenario *scenario = calloc(1, sizeof *scenario);
    write_study(study, steps, has_truth, limits);
    if (!spec_read(study->path, &study->spec, &err)) {
        fail_msg("%s", err.text);
    }
    design_values(&study->spec, 0, values);
    assert_true(design_scenario(&study->spec, values, scenario, &backend, &err));
    metrics_layout(&study->spec, scenario, &study->layout);
    scenario_free(scenario);
    free(scenario);
    open_store(study);
}

static bool keep_row(const Layout *layout, const Record *record, void *context, Err *err)
{
    (void)layout;
    (void)err;
    Study *study = context;
    study->rows[study->row_count++] = *record;
    return true;
}

static void no_telling(const SweepState *state, void *context)
{
    ((Study *)context)->state = *state;
}

static bool should_stop(void *context)
{
    const Study *study = context;
    return study->stop_at > 0 && study->state.made >= study->stop_at;
}

// Sweeps, closes the store, and reads the rows of it.
static SweepEnd sweep(Study *study, const SweepWork *work, size_t jobs, Shard shard)
{
    SweepEnd end;
    Err err = {0};
    const Sweep order = {
        .spec = &study->spec,
        .layout = &study->layout,
        .shard = shard,
        .jobs = jobs,
        .store = study->store,
        .report = no_telling,
        .should_stop = should_stop,
        .context = study,
        .work = work,
    };
    if (!sweep_execute(&order, &end, &study->state, &err) || !store_close(study->store, &err)) {
        fail_msg("%s", err.text);
    }
    study->row_count = 0;
    study->store = NULL;
    Store *view = store_view(study->store_path, &err);
    assert_non_null(view);
    assert_true(store_each(view, keep_row, study, &err));
    assert_true(store_close(view, &err));
    return end;
}

static const Shard ALL = {0, 1};

// A run that is well, and is seen on the board.
static void be_well(const SweepRun *task, Record *record)
{
    __atomic_fetch_add(&board->started[task->run], 1, __ATOMIC_SEQ_CST);
    const unsigned now = __atomic_add_fetch(&board->at_work, 1, __ATOMIC_SEQ_CST);
    unsigned most = board->at_work_max;
    while (now > most && !__atomic_compare_exchange_n(&board->at_work_max, &most, now, false,
                                                      __ATOMIC_SEQ_CST, __ATOMIC_SEQ_CST)) {
    }
    record->run = task->run;
    for (size_t i = 0; i < RECORD_RESULT_MAX; i++) {
        record->results[i] = NAN;
    }
    design_values(task->spec, task->run, record->settings);
    if (task->truth != NULL && task->truth->trajectory->is_complete) {
        __atomic_fetch_add(&board->with_truth, 1, __ATOMIC_SEQ_CST);
    }
    rest(0.01);
    record->hash = task->run + 1;
    __atomic_fetch_sub(&board->at_work, 1, __ATOMIC_SEQ_CST);
}

static void eat_bit_by_bit(void)
{
    for (;;) {
        volatile char *bite = malloc(BITE);
        assert(bite != NULL);
        bite[0] = 1;
    }
}

static void eat_at_once(void)
{
    volatile size_t much = (size_t)1 << 44;
    volatile char *bite = malloc(much);
    bite[much / 2] = 1; // a library that does not look
}

static void close_everything(void)
{
    for (int file = 3; file < 256; file++) {
        close(file);
    }
    for (;;) {
        pause();
    }
}

static void make_noise(void)
{
    for (int i = 0; i < NOISE; i++) {
        fputs("noise\n", stderr);
    }
}

// What run 1, 2, ... does; all beyond are well.
enum { ABORTS = 1, EATS = 3, EATS_AT_ONCE, CRASHES, EXITS, CLOSES, NOT_FINITE, NOISY };

static void misbehave(const SweepRun *task, Record *record)
{
    switch (task->run) {
    case ABORTS:
        fprintf(stderr, "something before\nODE INTERNAL ERROR 1: it broke\n\n");
        abort();
    case EATS:
        eat_bit_by_bit();
        break;
    case EATS_AT_ONCE:
        eat_at_once();
        break;
    case CRASHES:
        raise(SIGSEGV);
        break;
    case EXITS:
        exit(0);
    case CLOSES:
        close_everything();
        break;
    case NOISY:
        make_noise();
        break;
    default:
        break;
    }
    be_well(task, record);
    if (task->run == NOT_FINITE) {
        record->outcome = RUN_OUTCOME_FAILED;
        strcpy(record->reason, "not finite at 1 ms");
    }
}

static void hang(const SweepRun *task, Record *record)
{
    (void)task;
    (void)record;
    for (;;) {
        pause();
    }
}

// Runs of the process that is at work; of the test's own process none.
static unsigned made_here;

static void be_counted(const SweepRun *task, Record *record)
{
    __atomic_fetch_add(&board->processes, made_here++ == 0 ? 1 : 0, __ATOMIC_SEQ_CST);
    be_well(task, record);
}

// What goes before spoils every process: it takes one run only.
static void be_spoilt(const SweepRun *task, Record *record)
{
    if (made_here++ > 0) {
        __atomic_fetch_add(&board->spoilt, 1, __ATOMIC_SEQ_CST);
        abort();
    }
    be_well(task, record);
}

// Settling the block ends a process, by itself or by the limit.
static void abort_over_block(const SweepRun *task, Record *record)
{
    if (!task->is_alone) {
        __atomic_fetch_add(&board->spoilt, 1, __ATOMIC_SEQ_CST);
        abort();
    }
    be_well(task, record);
}

static void hang_over_block(const SweepRun *task, Record *record)
{
    if (!task->is_alone) {
        __atomic_fetch_add(&board->spoilt, 1, __ATOMIC_SEQ_CST);
        pause();
    }
    be_well(task, record);
}

static void certify_well(const SweepTruth *task, void *packed)
{
    __atomic_fetch_add(&board->certified, 1, __ATOMIC_SEQ_CST);
    task_certify(&task->task, packed);
}

static void certify_badly(const SweepTruth *task, void *packed)
{
    (void)task;
    (void)packed;
    __atomic_fetch_add(&board->certified, 1, __ATOMIC_SEQ_CST);
    fprintf(stderr, "no truth in it\n");
    abort();
}

// The first process is killed, as by a machine that runs out of memory.
static void certify_at_last(const SweepTruth *task, void *packed)
{
    if (__atomic_fetch_add(&board->certified, 1, __ATOMIC_SEQ_CST) == 0) {
        raise(SIGKILL);
    }
    task_certify(&task->task, packed);
}

static const SweepWork WELL = {be_well, certify_well};
static const SweepWork BADLY = {misbehave, certify_well};
static const SweepWork HANGING = {hang, certify_well};
static const SweepWork WITHOUT_TRUTH = {be_well, certify_badly};
static const SweepWork COUNTED = {be_counted, certify_well};
static const SweepWork SPOILT = {be_spoilt, certify_well};
static const SweepWork ABORTING_OVER_BLOCK = {abort_over_block, certify_well};
static const SweepWork HANGING_OVER_BLOCK = {hang_over_block, certify_well};
static const SweepWork AT_LAST = {be_well, certify_at_last};

static void check_row(const Study *study, uint64_t run, RunOutcome outcome, const char *reason)
{
    assert_true(run < study->row_count);
    const Record *row = &study->rows[run];
    assert_int_equal(row->run, run);
    if (row->outcome != outcome || strcmp(row->reason, reason) != 0) {
        fail_msg("run %d: %s '%s', not %s '%s'", (int)run, RUN_OUTCOME_WORDS[row->outcome],
                 row->reason, RUN_OUTCOME_WORDS[outcome], reason);
    }
    // its settings are there whatever became of it
    Cell values[RECORD_SETTING_MAX];
    design_values(&study->spec, run, values);
    assert_near(row->settings[0].number, values[0].number, 0.0);
    assert_near(row->settings[1].number, values[1].number, 0.0);
}

static void a_block_is_made_by_one_process(void **state)
{
    Study *study = *state;
    open_study(study, 4, false, "{time: 600 s, memory: 200 MB}");
    study->spec.has_neighbours = true;
    assert_int_equal(sweep(study, &COUNTED, 2, ALL), SWEEP_COMPLETE);
    assert_int_equal(study->row_count, 12);
    assert_int_equal(board->processes, 1);
    assert_int_equal(board->at_work_max, 1);
}

// Once: the others of the block then settle by themselves.
static void a_process_that_ends_over_its_block_takes_no_run_with_it(void **state)
{
    Study *study = *state;
    const SweepWork *const works[] = {&ABORTING_OVER_BLOCK, &HANGING_OVER_BLOCK};
    for (unsigned i = 0; i < 2; i++) {
        open_study(study, 4, false, "{time: 500 ms, memory: 200 MB}");
        study->spec.has_neighbours = true;
        assert_int_equal(sweep(study, works[i], 2, ALL), SWEEP_COMPLETE);
        assert_int_equal(study->row_count, 12);
        for (uint64_t run = 0; run < 12; run++) {
            check_row(study, run, RUN_OUTCOME_OK, "");
        }
        assert_int_equal(board->spoilt, i + 1);
        assert_int_equal(unlink(study->store_path), 0);
        spec_finish(&study->spec);
    }
}

static void what_goes_wrong_is_one_row_with_its_reason(void **state)
{
    Study *study = *state;
    open_study(study, 4, false, "{time: 600 s, memory: 200 MB}");
    assert_int_equal(sweep(study, &BADLY, 2, ALL), SWEEP_COMPLETE);
    assert_int_equal(study->row_count, 12);
    check_row(study, 0, RUN_OUTCOME_OK, "");
    check_row(study, ABORTS, RUN_OUTCOME_ENDED,
              "ended by signal 6 (Aborted): ODE INTERNAL ERROR 1: it broke");
    check_row(study, CRASHES, RUN_OUTCOME_ENDED, "ended by signal 11 (Segmentation fault)");
    check_row(study, EXITS, RUN_OUTCOME_ENDED, "ended with status 0 and no result");
    check_row(study, CLOSES, RUN_OUTCOME_ENDED, "closed its pipe without a result and went on");
    check_row(study, NOT_FINITE, RUN_OUTCOME_FAILED, "not finite at 1 ms");
    check_row(study, NOISY, RUN_OUTCOME_OK, "");
    check_row(study, 10, RUN_OUTCOME_OK, "");
    check_row(study, 11, RUN_OUTCOME_OK, "");
    assert_int_equal(study->state.failed, 7);
    assert_int_equal(study->state.done, 12);
    if (!CHILD_CAN_LIMIT_MEMORY) {
        print_message("# address space cannot be limited under this sanitizer\n");
        return;
    }
    assert_int_equal(study->rows[EATS].outcome, RUN_OUTCOME_NO_MEMORY);
    assert_non_null(strstr(study->rows[EATS].reason, "limit of 200 MB of memory: "));
    assert_non_null(strstr(study->rows[EATS].reason, "Assertion"));
    check_row(study, EATS_AT_ONCE, RUN_OUTCOME_NO_MEMORY,
              "wanted more than its limit of 200 MB of memory");
}

// Three groups, each with a truth that its processes have known from their start; two processes a
// job.
static void a_process_makes_many_runs(void **state)
{
    Study *study = *state;
    open_study(study, 8, true, "{time: 600 s}");
    assert_int_equal(sweep(study, &COUNTED, 1, ALL), SWEEP_COMPLETE);
    assert_int_equal(study->row_count, 24);
    assert_int_equal(board->with_truth, 24);
    assert_in_range(board->processes, 3, 8);
}

static void a_run_is_judged_by_what_it_does_in_a_process_of_its_own(void **state)
{
    Study *study = *state;
    open_study(study, 4, false, "{time: 600 s}");
    assert_int_equal(sweep(study, &SPOILT, 2, ALL), SWEEP_COMPLETE);
    assert_int_equal(study->row_count, 12);
    for (uint64_t run = 0; run < 12; run++) {
        check_row(study, run, RUN_OUTCOME_OK, "");
        assert_int_equal(board->started[run], 1);
    }
    // control: there were processes that had to be replaced
    assert_in_range(board->spoilt, 1, 12);
    assert_int_equal(study->state.failed, 0);
}

// None of them can end, so that a busy machine changes nothing.
static void a_run_that_hangs_is_ended_at_its_limit(void **state)
{
    Study *study = *state;
    open_study(study, 1, false, "{time: 0.2 s}");
    assert_int_equal(sweep(study, &HANGING, 2, ALL), SWEEP_COMPLETE);
    assert_int_equal(study->row_count, 3);
    for (uint64_t run = 0; run < 3; run++) {
        check_row(study, run, RUN_OUTCOME_TIMED_OUT, "took longer than its limit of 0.2 s");
    }
    assert_int_equal(study->state.failed, 3);
}

static void every_truth_is_made_once_and_every_run_has_it(void **state)
{
    Study *study = *state;
    open_study(study, 5, true, "{time: 60 s}");
    sweep(study, &WELL, 2, ALL);
    assert_int_equal(study->row_count, 15);
    assert_int_equal(board->certified, 3);
    assert_int_equal(board->with_truth, 15);
    assert_int_equal(study->state.without_truth, 0);
    assert_int_equal(board->at_work_max, 2);
    for (int i = 0; i < 15; i++) {
        assert_int_equal(board->started[i], 1);
        assert_int_equal(study->rows[i].hash, i + 1);
    }
}

static void no_more_runs_go_on_at_a_time_than_there_are_jobs(void **state)
{
    Study *study = *state;
    open_study(study, 5, true, "{time: 60 s}");
    sweep(study, &WELL, 1, ALL);
    assert_int_equal(study->row_count, 15);
    assert_int_equal(board->at_work_max, 1);
    assert_int_equal(board->with_truth, 15);
}

static void more_jobs_than_runs_do_no_harm(void **state)
{
    Study *study = *state;
    open_study(study, 2, true, "{time: 60 s}");
    sweep(study, &WELL, SWEEP_JOB_MAX, ALL);
    assert_int_equal(study->row_count, 6);
    assert_int_equal(board->certified, 3);
}

static void a_truth_that_cannot_be_had_stops_no_run_and_is_told(void **state)
{
    Study *study = *state;
    open_study(study, 2, true, "{time: 60 s}");
    sweep(study, &WITHOUT_TRUTH, 2, ALL);
    assert_int_equal(study->row_count, 6);
    for (uint64_t i = 0; i < 6; i++) {
        check_row(study, i, RUN_OUTCOME_OK, "");
    }
    assert_int_equal(board->with_truth, 0);
    assert_int_equal(study->state.without_truth, 6);
    assert_string_equal(study->state.no_truth, "ended by signal 6 (Aborted)");
}

static void a_truth_whose_process_is_killed_is_made_again(void **state)
{
    Study *study = *state;
    open_study(study, 2, true, "{time: 60 s}");
    sweep(study, &AT_LAST, 2, ALL);
    assert_int_equal(study->row_count, 6);
    assert_int_equal(board->with_truth, 6);
    assert_int_equal(board->certified, 4);
    assert_int_equal(study->state.without_truth, 0);
}

static void a_first_run_that_makes_no_case_costs_the_others_no_truth(void **state)
{
    Study *study = *state;
    open_study(study, 2, true, "{time: 60 s}");
    // the first step of each speed is longer than the whole run
    for (size_t i = 0; i < study->spec.variable_count; i++) {
        if (strcmp(study->spec.variables[i].key, "run.step") == 0) {
            study->spec.variables[i].low = 1e6;
        }
    }
    sweep(study, &WELL, 2, ALL);
    assert_int_equal(study->row_count, 6);
    assert_int_equal(board->certified, 3);
    assert_true(board->with_truth >= 3);
    assert_int_equal(study->state.without_truth, 0);
}

static void what_was_stopped_goes_on_and_makes_nothing_twice(void **state)
{
    Study *study = *state;
    open_study(study, 8, true, "{time: 60 s}");
    study->stop_at = 7;
    assert_int_equal(sweep(study, &WELL, 2, ALL), SWEEP_STOPPED);
    const size_t before = study->row_count;
    assert_true(before >= 7 && before < 24);
    unsigned begun[RUN_MAX];
    memcpy(begun, board->started, sizeof begun);
    bool is_there[RUN_MAX] = {false};
    for (size_t i = 0; i < before; i++) {
        is_there[study->rows[i].run] = true;
    }
    study->stop_at = 0;
    open_store(study);
    assert_int_equal(sweep(study, &WELL, 2, ALL), SWEEP_COMPLETE);
    assert_int_equal(study->row_count, 24);
    assert_int_equal(study->state.made, 24 - before);
    assert_int_equal(study->state.done, 24);
    for (int i = 0; i < 24; i++) {
        assert_int_equal(board->started[i], begun[i] + (is_there[i] ? 0 : 1));
    }
    // and a third time there is nothing to do, not even a truth
    const unsigned certified = board->certified;
    open_store(study);
    assert_int_equal(sweep(study, &WELL, 2, ALL), SWEEP_COMPLETE);
    assert_int_equal(study->state.made, 0);
    assert_int_equal(board->certified, certified);
}

static void shards_share_the_runs(void **state)
{
    Study *study = *state;
    open_study(study, 3, true, "{time: 60 s}");
    uint64_t rows = 0;
    for (uint64_t i = 0; i < 2; i++) {
        const Shard shard = {i, 2};
        sweep(study, &WELL, 2, shard);
        rows += design_shard_count(&study->spec, shard);
        assert_int_equal(study->row_count, rows);
        assert_int_equal(study->state.done, study->state.total);
        open_store(study);
    }
    assert_int_equal(rows, 9);
    // groups stay whole: no truth is made by two of them
    assert_int_equal(board->certified, 3);
}

static void the_usual_work_makes_what_one_run_makes_by_itself(void **state)
{
    Study *study = *state;
    open_study(study, 2, true, "{time: 60 s, memory: 2 GB}");
    sweep(study, NULL, 2, ALL);
    assert_int_equal(study->row_count, 6);
    for (uint64_t i = 0; i < 6; i++) {
        check_row(study, i, RUN_OUTCOME_OK, "");
        BackendKind backend;
        Err err = {0};
        Scenario *scenario = calloc(1, sizeof *scenario);
        assert_true(
            design_scenario(&study->spec, study->rows[i].settings, scenario, &backend, &err));
        Trajectory *trajectory = complete_run(scenario, backend);
        assert_true(study->rows[i].hash == trajectory->hash);
        trajectory_destroy(trajectory);
        scenario_free(scenario);
        free(scenario);
    }
}

static int set_up(void **state)
{
    Study *study = calloc(1, sizeof *study);
    scratch_path("sweep.yaml", study->path, sizeof study->path);
    scratch_path("sweep.sqlite", study->store_path, sizeof study->store_path);
    board = mmap(NULL, sizeof *board, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    *state = study;
    return study == NULL || board == MAP_FAILED ? -1 : 0;
}

static int tear_down(void **state)
{
    Study *study = *state;
    Err err = {0};
    store_close(study->store, &err);
    spec_finish(&study->spec);
    unlink(study->path);
    unlink(study->store_path);
    free(study);
    return munmap(board, sizeof *board);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
#define SWEEP_TEST(name) cmocka_unit_test_setup_teardown(name, set_up, tear_down)
        SWEEP_TEST(what_goes_wrong_is_one_row_with_its_reason),
        SWEEP_TEST(a_block_is_made_by_one_process),
        SWEEP_TEST(a_process_that_ends_over_its_block_takes_no_run_with_it),
        SWEEP_TEST(a_process_makes_many_runs),
        SWEEP_TEST(a_run_is_judged_by_what_it_does_in_a_process_of_its_own),
        SWEEP_TEST(a_run_that_hangs_is_ended_at_its_limit),
        SWEEP_TEST(every_truth_is_made_once_and_every_run_has_it),
        SWEEP_TEST(no_more_runs_go_on_at_a_time_than_there_are_jobs),
        SWEEP_TEST(more_jobs_than_runs_do_no_harm),
        SWEEP_TEST(a_truth_that_cannot_be_had_stops_no_run_and_is_told),
        SWEEP_TEST(a_truth_whose_process_is_killed_is_made_again),
        SWEEP_TEST(a_first_run_that_makes_no_case_costs_the_others_no_truth),
        SWEEP_TEST(what_was_stopped_goes_on_and_makes_nothing_twice),
        SWEEP_TEST(shards_share_the_runs),
        SWEEP_TEST(the_usual_work_makes_what_one_run_makes_by_itself),
#undef SWEEP_TEST
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
