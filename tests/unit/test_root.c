// Are roots found to the last bit, and is it said where there is none?
#include "base/root.h"

#include "base/lcg.h"

// cmocka.h needs these before it
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <float.h>
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

// Functions with roots and minima of many kinds: smooth, flat, steep, with corners and jumps.
static double wild(double x, void *context)
{
    const double *c = context;
    switch ((int)c[0]) {
    case 0:
        return (x - c[1]) * (x - c[2]) * (x - c[3]) + 0.1 * c[4];
    case 1:
        return sin(10.0 * x + c[1]) + c[2] * x + 0.3 * c[3];
    case 2:
        return pow(x - c[1], 9.0) + 1e-9 * c[2];
    case 3:
        return exp(20.0 * c[2] * x) - exp(20.0 * c[1]);
    case 4:
        return fabs(x - c[1]) - 0.3 + 0.2 * c[2];
    case 5:
        return x < c[1] ? -1.0 + 0.1 * x : 1.0 + 0.1 * c[3] * x;
    default:
        return 1e-12 * (x * x * x - 0.1 * c[1]) * exp(10.0 * c[2]);
    }
}

static void draw(uint64_t *seed, unsigned number, double c[5])
{
    c[0] = number % 7;
    for (int i = 1; i < 5; i++) {
        c[i] = lcg_draw(seed);
    }
}

// Whether the function changes its sign within so much of x.
static bool crosses(double *c, double x, double reach)
{
    return wild(x - reach, c) * wild(x + reach, c) <= 0.0;
}

// The truth is the function itself: where it changes its sign.
static void a_root_lies_where_the_sign_changes(void **state)
{
    (void)state;
    uint64_t seed = lcg_stirred(1);
    unsigned found = 0;
    unsigned missed = 0;
    for (unsigned i = 0; i < 20000; i++) {
        double c[5];
        draw(&seed, i, c);
        const double low = -1.0 - 0.5 * lcg_draw(&seed);
        const double high = 1.0 + 0.5 * lcg_draw(&seed);
        const double tolerance = i % 3 == 0 ? 1e-6 : 0.0;
        double x = 7.0;
        if (wild(low, c) * wild(high, c) >= 0.0) {
            continue;
        }
        assert_true(root_find(wild, c, low, high, tolerance, &x));
        assert_true(x >= low && x <= high);
        const double reach = fmax(tolerance, 2.0 * DBL_EPSILON * fmax(fabs(x), DBL_MIN));
        assert_true(crosses(c, x, reach));
        // the control: not anywhere nearby
        missed += !crosses(c, x + 3e-6, reach);
        found++;
    }
    assert_true(found > 5000);
    assert_true(missed > found / 2);
}

// Whether the function is no lower on that side of x, as near as that reach.
static bool is_low_on(double *c, double x, double reach)
{
    for (int i = 0; i < 8; i++) {
        if (wild(x + ldexp(reach, -i), c) >= wild(x, c)) {
            return true;
        }
    }
    return false;
}

static bool is_lowest(double *c, double x, double reach)
{
    return is_low_on(c, x, reach) && is_low_on(c, x, -reach);
}

// The truth is the function itself: it rises to both sides.
static void at_a_minimum_the_function_rises_to_both_sides(void **state)
{
    (void)state;
    uint64_t seed = lcg_stirred(2);
    unsigned found = 0;
    unsigned missed = 0;
    for (unsigned i = 0; i < 20000; i++) {
        double c[5];
        draw(&seed, i, c);
        const double middle = lcg_draw(&seed);
        const double low = middle - 0.5 - 0.4 * lcg_draw(&seed);
        const double high = middle + 0.5 + 0.4 * lcg_draw(&seed);
        const bool is_enclosed = wild(middle, c) < wild(low, c) && wild(middle, c) < wild(high, c);
        double x = 7.0;
        assert_int_equal(root_minimum(wild, c, low, middle, high, &x), is_enclosed);
        if (!is_enclosed) {
            assert_true(x == 7.0);
            continue;
        }
        assert_true(wild(x, c) <= wild(middle, c));
        // the width that is left of the interval, on both sides of the minimum, and to be beyond
        // both
        const double reach = 4.0 * sqrt(DBL_EPSILON) * (high - low);
        if (!is_lowest(c, x, reach)) {
            fail_msg("kind %d: %.17g of %.17g to %.17g is no minimum", (int)c[0], x, low, high);
        }
        // the control: not anywhere nearby
        missed += !is_lowest(c, x + 1e-3, reach);
        found++;
    }
    assert_true(found > 1000);
    assert_true(missed > found / 2);
}

typedef struct Wave {
    double at; // where it is lowest
    size_t calls;
} Wave;

static double wave(double x, void *context)
{
    Wave *of = context;
    of->calls++;
    return -cos(x - of->at);
}

// So far from zero, rounding of x leaves more of the interval than is asked for.
static void a_minimum_far_from_zero_takes_few_calls(void **state)
{
    (void)state;
    for (double at = 1.0; at < 1e6; at *= 10.0) {
        Wave far = {at, 0};
        double x;
        assert_true(root_minimum(wave, &far, at - 0.02, at + 0.001, at + 0.015, &x));
        assert_true(fabs(x - at) <= 4.0 * sqrt(DBL_EPSILON) * at);
        assert_true(far.calls < 60);
    }
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
        cmocka_unit_test(a_root_lies_where_the_sign_changes),
        cmocka_unit_test(at_a_minimum_the_function_rises_to_both_sides),
        cmocka_unit_test(a_minimum_far_from_zero_takes_few_calls),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
