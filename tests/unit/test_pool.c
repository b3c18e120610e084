// Is every piece of work done once, at most so many at a time, and does a lost one stop no other?
#include "measure/child.h"

#include "close.h"

#include <stdlib.h>
#include <unistd.h>

enum { COUNT = 7, JOBS = 3, LOST = 4 };

// What the pool asked for and handed on.
typedef struct Log {
    size_t begun;
    size_t busy;
    size_t most; // at a time
    int taken[COUNT];
    int results[COUNT];
    size_t waits;
    size_t waits_most;  // then it is to stop; 0: never
    bool keeps_nothing; // no piece can be taken
    int context;
} Log;

// The square of the number, but no result of the one that is lost.
static void square(const void *context, void *result)
{
    const int number = *(const int *)context;
    if (number == LOST) {
        _exit(3);
    }
    *(int *)result = number * number;
}

static void hang(const void *context, void *result)
{
    (void)context;
    (void)result;
    for (;;) {
        pause();
    }
}

static bool next(void *owner, size_t *number, const void **context)
{
    Log *log = owner;
    if (log->begun == COUNT) {
        return false;
    }
    *number = log->begun++;
    log->context = (int)*number;
    *context = &log->context;
    log->busy++;
    log->most = log->busy > log->most ? log->busy : log->most;
    return true;
}

static bool take(void *owner, size_t number, const void *result, const Child *child, Err *err)
{
    Log *log = owner;
    log->busy--;
    log->taken[number]++;
    log->results[number] = child->end == CHILD_DONE ? *(const int *)result : -child->code;
    return !log->keeps_nothing || err_set(err, ERR_FILE, "this piece cannot be kept");
}

static bool wait(void *owner)
{
    Log *log = owner;
    return ++log->waits != log->waits_most;
}

static Pool pool_of(Log *log, ChildWork work)
{
    return (Pool){.jobs = JOBS,
                  .work = work,
                  .result_size = sizeof(int),
                  .next = next,
                  .take = take,
                  .wait = wait,
                  .owner = log};
}

static void each_piece_is_done_once_and_a_lost_one_stops_no_other(void **state)
{
    (void)state;
    Log log = {0};
    Err err = {0};
    const Pool pool = pool_of(&log, square);
    assert_true(pool_run(&pool, &err));
    assert_int_equal(log.most, JOBS);
    for (int i = 0; i < COUNT; i++) {
        assert_int_equal(log.taken[i], 1);
        assert_int_equal(log.results[i], i == LOST ? -3 : i * i);
    }
}

static void a_failure_to_take_a_piece_ends_everything(void **state)
{
    (void)state;
    Log log = {.keeps_nothing = true};
    Err err = {0};
    const Pool pool = pool_of(&log, square);
    assert_false(pool_run(&pool, &err));
    assert_string_equal(err.text, "this piece cannot be kept");
    // whichever ends first: no other has been begun by then
    assert_int_equal(log.begun, JOBS);
}

static void it_stops_when_it_is_asked_to_whatever_goes_on(void **state)
{
    (void)state;
    Log log = {.waits_most = 2};
    Err err = {0};
    const Pool pool = pool_of(&log, hang);
    assert_true(pool_run(&pool, &err));
    assert_int_equal(log.waits, 2);
    assert_int_equal(log.begun, JOBS);
    assert_int_equal(log.taken[0], 0);
}

static void a_piece_that_takes_too_long_is_taken_as_such(void **state)
{
    (void)state;
    Log log = {.begun = COUNT - 1};
    Err err = {0};
    Pool pool = pool_of(&log, hang);
    pool.limits.time_s = 0.05;
    assert_true(pool_run(&pool, &err));
    assert_int_equal(log.taken[COUNT - 1], 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_piece_is_done_once_and_a_lost_one_stops_no_other),
        cmocka_unit_test(a_failure_to_take_a_piece_ends_everything),
        cmocka_unit_test(it_stops_when_it_is_asked_to_whatever_goes_on),
        cmocka_unit_test(a_piece_that_takes_too_long_is_taken_as_such),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
