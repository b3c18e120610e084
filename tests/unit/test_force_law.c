// Is the force law what its equations say, in both families, at every depth?
#include "close.h"

#include "kernel/force_law.h"

#include <stdbool.h>

// steel pin of 9.986 mm in a hole of 10.015 mm, 13 mm wide, by Johnson: A and B
static const double COMPLIANCE = 2.1668e-10;
static const double OFFSET = 11.4978;

// The force of the logarithmic family by bisection in long double: the test's own solution.
static double bisected_force(double penetration)
{
    long double low = 0.0L;
    long double high = expl((long double)OFFSET - 1.0L);
    for (int i = 0; i < 200; i++) {
        const long double middle = 0.5L * (low + high);
        const long double d = COMPLIANCE * middle * (OFFSET - logl(middle));
        if (d < penetration) {
            low = middle;
        } else {
            high = middle;
        }
    }
    return (double)(0.5L * (low + high));
}

// The integral of the elastic force from 0 to a depth: Simpson's rule in sqrt(d), whose odd
// powers make the integrand smooth at 0.
static double integrated_energy(const ForceLaw *law, double penetration)
{
    const int intervals = 20000;
    const double width = sqrt(penetration) / intervals;
    double sum = 0.0;
    for (int i = 0; i <= intervals; i++) {
        const double s = i * width;
        const double weight = i == 0 || i == intervals ? 1.0 : i % 2 == 1 ? 4.0 : 2.0;
        sum += weight * force_law_elastic(law, s * s) * 2.0 * s;
    }
    return sum * width / 3.0;
}

static void the_power_family_is_k_times_d_to_the_n(void **state)
{
    (void)state;
    const double exponents[] = {1.0, 1.5, 2.2, 10.0 / 9.0};
    for (size_t i = 0; i < sizeof exponents / sizeof *exponents; i++) {
        const ForceLaw law = force_law_power(6.6e10, exponents[i]);
        for (double d = 1e-12; d < 1e-3; d *= 3.0) {
            assert_close(force_law_elastic(&law, d), 6.6e10 * pow(d, exponents[i]), 1e-14);
        }
    }
    // control: the exponent matters
    const ForceLaw linear = force_law_power(6.6e10, 1.0);
    assert_true(force_law_elastic(&linear, 1e-6) > 100.0 * 6.6e10 * pow(1e-6, 1.5));
}

static void the_logarithmic_family_agrees_with_a_bisection(void **state)
{
    (void)state;
    const ForceLaw law = force_law_logarithmic(COMPLIANCE, OFFSET);
    const double limit = force_law_depth_limit(&law);
    for (double d = 1e-30; d < 0.999 * limit; d *= 1.7) {
        assert_close(force_law_elastic(&law, d), bisected_force(d), 1e-14);
    }
    assert_close(force_law_elastic(&law, 0.999 * limit), bisected_force(0.999 * limit), 1e-12);
}

static void the_logarithmic_family_ends_at_its_depth_limit(void **state)
{
    (void)state;
    const ForceLaw law = force_law_logarithmic(COMPLIANCE, OFFSET);
    const double limit = force_law_depth_limit(&law);
    assert_close(limit, COMPLIANCE * exp(OFFSET - 1.0), 1e-14);
    // the root is double there, so half the digits remain
    assert_close(force_law_elastic(&law, limit * (1.0 - 1e-14)), exp(OFFSET - 1.0), 1e-6);
    assert_true(isnan(force_law_elastic(&law, 1.001 * limit)));
    assert_true(isnan(force_law_tangent(&law, 1.001 * limit)));
    assert_true(isnan(force_law_force(&law, 1.001 * limit, -1e9, 1.0)));
    assert_true(isnan(force_law_penetration(&law, 1.001 * exp(OFFSET - 1.0))));
    const ForceLaw power = force_law_power(1.0, 1.5);
    assert_true(isinf(force_law_depth_limit(&power)));
}

static void penetration_inverts_force(void **state)
{
    (void)state;
    const ForceLaw laws[] = {force_law_power(2e11, 1.5), force_law_power(1e8, 1.0),
                             force_law_logarithmic(COMPLIANCE, OFFSET)};
    for (size_t i = 0; i < sizeof laws / sizeof *laws; i++) {
        for (double force = 1e-6; force < 1e4; force *= 5.0) {
            const double d = force_law_penetration(&laws[i], force);
            assert_close(force_law_elastic(&laws[i], d), force, 1e-13);
        }
    }
}

static void the_tangent_is_the_slope(void **state)
{
    (void)state;
    const ForceLaw laws[] = {force_law_power(2e11, 1.5), force_law_power(1e8, 1.0),
                             force_law_power(1e12, 2.5), force_law_logarithmic(COMPLIANCE, OFFSET)};
    for (size_t i = 0; i < sizeof laws / sizeof *laws; i++) {
        for (double d = 1e-9; d < 5e-6; d *= 4.0) {
            const double step = 1e-4 * d; // truncation 1e-8 of the slope, rounding 1e-12
            const double above = force_law_elastic(&laws[i], d + step);
            const double below = force_law_elastic(&laws[i], d - step);
            const double slope = (above - below) / (2.0 * step);
            assert_close(force_law_tangent(&laws[i], d), slope, 2e-8);
        }
    }
}

static void the_secant_times_penetration_is_the_force(void **state)
{
    (void)state;
    const ForceLaw laws[] = {force_law_power(2e11, 1.5), force_law_power(1e8, 1.0),
                             force_law_power(1e12, 2.5), force_law_logarithmic(COMPLIANCE, OFFSET)};
    for (size_t i = 0; i < sizeof laws / sizeof *laws; i++) {
        const double d = 1.3e-6;
        const double force = force_law_elastic(&laws[i], d);
        assert_close(force_law_secant(&laws[i], d) * d, force, 1e-14);
    }
    // control: the tangent would give 1.5 times the force of Hertz
    assert_close(force_law_tangent(&laws[0], 1e-6), 1.5 * force_law_secant(&laws[0], 1e-6), 1e-14);
}

static void energy_is_the_integral_of_the_force(void **state)
{
    (void)state;
    const ForceLaw laws[] = {force_law_power(2e11, 1.5), force_law_power(1e8, 1.0),
                             force_law_logarithmic(COMPLIANCE, OFFSET)};
    for (size_t i = 0; i < sizeof laws / sizeof *laws; i++) {
        for (double d = 1e-8; d < 7e-6; d *= 9.0) {
            assert_close(force_law_energy(&laws[i], d), integrated_energy(&laws[i], d), 1e-8);
        }
    }
}

static void nothing_acts_without_penetration(void **state)
{
    (void)state;
    ForceLaw laws[] = {force_law_power(2e11, 1.5), force_law_power(1e8, 1.0),
                       force_law_logarithmic(COMPLIANCE, OFFSET)};
    for (size_t i = 0; i < sizeof laws / sizeof *laws; i++) {
        laws[i].viscous = 100.0;
        for (int depth = 0; depth >= -1; depth--) {
            const double d = 1e-6 * depth;
            assert_near(force_law_elastic(&laws[i], d), 0.0, 0.0);
            assert_near(force_law_force(&laws[i], d, 1.0, 1.0), 0.0, 0.0);
            assert_near(force_law_energy(&laws[i], d), 0.0, 0.0);
            const double stiffness = i == 1 ? 1e8 : 0.0;
            assert_near(force_law_secant(&laws[i], d), stiffness, 0.0);
            assert_near(force_law_tangent(&laws[i], d), stiffness, 0.0);
        }
        assert_near(force_law_penetration(&laws[i], 0.0), 0.0, 0.0);
    }
}

static void damping_adds_its_term_and_never_pulls(void **state)
{
    (void)state;
    ForceLaw law = force_law_power(2e11, 1.5);
    const double d = 1e-6;
    const double elastic = force_law_elastic(&law, d);
    law.hysteresis = 0.5;
    law.viscous = 30.0;
    assert_close(force_law_force(&law, d, 0.2, 0.4), elastic * 1.25 + 6.0, 1e-14);
    assert_close(force_law_damping(&law, d, 0.4), 0.5 * elastic / 0.4 + 30.0, 1e-14);
    // the same force from elastic part and coefficient
    const double c = force_law_damping(&law, d, 0.4);
    assert_close(force_law_force(&law, d, -0.1, 0.4), elastic - 0.1 * c, 1e-13);
    // a pin that leaves fast is not held back
    assert_near(force_law_force(&law, d, -10.0, 0.4), 0.0, 0.0);
    // below the floor the impact speed counts as the floor
    assert_near(law.impact_speed_floor, 1e-3, 0.0);
    assert_close(force_law_damping(&law, d, 1e-9), force_law_damping(&law, d, 1e-3), 1e-15);
    law.hysteresis = 0.0;
    assert_near(force_law_damping(&law, d, 0.4), 30.0, 0.0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_power_family_is_k_times_d_to_the_n),
        cmocka_unit_test(the_logarithmic_family_agrees_with_a_bisection),
        cmocka_unit_test(the_logarithmic_family_ends_at_its_depth_limit),
        cmocka_unit_test(penetration_inverts_force),
        cmocka_unit_test(the_tangent_is_the_slope),
        cmocka_unit_test(the_secant_times_penetration_is_the_force),
        cmocka_unit_test(energy_is_the_integral_of_the_force),
        cmocka_unit_test(nothing_acts_without_penetration),
        cmocka_unit_test(damping_adds_its_term_and_never_pulls),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
