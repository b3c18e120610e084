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

// Of mpmath with 40 digits, and the three test values of Wichura's algorithm AS 241 (p = .25, .001
// and 1e-20): in all three ranges of the inverse, on both sides of where they meet (.075 and
// 1.4e-11).
static void the_inverse_is_right_to_rounding_in_every_range(void **state)
{
    (void)state;
    static const double INVERSES[][2] = {
        {0.4999, -0.00025066283008800749}, {0.25, -0.67448975019608174},
        {0.075, -1.4395314709384559},      {0.05, -1.6448536269514727},
        {0.001, -3.0902323061678135},      {1e-5, -4.2648907939228246},
        {1e-12, -7.0344838253011319},      {1e-20, -9.2623400897984076},
        {1e-100, -21.273453560965324},     {1e-300, -37.047096299361199},
    };
    for (size_t i = 0; i < sizeof INVERSES / sizeof INVERSES[0]; i++) {
        const double z = normal_quantile(INVERSES[i][0], -INFINITY, INFINITY);
        // p - 1/2, of which the middle range is a function, has lost the digits of 1/2 near it
        const double bound = 4e-16 * fabs(INVERSES[i][1]) + 1.2e-16;
        assert_near(z, INVERSES[i][1], bound);
        // the control: the bound sees a change of p in its 14th digit
        const double other = normal_quantile(INVERSES[i][0] * (1.0 + 1e-13), -INFINITY, INFINITY);
        assert_true(INVERSES[i][0] < 0.01 || !(fabs(other - INVERSES[i][1]) <= bound));
    }
    assert_close(normal_below(-37.0), 5.7255712225245768e-300, 1e-12);
    assert_close(normal_below(-0.25), 0.40129367431707628, 1e-15);
}

// There and back: the error of z, some five roundings of it, is z^2 times as large in the share of
// a tail.
static void a_share_is_that_of_its_quantile(void **state)
{
    (void)state;
    size_t checked = 0;
    for (double z = -37.0; z < 0.0; z += 0.0625) {
        const double share = normal_below(z);
        const double back = normal_quantile(share, -INFINITY, INFINITY);
        assert_near(back, z, 6e-16 * fmax(1.0, fabs(z)));
        assert_close(normal_below(back), share, 1e-15 * fmax(1.0, z * z));
        checked++;
    }
    assert_true(checked > 500);
}

// The inverse is right to some 1e-16 of z, which the density turns into a share.
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
        cmocka_unit_test(the_inverse_is_right_to_rounding_in_every_range),
        cmocka_unit_test(a_share_is_that_of_its_quantile),
        cmocka_unit_test(a_quantile_has_its_share_below_it),
        cmocka_unit_test(limits_are_kept_at_the_ends),
        cmocka_unit_test(the_plain_formula_fails_in_the_upper_tail),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
