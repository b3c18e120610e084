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
#include <gsl/gsl_errno.h>
#include <gsl/gsl_min.h>
#include <gsl/gsl_roots.h>
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

static bool gsl_root(double *c, double low, double high, double tolerance, double *x)
{
    gsl_root_fsolver *solver = gsl_root_fsolver_alloc(gsl_root_fsolver_brent);
    gsl_function function = {.function = wild, .params = c};
    bool is_found = false;
    int status = gsl_root_fsolver_set(solver, &function, low, high);
    for (int i = 0; status == GSL_SUCCESS && !is_found && i < 4000; i++) {
        status = gsl_root_fsolver_iterate(solver);
        const double a = gsl_root_fsolver_x_lower(solver);
        const double b = gsl_root_fsolver_x_upper(solver);
        is_found = b - a <= fmax(tolerance, 2.0 * DBL_EPSILON * fmax(fabs(a), fabs(b)));
    }
    *x = gsl_root_fsolver_root(solver);
    gsl_root_fsolver_free(solver);
    return is_found;
}

static bool gsl_minimum(double *c, double low, double middle, double high, double *x)
{
    gsl_min_fminimizer *minimizer = gsl_min_fminimizer_alloc(gsl_min_fminimizer_brent);
    gsl_function function = {.function = wild, .params = c};
    int status = gsl_min_fminimizer_set(minimizer, &function, middle, low, high);
    const bool is_enclosed = status == GSL_SUCCESS;
    double width = INFINITY;
    for (int i = 0; status == GSL_SUCCESS && i < 4000 && width > sqrt(DBL_EPSILON) * (high - low);
         i++) {
        status = gsl_min_fminimizer_iterate(minimizer);
        width = gsl_min_fminimizer_x_upper(minimizer) - gsl_min_fminimizer_x_lower(minimizer);
    }
    *x = is_enclosed ? gsl_min_fminimizer_x_minimum(minimizer) : 7.0;
    gsl_min_fminimizer_free(minimizer);
    return is_enclosed;
}

static void roots_are_those_of_gsl_to_the_last_bit(void **state)
{
    (void)state;
    uint64_t seed = lcg_stirred(1);
    unsigned found = 0;
    for (unsigned i = 0; i < 20000; i++) {
        double c[5];
        draw(&seed, i, c);
        const double low = -1.0 - 0.5 * lcg_draw(&seed);
        const double high = 1.0 + 0.5 * lcg_draw(&seed);
        const double tolerance = i % 3 == 0 ? 1e-6 : 0.0;
        double theirs = 7.0;
        double ours = 7.0;
        if (wild(low, c) * wild(high, c) >= 0.0) {
            continue;
        }
        const bool is_found = gsl_root(c, low, high, tolerance, &theirs);
        assert_int_equal(root_find(wild, c, low, high, tolerance, &ours), is_found);
        assert_true(ours == theirs);
        found++;
    }
    assert_true(found > 5000);
}

static void minima_are_those_of_gsl_to_the_last_bit(void **state)
{
    (void)state;
    uint64_t seed = lcg_stirred(2);
    unsigned found = 0;
    gsl_error_handler_t *former = gsl_set_error_handler_off();
    for (unsigned i = 0; i < 20000; i++) {
        double c[5];
        draw(&seed, i, c);
        const double middle = lcg_draw(&seed);
        const double low = middle - 0.5 - 0.4 * lcg_draw(&seed);
        const double high = middle + 0.5 + 0.4 * lcg_draw(&seed);
        double theirs = 7.0;
        double ours = 7.0;
        const bool is_found = gsl_minimum(c, low, middle, high, &theirs);
        assert_int_equal(root_minimum(wild, c, low, middle, high, &ours), is_found);
        assert_true(ours == theirs);
        found += is_found;
    }
    gsl_set_error_handler(former);
    assert_true(found > 1000);
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
        cmocka_unit_test(roots_are_those_of_gsl_to_the_last_bit),
        cmocka_unit_test(minima_are_those_of_gsl_to_the_last_bit),
        cmocka_unit_test(a_minimum_far_from_zero_takes_few_calls),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
