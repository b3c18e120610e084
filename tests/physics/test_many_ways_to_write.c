// Is a mechanism the same in other units, another ground and other frames of its bodies?
//
// Up to the horizon rounding of the inputs grows 1e5 times: the truths differ by that, which is far
// less than the uncertainty that they state.
#include "close.h"

#include "rocker.h"

#include "measure/error.h"
#include "measure/truth.h"

static const RunWatch NOBODY = {NULL, NULL};

// 1: some ten roundings, grown 1e5 times
static const double ROUNDING = 1e-9;

static Truth truth_of(RockerView view)
{
    const Scenario scenario = rocker_make(view);
    Truth truth = truth_make(&scenario, NOBODY);
    assert_true(truth.trajectory->is_complete);
    assert_string_equal(truth.message, "");
    return truth;
}

static double difference(const Truth *one, const Truth *other)
{
    const TrajectoryError error =
        error_against(one->trajectory, other->trajectory, other->horizon_s);
    assert_true(error.is_known);
    return error.omega_max_in_horizon;
}

static void the_truth_is_the_same(void **state)
{
    (void)state;
    Truth plain = truth_of((RockerView){.length = 1.0});
    assert_true(plain.is_limited);
    const RockerView views[] = {
        {.length = 1.0, .in_millimetres = true},
        {.length = 1.0, .turn = 0.7},
        {.length = 1.0, .shift = {0.3, -1.1}},
        {.length = 1.0, .frames = 0.4},
    };
    for (size_t i = 0; i < sizeof views / sizeof *views; i++) {
        Truth other = truth_of(views[i]);
        // a sample more or less
        assert_close(other.horizon_s, plain.horizon_s, 2e-3);
        assert_close(other.uncertainty, plain.uncertainty, 0.2);
        assert_true(difference(&other, &plain) <= ROUNDING);
        assert_true(ROUNDING < plain.uncertainty);
        truth_finish(&other);
    }
    // control: a rocker longer by 10 nm is another mechanism
    Truth longer = truth_of((RockerView){.length = 1.0 + 1e-8});
    assert_true(difference(&longer, &plain) > ROUNDING);
    truth_finish(&longer);
    truth_finish(&plain);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_truth_is_the_same),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
