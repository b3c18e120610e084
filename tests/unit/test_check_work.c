// What is said to be left of a check, from what its runs have taken so far.
#include "commands/check/check_work.h"

#include "close.h"
#include "kept.h"
#include "mechanism.h"

#include <stdlib.h>

// The state when it was asked first; the works are stopped then.
static bool stop(const CheckWorkState *state, void *context)
{
    *(CheckWorkState *)context = *state;
    return false;
}

static CheckWork over(const Scenario *scenario, double wall_s)
{
    return (CheckWork){.scenario = scenario, .is_over = true, .wall_s = wall_s};
}

static CheckWorkState begin(CheckWork *works, size_t count)
{
    CheckWorkState state = {0};
    const CheckWorkers workers = {.jobs = 1, .time_limit_s = 60.0, .wait = stop, .context = &state};
    Err err = {0};
    assert_true(check_work_do(&workers, works, count, &err));
    assert_int_equal(state.total, count);
    return state;
}

static void a_start_takes_as_long_as_others_of_its_case(void **state)
{
    (void)state;
    // far longer than it takes to ask
    Scenario slow = mechanism_loose(1);
    slow.run.revolutions = 100.0;
    const Scenario other = kept_copy(&slow);
    CheckMeasure *measures = calloc(2, sizeof *measures);
    assert_non_null(measures);
    CheckWork works[] = {
        over(&slow, 2.0),
        over(&slow, 4.0),
        {.scenario = &slow, .measure = &measures[0]},
        over(&other, 10.0),
        {.scenario = &other, .start = {.member = 1}, .measure = &measures[1]},
    };
    const CheckWorkState asked = begin(works, 5);
    assert_int_equal(asked.done, 3);
    // the one that runs is half done; the other waits for it
    assert_near(asked.left_s, 0.5 * 3.0 + 10.0, 1e-12);
    free(measures);
}

static void a_case_of_which_nothing_ran_takes_the_mean_of_all(void **state)
{
    (void)state;
    Scenario slow = mechanism_loose(1);
    slow.run.revolutions = 100.0;
    const Scenario others[] = {slow, slow};
    CheckMeasure *measure = calloc(1, sizeof *measure);
    assert_non_null(measure);
    CheckWork works[] = {
        over(&others[0], 3.0),
        over(&others[1], 9.0),
        {.scenario = &slow, .measure = measure},
    };
    assert_near(begin(works, 3).left_s, 0.5 * 6.0, 1e-12);
    // nothing is known of anything
    assert_near(begin(&works[2], 1).left_s, 0.0, 0.0);
    free(measure);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_start_takes_as_long_as_others_of_its_case),
        cmocka_unit_test(a_case_of_which_nothing_ran_takes_the_mean_of_all),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
