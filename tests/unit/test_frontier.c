// Is what nothing beats on the frontier, and nothing else?
#include "measure/ladder.h"

#include "close.h"

enum { COUNT = 6 };

static void what_nothing_beats_is_on_the_frontier(void **state)
{
    (void)state;
    const double times[COUNT] = {1.0, 2.0, 3.0, 4.0, 2.5, 1.0};
    const double errors[COUNT] = {8.0, 4.0, 5.0, 1.0, 4.0, 9.0};
    const bool truth[COUNT] = {true, true, false, true, false, false};
    bool marks[COUNT];
    frontier_mark(COUNT, times, errors, marks);
    for (int i = 0; i < COUNT; i++) {
        assert_int_equal(marks[i], truth[i]);
    }
}

static void what_is_hardly_more_accurate_is_not_worth_its_time(void **state)
{
    (void)state;
    const double times[4] = {1.0, 1.0, 2.0, 3.0};
    const double errors[4] = {1.0, 1.0, 0.995, 0.985};
    const bool truth[4] = {true, false, false, true};
    bool marks[4];
    frontier_mark(4, times, errors, marks);
    for (int i = 0; i < 4; i++) {
        assert_int_equal(marks[i], truth[i]);
    }
}

static void what_failed_is_no_point_and_beats_nothing(void **state)
{
    (void)state;
    const double times[3] = {1.0, 0.5, NAN};
    const double errors[3] = {1.0, NAN, 0.0};
    bool marks[3];
    frontier_mark(3, times, errors, marks);
    assert_true(marks[0]);
    assert_false(marks[1] || marks[2]);
    assert_int_equal(frontier_cheapest(3, times, errors, 0.0, 10.0), 0);
}

static void the_fastest_that_meets_the_error_is_the_cheapest(void **state)
{
    (void)state;
    const double times[4] = {1.0, 3.0, 2.0, 2.0};
    const double errors[4] = {1e-2, 1e-4, 9e-4, 8e-4};
    assert_int_equal(frontier_cheapest(4, times, errors, 0.0, 1e-2), 0);
    assert_int_equal(frontier_cheapest(4, times, errors, 0.0, 1e-3), 3);
    assert_int_equal(frontier_cheapest(4, times, errors, 0.0, 1e-4), 1);
    assert_int_equal(frontier_cheapest(4, times, errors, 0.0, 1e-5), 4);
    // what the truth does not know is not given to the scheme
    assert_int_equal(frontier_cheapest(4, times, errors, 1e-6, 1e-4), 4);
    assert_int_equal(frontier_cheapest(4, times, errors, 1.5e-4, 1e-3), 3);
    assert_int_equal(frontier_cheapest(4, times, errors, 3e-4, 1e-3), 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_nothing_beats_is_on_the_frontier),
        cmocka_unit_test(what_is_hardly_more_accurate_is_not_worth_its_time),
        cmocka_unit_test(what_failed_is_no_point_and_beats_nothing),
        cmocka_unit_test(the_fastest_that_meets_the_error_is_the_cheapest),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
