// Does a piece of work that fails, hangs or takes all memory hurt no one but itself?
#include "measure/child.h"

#include "close.h"

#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

enum { LARGE = 1 << 20 };

static const ChildLimits NO_LIMITS = {0};

typedef struct Answer {
    double value;
    char filling[LARGE]; // more than any pipe holds at once
    int last;
} Answer;

static void answer(const void *context, void *result)
{
    Answer *own = result;
    own->value = 2.0 * *(const double *)context;
    own->last = 7;
}

static void leave(const void *context, void *result)
{
    (void)result;
    _exit(*(const int *)context);
}

static void raise_signal(const void *context, void *result)
{
    (void)result;
    raise(*(const int *)context);
}

static void give_up(const void *context, void *result)
{
    (void)context;
    (void)result;
    abort();
}

static void hang(const void *context, void *result)
{
    (void)context;
    (void)result;
    for (;;) {
        pause();
    }
}

// Sends so many bytes to whatever socket it finds, closes that, and does not end.
static void linger(const void *context, void *result)
{
    static const double SENT = 2.5;
    (void)result;
    for (int file = 3; file < 64; file++) {
        struct stat about;
        if (fstat(file, &about) == 0 && S_ISSOCK(about.st_mode) &&
            write(file, &SENT, *(const size_t *)context) > 0) {
            close(file);
        }
    }
    for (;;) {
        pause();
    }
}

// 1 in the result where so much address space could be had, -1 where not. Nothing is written to it.
static void take_memory(const void *context, void *result)
{
    const size_t size = *(const size_t *)context;
    void *memory = mmap(NULL, size, PROT_READ, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    *(int *)result = memory != MAP_FAILED ? 1 : -1;
}

static Child run(ChildWork work, const void *context, void *result, size_t size, ChildLimits limits)
{
    Child child;
    Err err = {0};
    assert_true(child_start(&child, work, context, result, size, limits, &err));
    while (child.end == CHILD_RUNNING) {
        child_wait(&child, 1, 1.0);
    }
    return child;
}

static void the_result_comes_back_whole(void **state)
{
    (void)state;
    Answer *result = calloc(1, sizeof *result);
    const double number = 21.0;
    const Child child = run(answer, &number, result, sizeof *result, NO_LIMITS);
    assert_int_equal(child.end, CHILD_DONE);
    assert_near(result->value, 42.0, 0.0);
    assert_int_equal(result->last, 7);
    char words[CHILD_TEXT_SIZE];
    child_describe(&child, words);
    assert_string_equal(words, "done");
    free(result);
}

static void a_result_of_no_bytes_is_a_result(void **state)
{
    (void)state;
    const int status = 0;
    assert_int_equal(run(leave, &status, NULL, 0, NO_LIMITS).end, CHILD_DONE);
}

static void an_exit_without_a_result_is_told_apart(void **state)
{
    (void)state;
    const int statuses[] = {0, 3};
    for (int i = 0; i < 2; i++) {
        double result = 0.0;
        const Child child = run(leave, &statuses[i], &result, sizeof result, NO_LIMITS);
        assert_int_equal(child.end, CHILD_EXITED);
        assert_int_equal(child.code, statuses[i]);
        char words[CHILD_TEXT_SIZE];
        child_describe(&child, words);
        assert_non_null(strstr(words, "and no result"));
    }
}

static void a_signal_is_told_by_its_number_and_name(void **state)
{
    (void)state;
    const int number = SIGSEGV;
    double result;
    Child child = run(raise_signal, &number, &result, sizeof result, NO_LIMITS);
    assert_int_equal(child.end, CHILD_SIGNALLED);
    assert_int_equal(child.code, SIGSEGV);
    child = run(give_up, NULL, &result, sizeof result, NO_LIMITS);
    assert_int_equal(child.code, SIGABRT);
    char words[CHILD_TEXT_SIZE];
    child_describe(&child, words);
    assert_string_equal(words, "ended by signal 6 (Aborted)");
}

static void work_that_hangs_is_ended_when_its_time_is_over(void **state)
{
    (void)state;
    const time_t before = time(NULL);
    double result;
    const Child child = run(hang, NULL, &result, sizeof result, (ChildLimits){.time_s = 0.05});
    assert_int_equal(child.end, CHILD_TIMED_OUT);
    assert_true(time(NULL) - before < 30);
    char words[CHILD_TEXT_SIZE];
    child_describe(&child, words);
    assert_string_equal(words, "took longer than its limit of 0.05 s");
}

static void work_that_wants_all_memory_does_not_get_it(void **state)
{
    (void)state;
    if (!CHILD_CAN_LIMIT_MEMORY) {
        print_message("# address space cannot be limited under this sanitizer\n");
        return;
    }
    const size_t wanted = (size_t)2 << 30;
    int result = 0;
    const ChildLimits limits = {.memory_bytes = (size_t)1 << 30};
    assert_int_equal(run(take_memory, &wanted, &result, sizeof result, limits).end, CHILD_DONE);
    assert_int_equal(result, -1);
    // the control: without the limit it does
    assert_int_equal(run(take_memory, &wanted, &result, sizeof result, NO_LIMITS).end, CHILD_DONE);
    assert_int_equal(result, 1);
}

// A busy machine may let a process that has sent its result end much later.
static void work_that_has_sent_its_result_need_not_have_ended(void **state)
{
    (void)state;
    double result = 0.0;
    const size_t all = sizeof result;
    assert_int_equal(run(linger, &all, &result, sizeof result, NO_LIMITS).end, CHILD_DONE);
    assert_true(result == 2.5);
    // the control: with a part of it
    const size_t part = sizeof result - 1;
    assert_int_equal(run(linger, &part, &result, sizeof result, NO_LIMITS).end, CHILD_CLOSED);
}

static void several_go_on_at_a_time(void **state)
{
    (void)state;
    Child children[4] = {0};
    double results[4] = {0};
    Err err = {0};
    const double number = 1.0;
    Answer *answers = calloc(2, sizeof *answers);
    assert_true(child_start(&children[0], hang, NULL, &results[0], 8, NO_LIMITS, &err));
    assert_true(
        child_start(&children[1], answer, &number, &answers[0], sizeof(Answer), NO_LIMITS, &err));
    assert_true(
        child_start(&children[3], answer, &number, &answers[1], sizeof(Answer), NO_LIMITS, &err));
    while (children[1].end == CHILD_RUNNING || children[3].end == CHILD_RUNNING) {
        child_wait(children, 4, 1.0);
    }
    assert_int_equal(children[0].end, CHILD_RUNNING);
    assert_int_equal(answers[0].last, 7);
    assert_int_equal(answers[1].last, 7);
    char words[CHILD_TEXT_SIZE];
    child_describe(&children[0], words);
    assert_string_equal(words, "still running");
    child_kill(&children[0]);
    assert_int_equal(children[0].end, CHILD_SIGNALLED);
    assert_int_equal(children[0].code, SIGKILL);
    // nothing is left to wait for
    child_wait(children, 4, 60.0);
    child_kill(&children[2]);
    free(answers);
}

// What one worker answered, and from which process.
typedef struct Served {
    double value;
    pid_t process;
    int times; // that the process worked
} Served;

// Twice the number; at a negative one it dies.
static void serve(const void *context, void *result)
{
    static int times = 0;
    const double number = *(const double *)context;
    if (number < 0.0) {
        abort();
    }
    *(Served *)result = (Served){2.0 * number, getpid(), ++times};
}

static void a_worker_lives_for_many_pieces_and_dies_of_one(void **state)
{
    (void)state;
    double numbers[] = {1.0, 2.0, 3.0, -1.0};
    Child child;
    Served served = {0};
    Err err = {0};
    assert_true(child_start_worker(&child, serve, &numbers[0], sizeof(double), &served,
                                   sizeof served, NO_LIMITS, &err));
    const pid_t process = child.process;
    for (int i = 0; i < 3; i++) {
        if (i > 0) {
            assert_true(child_order(&child, &numbers[i]));
            assert_false(child_is_at_rest(&child));
        }
        child_wait(&child, 1, 60.0);
        assert_int_equal(child.end, CHILD_DONE);
        assert_true(child_is_at_rest(&child));
        assert_close(served.value, 2.0 * numbers[i], 0.0);
        assert_int_equal(served.process, process);
        assert_int_equal(served.times, i + 1);
    }
    assert_true(child_order(&child, &numbers[3]));
    child_wait(&child, 1, 60.0);
    assert_int_equal(child.end, CHILD_SIGNALLED);
    assert_int_equal(child.code, SIGABRT);
    assert_false(child_is_at_rest(&child));
}

static void a_worker_that_was_killed_at_rest_takes_no_order(void **state)
{
    (void)state;
    double number = 1.0;
    Child child;
    Served served = {0};
    Err err = {0};
    assert_true(child_start_worker(&child, serve, &number, sizeof number, &served, sizeof served,
                                   NO_LIMITS, &err));
    child_wait(&child, 1, 60.0);
    assert_true(child_is_at_rest(&child));
    siginfo_t gone;
    kill(child.process, SIGKILL);
    assert_int_equal(waitid(P_PID, (id_t)child.process, &gone, WEXITED | WNOWAIT), 0);
    assert_false(child_order(&child, &number));
    assert_false(child_is_at_rest(&child));
    child_kill(&child);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_result_comes_back_whole),
        cmocka_unit_test(a_result_of_no_bytes_is_a_result),
        cmocka_unit_test(an_exit_without_a_result_is_told_apart),
        cmocka_unit_test(a_signal_is_told_by_its_number_and_name),
        cmocka_unit_test(work_that_hangs_is_ended_when_its_time_is_over),
        cmocka_unit_test(work_that_wants_all_memory_does_not_get_it),
        cmocka_unit_test(work_that_has_sent_its_result_need_not_have_ended),
        cmocka_unit_test(several_go_on_at_a_time),
        cmocka_unit_test(a_worker_lives_for_many_pieces_and_dies_of_one),
        cmocka_unit_test(a_worker_that_was_killed_at_rest_takes_no_order),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
