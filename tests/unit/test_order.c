// Is the order of a power law found, and none where there is none?
#include "measure/ladder.h"

#include "close.h"

enum { COUNT = 8 };

static void fill(double *steps, double *errors, double factor, double order)
{
    for (int i = 0; i < COUNT; i++) {
        steps[i] = 1e-5 * pow(0.5, i);
        errors[i] = factor * pow(steps[i], order);
    }
}

static void a_power_law_is_found_exactly(void **state)
{
    (void)state;
    const double orders[] = {0.5, 1.0, 2.0, 4.0};
    for (int i = 0; i < 4; i++) {
        double steps[COUNT];
        double errors[COUNT];
        fill(steps, errors, 3e4, orders[i]);
        const Order order = order_fit(COUNT, steps, errors, 0.0);
        assert_true(order.is_known);
        assert_near(order.order, orders[i], 1e-10);
        assert_near(order.spread, 0.0, 1e-10);
        assert_int_equal(order.first, 0);
        assert_int_equal(order.last, COUNT - 1);
    }
}

static void the_fit_stops_at_the_floor(void **state)
{
    (void)state;
    double steps[COUNT];
    double errors[COUNT];
    fill(steps, errors, 1e4, 2.0);
    for (int i = 0; i < COUNT; i++) {
        errors[i] += 1e-9;
    }
    const Order order = order_fit(COUNT, steps, errors, 1e-8);
    assert_true(order.is_known);
    assert_near(order.order, 2.0, 0.05);
    assert_true(errors[order.last] > 1e-8);
    // the control: without the floor the noise is taken in
    assert_true(order_fit(COUNT, steps, errors, 0.0).last > order.last);
}

static void coarse_steps_that_are_not_asymptotic_are_left_out(void **state)
{
    (void)state;
    double steps[COUNT];
    double errors[COUNT];
    fill(steps, errors, 1e3, 1.0);
    errors[0] = 0.9 * errors[1];
    errors[1] = 1.05 * errors[2];
    const Order order = order_fit(COUNT, steps, errors, 0.0);
    assert_true(order.is_known);
    assert_int_equal(order.first, 2);
    assert_int_equal(order.last, COUNT - 1);
    assert_near(order.order, 1.0, 1e-10);
}

static void of_two_ranges_the_longer_and_then_the_finer_holds(void **state)
{
    (void)state;
    double steps[COUNT];
    double errors[COUNT];
    // order 1 over four steps, then order 2 over four
    fill(steps, errors, 1.0, 1.0);
    for (int i = 4; i < COUNT; i++) {
        errors[i] = 0.01 * errors[3] * pow(steps[i] / steps[3], 2.0);
    }
    Order order = order_fit(COUNT, steps, errors, 0.0);
    assert_near(order.order, 2.0, 1e-10);
    assert_int_equal(order.first, 4);
    // one more of order 1 makes that the longer
    errors[4] = steps[4];
    order = order_fit(COUNT, steps, errors, 0.0);
    assert_near(order.order, 1.0, 1e-10);
    assert_int_equal(order.last, 4);
}

static void an_error_that_does_not_fall_has_no_order(void **state)
{
    (void)state;
    double steps[COUNT];
    double errors[COUNT];
    fill(steps, errors, 0.1, 0.0);
    assert_false(order_fit(COUNT, steps, errors, 0.0).is_known);
    fill(steps, errors, 0.1, 0.1);
    assert_false(order_fit(COUNT, steps, errors, 0.0).is_known);
    for (int i = 0; i < COUNT; i++) {
        errors[i] = i % 2 == 0 ? 1e-3 : 1e-4;
    }
    assert_false(order_fit(COUNT, steps, errors, 0.0).is_known);
}

static void two_points_are_too_few_and_a_failed_one_divides(void **state)
{
    (void)state;
    double steps[COUNT];
    double errors[COUNT];
    fill(steps, errors, 1.0, 1.0);
    assert_false(order_fit(0, steps, errors, 0.0).is_known);
    assert_false(order_fit(2, steps, errors, 0.0).is_known);
    assert_true(order_fit(3, steps, errors, 0.0).is_known);
    errors[2] = NAN;
    errors[5] = INFINITY;
    assert_false(order_fit(COUNT, steps, errors, 0.0).is_known);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_power_law_is_found_exactly),
        cmocka_unit_test(the_fit_stops_at_the_floor),
        cmocka_unit_test(coarse_steps_that_are_not_asymptotic_are_left_out),
        cmocka_unit_test(of_two_ranges_the_longer_and_then_the_finer_holds),
        cmocka_unit_test(an_error_that_does_not_fall_has_no_order),
        cmocka_unit_test(two_points_are_too_few_and_a_failed_one_divides),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
