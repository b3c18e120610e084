// Are lengths and slight turns in the plane exact to rounding?
#include "close.h"

#include "base/vec2.h"

#include <float.h>

// Angles to both sides of the largest that is taken as slight.
static const double ANGLES[] = {0.0,    1e-300,  -1e-9, 1e-3, -0.02, 0.06,
                                0.0625, -0.0625, 0.063, -0.5, 3.0,   700.0};

enum { ANGLE_COUNT = sizeof ANGLES / sizeof *ANGLES };

static double error_of(Vec2 found, double angle, Vec2 a)
{
    const long double c = cosl(angle);
    const long double s = sinl(angle);
    return (double)(fabsl(c * a.x - s * a.y - found.x) + fabsl(s * a.x + c * a.y - found.y));
}

static void a_slight_turn_is_that_of_sine_and_cosine(void **state)
{
    (void)state;
    const Vec2 a = {0.6, -0.8};
    for (size_t i = 0; i < ANGLE_COUNT; i++) {
        // two roundings in each part
        assert_true(error_of(vec2_rotate_slightly(ANGLES[i], a), ANGLES[i], a) <= 4 * DBL_EPSILON);
    }
    assert_true(isnan(vec2_rotate_slightly(NAN, a).x));
}

// Control: without its last term the series of the cosine is seen to be off.
static void one_term_less_would_not_do(void **state)
{
    (void)state;
    const Vec2 a = {0.6, -0.8};
    const double x = 0.0625 * 0.0625;
    const double term = x * x * x * x / 40320.0;
    const Vec2 whole = vec2_rotate_slightly(0.0625, a);
    const Vec2 short_of = {whole.x - term * a.x, whole.y - term * a.y};
    assert_true(error_of(short_of, 0.0625, a) > 4 * DBL_EPSILON);
}

static void a_length_is_right_at_every_size(void **state)
{
    (void)state;
    for (double size = 1e-300; size < 1e300; size *= 1e10) {
        assert_close(vec2_length((Vec2){3.0 * size, -4.0 * size}), 5.0 * size, 2 * DBL_EPSILON);
    }
    assert_true(vec2_length((Vec2){0.0, -0.0}) == 0.0);
    assert_true(isnan(vec2_length((Vec2){NAN, 1.0})));
    // control: the plain root is nothing of small and infinite of large numbers
    assert_true(sqrt(vec2_dot((Vec2){1e-200, 0.0}, (Vec2){1e-200, 0.0})) == 0.0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_slight_turn_is_that_of_sine_and_cosine),
        cmocka_unit_test(one_term_less_would_not_do),
        cmocka_unit_test(a_length_is_right_at_every_size),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
