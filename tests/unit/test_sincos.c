// Are sine and cosine as exact after many turns as in the first eighth of one?
#include "close.h"

#include "base/lcg.h"
#include "base/sincos.h"

#include <float.h>

enum { ANGLES = 100000 };

// The largest error over angles up to a size, in units of the last digit of 1.
static long double largest_error(long double most)
{
    uint64_t seed = lcg_stirred(1);
    long double largest = 0.0L;
    for (int i = 0; i < ANGLES; i++) {
        const long double angle = most * lcg_draw(&seed);
        long double s;
        long double c;
        sincos_find(angle, &s, &c);
        largest = fmaxl(largest, fmaxl(fabsl(s - sinl(angle)), fabsl(c - cosl(angle))));
    }
    return largest / LDBL_EPSILON;
}

static void they_are_those_of_the_library(void **state)
{
    (void)state;
    static const long double SIZES[] = {0.5L, 10.0L, 1e4L, 6e6L, 1e12L};
    for (size_t i = 0; i < sizeof SIZES / sizeof *SIZES; i++) {
        assert_true(largest_error(SIZES[i]) <= 1.0L);
    }
}

// Control: with quarters in one part a thousand turns leave less than half the digits of the play.
static void one_part_of_a_quarter_would_not_do(void **state)
{
    (void)state;
    const long double angle = 6283.25L;
    const long double quarters = rintl(angle / (0.5L * (long double)M_PI));
    const long double rest = angle - quarters * 0x1.921fb54442d18469898cc517p+0L;
    long double s;
    long double c;
    sincos_find(angle, &s, &c);
    const long double with_one = ((long)quarters & 1) != 0 ? fabsl(cosl(rest)) : fabsl(sinl(rest));
    assert_true(fabsl(with_one - fabsl(s)) > 100.0L * LDBL_EPSILON);
}

static void quarters_and_what_is_no_angle(void **state)
{
    (void)state;
    long double s;
    long double c;
    sincos_find(0.0L, &s, &c);
    assert_true(s == 0.0L && c == 1.0L);
    for (int k = -5; k <= 5; k++) {
        sincos_find(k * 0x1.921fb54442d18469898cc517p+0L, &s, &c);
        assert_true(fabsl(s - sinl(k * 0x1.921fb54442d18469898cc517p+0L)) <= LDBL_EPSILON);
    }
    sincos_find((long double)NAN, &s, &c);
    assert_true(isnan(s) && isnan(c));
    sincos_find((long double)INFINITY, &s, &c);
    assert_true(isnan(s) && isnan(c));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(they_are_those_of_the_library),
        cmocka_unit_test(one_part_of_a_quarter_would_not_do),
        cmocka_unit_test(quarters_and_what_is_no_angle),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
