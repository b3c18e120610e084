// Is the normal distribution right in the middle, in the tails, and between limits?
#include "commands/study/normal.h"

#include "close.h"

// Digits of Abramowitz and Stegun, table 26.1, and of mpmath.
static void shares_and_quantiles_are_those_of_the_tables(void **state)
{
    (void)state;
    assert_near(normal_below(0.0), 0.5, 0.0);
    assert_close(normal_below(1.0), 0.84134474606854293, 1e-15);
    assert_close(normal_above(10.0), 7.6198530241605269e-24, 1e-13);
    assert_close(normal_below(-10.0), 7.6198530241605269e-24, 1e-13);
    assert_close(normal_quantile(0.975, -INFINITY, INFINITY), 1.9599639845400545, 1e-14);
    assert_close(normal_quantile(0.025, -INFINITY, INFINITY), -1.9599639845400545, 1e-14);
    assert_near(normal_quantile(0.5, -INFINITY, INFINITY), 0.0, 0.0);
}

// GSL's inverse is right to some 1e-13 of z, which the density turns into a share.
static void a_quantile_has_its_share_below_it(void **state)
{
    (void)state;
    static const double LIMITS[][2] = {
        {-INFINITY, INFINITY}, {-3.0, 3.0}, {-1.0, 0.5}, {0.2, 4.0},   {2.0, INFINITY},
        {-INFINITY, -2.0},     {5.0, 6.0},  {8.0, 9.0},  {-9.0, -8.0},
    };
    for (size_t i = 0; i < sizeof LIMITS / sizeof LIMITS[0]; i++) {
        const double low = LIMITS[i][0];
        const double high = LIMITS[i][1];
        double last = low;
        for (int k = 1; k < 200; k++) {
            const double share = k / 200.0;
            const double z = normal_quantile(share, low, high);
            assert_true(z > last && z < high);
            assert_near(normal_between(low, z) / normal_between(low, high), share, 1e-11);
            last = z;
        }
    }
}

static void limits_are_kept_at_the_ends(void **state)
{
    (void)state;
    assert_near(normal_quantile(0x1p-53, -3.0, 3.0), -3.0, 1e-12);
    assert_near(normal_quantile(1.0 - 0x1p-53, -3.0, 3.0), 3.0, 1e-12);
    assert_true(normal_quantile(1.0 - 0x1p-53, -3.0, 3.0) <= 3.0);
    assert_true(normal_quantile(0x1p-53, -3.0, 3.0) >= -3.0);
}

// The control: from below, as the formula stands in books, the tail above 8 has no digits.
static void the_plain_formula_fails_in_the_upper_tail(void **state)
{
    (void)state;
    const double whole = normal_below(9.0) - normal_below(8.0);
    assert_false(fabs(whole / normal_between(8.0, 9.0) - 1.0) <= 1e-2);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(shares_and_quantiles_are_those_of_the_tables),
        cmocka_unit_test(a_quantile_has_its_share_below_it),
        cmocka_unit_test(limits_are_kept_at_the_ends),
        cmocka_unit_test(the_plain_formula_fails_in_the_upper_tail),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
