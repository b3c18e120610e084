// Are eigenvalues those that the matrix was made of, and do their vectors fit?
#include "base/eigen.h"
#include "base/lcg.h"

// cmocka.h needs these before it
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>
#include <string.h>

enum { MOST = 24 };

// The companion matrix of (z - 3)(z + 2)(z^2 - 2 z + 2)(z - 0.001).
static void the_roots_of_a_polynomial_are_found(void **state)
{
    (void)state;
    enum { N = 5 };
    const double complex roots[N] = {3.0, -2.0, 1.0 + I, 1.0 - I, 0.001};
    double complex polynomial[N + 1] = {1.0};
    for (int k = 0; k < N; k++) {
        for (int i = k + 1; i > 0; i--) {
            polynomial[i] -= roots[k] * polynomial[i - 1];
        }
    }
    double a[N * N] = {0.0};
    for (int i = 0; i < N; i++) {
        a[i] = -creal(polynomial[i + 1]);
        if (i > 0) {
            a[i * N + i - 1] = 1.0;
        }
    }
    double complex found[N];
    assert_true(eigen_values(N, a, found));
    for (int i = 0; i < N; i++) {
        assert_true(cabs(found[i] - roots[i]) < 1e-13);
    }
}

static double residual(size_t n, const double *a, double complex value, bool is_left,
                       const double complex *x)
{
    double largest = 0.0;
    for (size_t i = 0; i < n; i++) {
        double complex sum = -value * x[i];
        for (size_t k = 0; k < n; k++) {
            sum += (is_left ? a[k * n + i] : a[i * n + k]) * x[k];
        }
        largest = fmax(largest, cabs(sum));
    }
    return largest;
}

static void values_and_vectors_fit_the_matrix(void **state)
{
    (void)state;
    uint64_t seed = 7;
    for (size_t n = 1; n <= MOST; n++) {
        double a[MOST * MOST];
        double trace = 0.0;
        for (size_t i = 0; i < n * n; i++) {
            // entries of many sizes
            a[i] = lcg_draw(&seed) * pow(10.0, lcg_draw(&seed));
            trace += i % (n + 1) == 0 ? a[i] : 0.0;
        }
        double complex values[MOST];
        double complex sum = 0.0;
        assert_true(eigen_values(n, a, values));
        for (size_t k = 0; k < n; k++) {
            sum += values[k];
            assert_true(k == 0 || cabs(values[k]) <= (1.0 + 1e-12) * cabs(values[k - 1]));
            for (int is_left = 0; is_left < 2; is_left++) {
                double complex x[MOST];
                assert_true(eigen_vector(n, a, values[k], is_left, x));
                assert_true(residual(n, a, values[k], is_left, x) < 1e-10);
                // the control: the vector of no other value
                assert_true(residual(n, a, values[k] + 0.01, is_left, x) > 1e-4);
            }
        }
        assert_true(cabs(sum - trace) < 1e-11);
    }
}

static void rotations_of_a_plane_end(void **state)
{
    (void)state;
    // a QR step without an unusual shift turns this one into itself for ever
    const double a[9] = {0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0};
    double complex values[3];
    assert_true(eigen_values(3, a, values));
    for (int k = 0; k < 3; k++) {
        assert_true(cabs(cpow(values[k], 3.0) - 1.0) < 1e-13);
    }
}

static void what_is_no_number_is_refused(void **state)
{
    (void)state;
    const double a[4] = {1.0, NAN, 0.0, 1.0};
    double complex values[2];
    assert_false(eigen_values(2, a, values));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_roots_of_a_polynomial_are_found),
        cmocka_unit_test(values_and_vectors_fit_the_matrix),
        cmocka_unit_test(rotations_of_a_plane_end),
        cmocka_unit_test(what_is_no_number_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
