// Does the polynomial through a few values follow the function, and find its largest value?
#include "base/curve.h"

#include "close.h"

// What a force does in a step of a contact: part of a swing about a place of its own.
static double swing(double share, double phase)
{
    return 2.0 + sin(1.5 * share + phase);
}

static void sample(double values[CURVE_NODES], double phase)
{
    for (size_t k = 0; k < CURVE_NODES; k++) {
        values[k] = swing(curve_node(k), phase);
    }
}

static void nodes_ascend_from_end_to_end(void **state)
{
    (void)state;
    assert_true(curve_node(0) == 0.0);
    assert_true(curve_node(CURVE_NODES - 1) == 1.0);
    for (size_t k = 1; k < CURVE_NODES; k++) {
        assert_true(curve_node(k) > curve_node(k - 1));
    }
}

static void it_follows_a_swing(void **state)
{
    (void)state;
    double values[CURVE_NODES];
    double largest = 0.0;
    sample(values, 0.3);
    for (int k = 0; k <= 1000; k++) {
        largest = fmax(largest, fabs(curve_at(values, 1e-3 * k) - swing(1e-3 * k, 0.3)));
    }
    // the 12th term of the sine over three quarters of a radian to either side, 2 (0.75 / 2)^12 /
    // 12!, is 3e-14
    assert_true(largest < 1e-13);
    // control: a swing of nine radians is more than twelve values tell
    for (size_t k = 0; k < CURVE_NODES; k++) {
        values[k] = swing(6.0 * curve_node(k), 0.3);
    }
    assert_true(fabs(curve_at(values, 0.37) - swing(6.0 * 0.37, 0.3)) > 1e-6);
}

// The top of the swing wherever it is; outside of the interval the nearer end.
static void it_finds_the_top(void **state)
{
    (void)state;
    for (int k = 0; k <= 400; k++) {
        const double at = -0.1 + 0.003 * k;
        double values[CURVE_NODES];
        double share = -1.0;
        sample(values, 0.5 * M_PI - 1.5 * at);
        const double top = curve_top(values, &share);
        const double truth = fmin(fmax(at, 0.0), 1.0);
        // a maximum this near to an end may be told as the end
        const double end = truth < 1e-3 || truth > 1.0 - 1e-3 ? 1e-3 : 0.0;
        assert_true(fabs(share - truth) <= end + 1e-6);
        assert_true(fabs(top - swing(truth, 0.5 * M_PI - 1.5 * at)) <= 1.2 * end * end + 1e-12);
    }
}

static void what_stays_as_it_is_is_its_own_top(void **state)
{
    (void)state;
    const double values[CURVE_NODES] = {3, 3, 3, 3, 3, 3, 3, 3, 3, 3, 3, 3};
    double share = -1.0;
    assert_near(curve_top(values, &share), 3.0, 1e-14);
    assert_true(share >= 0.0 && share <= 1.0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(nodes_ascend_from_end_to_end),
        cmocka_unit_test(it_follows_a_swing),
        cmocka_unit_test(it_finds_the_top),
        cmocka_unit_test(what_stays_as_it_is_is_its_own_top),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
