// Are roots found to the last bit, and is it said where there is none?
#include "base/root.h"

// cmocka.h needs these before it
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>

static double cubic(double x, void *context)
{
    const double *shift = context;
    return x * x * x - *shift;
}

static double broken(double x, void *context)
{
    (void)context;
    return x > 0.0 ? NAN : -1.0;
}

static void a_root_is_found_to_the_last_bit(void **state)
{
    (void)state;
    double shift = 2.0;
    double x = 0.0;
    assert_true(root_find(cubic, &shift, 0.0, 2.0, 0.0, &x));
    assert_true(fabs(x - cbrt(2.0)) <= 4e-16);
}

static void a_coarse_tolerance_is_kept(void **state)
{
    (void)state;
    double shift = 2.0;
    double x = 0.0;
    assert_true(root_find(cubic, &shift, 0.0, 2.0, 1e-3, &x));
    assert_true(fabs(x - cbrt(2.0)) <= 1e-3);
}

static void a_root_at_an_end_is_found(void **state)
{
    (void)state;
    double shift = 8.0;
    double x = 0.0;
    assert_true(root_find(cubic, &shift, 2.0, 3.0, 0.0, &x));
    assert_true(x == 2.0);
    assert_true(root_find(cubic, &shift, 1.0, 2.0, 0.0, &x));
    assert_true(x == 2.0);
}

static void without_a_change_of_sign_there_is_none(void **state)
{
    (void)state;
    double shift = 2.0;
    double x = 7.0;
    assert_false(root_find(cubic, &shift, 2.0, 3.0, 0.0, &x));
    assert_true(x == 7.0);
}

static void a_function_that_is_not_finite_has_none(void **state)
{
    (void)state;
    double x = 7.0;
    assert_false(root_find(broken, NULL, -1.0, 1.0, 0.0, &x));
    assert_true(x == 7.0);
}

static void a_root_at_zero_ends(void **state)
{
    (void)state;
    double shift = 0.0;
    double x = 7.0;
    assert_true(root_find(cubic, &shift, -1.0, 1.5, 1e-15, &x));
    assert_true(fabs(x) <= 1e-15);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_root_is_found_to_the_last_bit),
        cmocka_unit_test(a_coarse_tolerance_is_kept),
        cmocka_unit_test(a_root_at_an_end_is_found),
        cmocka_unit_test(without_a_change_of_sign_there_is_none),
        cmocka_unit_test(a_function_that_is_not_finite_has_none),
        cmocka_unit_test(a_root_at_zero_ends),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
