// Does the polynomial through values and slopes give back a polynomial, with its derivatives?
#include "base/hermite.h"

#include "close.h"

enum { NODES = 6 };

// x^degree + 0.5 x - 2 about a place and in a unit of its own, with its derivatives.
static HermitePoint power(double x, int degree, double origin, double width)
{
    const double u = (x - origin) / width;
    return (HermitePoint){
        .value = pow(u, degree) + 0.5 * u - 2.0,
        .slope = (degree * pow(u, degree - 1) + 0.5) / width,
        .curvature = degree * (degree - 1) * pow(u, degree - 2) / (width * width),
    };
}

// The largest difference of each kind between nodes, in units of the width.
static HermitePoint error_of(size_t node_count, int degree, double origin, double width)
{
    double nodes[NODES];
    double values[NODES];
    double slopes[NODES];
    for (size_t i = 0; i < node_count; i++) {
        // not equally far from each other
        nodes[i] = origin + width * (-1.0 + 0.37 * (double)i + 0.01 * (double)(i * i));
        const HermitePoint point = power(nodes[i], degree, origin, width);
        values[i] = point.value;
        slopes[i] = point.slope;
    }
    const Hermite hermite = hermite_fit(node_count, nodes, values, slopes);
    HermitePoint largest = {0.0, 0.0, 0.0};
    for (int k = -100; k <= 100; k++) {
        const double x = origin + 0.01 * k * width;
        const HermitePoint now = hermite_at(&hermite, x);
        const HermitePoint truth = power(x, degree, origin, width);
        largest.value = fmax(largest.value, fabs(now.value - truth.value));
        largest.slope = fmax(largest.slope, width * fabs(now.slope - truth.slope));
        largest.curvature =
            fmax(largest.curvature, width * width * fabs(now.curvature - truth.curvature));
    }
    return largest;
}

static void polynomials_up_to_the_eleventh_degree_are_exact(void **state)
{
    (void)state;
    for (int degree = 2; degree <= 11; degree++) {
        const HermitePoint error = error_of(NODES, degree, 0.0, 1.0);
        // rounding of numbers near 10 and their differences over steps of 0.4
        assert_near(error.value, 0.0, 1e-12);
        assert_near(error.slope, 0.0, 1e-11);
        assert_near(error.curvature, 0.0, 1e-10);
    }
}

// The control: twelve conditions cannot fix a thirteenth coefficient.
static void a_polynomial_of_the_twelfth_degree_is_not(void **state)
{
    (void)state;
    const HermitePoint error = error_of(NODES, 12, 0.0, 1.0);
    assert_true(error.value > 1e-5);
    assert_true(error.slope > 1e-4);
    assert_true(error.curvature > 1e-3);
}

static void two_nodes_carry_a_cubic_and_no_more(void **state)
{
    (void)state;
    assert_near(error_of(2, 3, 0.0, 1.0).curvature, 0.0, 1e-12);
    assert_true(error_of(2, 4, 0.0, 1.0).value > 1e-2);
}

// A run of steps of 10 us after six seconds: places differ in their twelfth digit from then on.
static void short_intervals_far_from_zero_lose_no_more_than_the_places_do(void **state)
{
    (void)state;
    const HermitePoint error = error_of(NODES, 11, 6.0, 1e-5);
    assert_near(error.value, 0.0, 1e-8);
    assert_near(error.slope, 0.0, 1e-7);
    assert_near(error.curvature, 0.0, 1e-6);
}

static void values_and_slopes_at_the_nodes_are_those_given(void **state)
{
    (void)state;
    const double nodes[] = {-1.0, 0.5, 2.0};
    const double values[] = {3.0, -1.0, 0.25};
    const double slopes[] = {0.0, 7.0, -2.0};
    const Hermite hermite = hermite_fit(3, nodes, values, slopes);
    for (size_t i = 0; i < 3; i++) {
        const HermitePoint point = hermite_at(&hermite, nodes[i]);
        assert_near(point.value, values[i], 1e-13);
        assert_near(point.slope, slopes[i], 1e-13);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(polynomials_up_to_the_eleventh_degree_are_exact),
        cmocka_unit_test(a_polynomial_of_the_twelfth_degree_is_not),
        cmocka_unit_test(two_nodes_carry_a_cubic_and_no_more),
        cmocka_unit_test(short_intervals_far_from_zero_lose_no_more_than_the_places_do),
        cmocka_unit_test(values_and_slopes_at_the_nodes_are_those_given),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
