// Are finite turns, their rates and their second rates those of rotations?
#include "close.h"

#include "base/lcg.h"
#include "reference/space/turn.h"

static Vec3 draw(uint64_t *seed, double size)
{
    const double x = lcg_draw(seed);
    const double y = lcg_draw(seed);
    const Vec3 a = {x, y, lcg_draw(seed)};
    return vec3_scale(size / vec3_length(a), a);
}

// a turned by a vector s, with what the turn adds told apart.
static Vec3 turned(const Mat3 *moved, Vec3 a)
{
    return vec3_add(a, mat3_apply(moved, a));
}

// The turns by which the series, its end and the closed form are passed.
static const double SIZES[] = {0.0, 1e-9, 1e-3, 0.3, 1.0, 1.7, 1.74, 2.5, 3.1, 5.0};

enum { SIZE_COUNT = sizeof SIZES / sizeof *SIZES };

static void a_turn_is_that_of_its_quaternion(void **state)
{
    (void)state;
    uint64_t seed = 3;
    for (size_t i = 0; i < SIZE_COUNT; i++) {
        const Vec3 s = vec3_scale(SIZES[i], draw(&seed, 1.0));
        const Vec3 a = draw(&seed, 1.0);
        Turn turn;
        turn_by_vector(s, a, &turn);
        const Vec3 truth = quat_rotate(quat_of_turn(s), a);
        assert_true(vec3_length(vec3_sub(turned(&turn.moved, a), truth)) < 4e-15);
        if (SIZES[i] > 0.0) {
            const Mat3 about = turn_about(vec3_scale(1.0 / SIZES[i], s), SIZES[i]);
            assert_true(vec3_length(vec3_sub(turned(&about, a), truth)) < 4e-15);
        }
    }
    // a small one keeps its digits: 1e-12 rad to 1e-24
    Turn small;
    turn_by_vector((Vec3){0.0, 0.0, 1e-12}, (Vec3){0.0, 0.0, 0.0}, &small);
    assert_near(mat3_apply(&small.moved, (Vec3){1.0, 0.0, 0.0}).y, 1e-12, 1e-27);
    assert_near(mat3_apply(&small.moved, (Vec3){1.0, 0.0, 0.0}).x, -0.5e-24, 1e-39);
}

// The angular velocity from two turns nearby, by the vector of the turn from one to the other.
static Vec3 omega_between(Vec3 s, Vec3 rate, double h)
{
    const Quat after = quat_of_turn(vec3_add(s, vec3_scale(h, rate)));
    const Quat before = quat_of_turn(vec3_sub(s, vec3_scale(h, rate)));
    const Quat back = {before.w, -before.x, -before.y, -before.z};
    const Quat step = quat_product(after, back);
    // sin of half of the angle
    return vec3_scale(2.0 / (2.0 * h), (Vec3){step.x, step.y, step.z});
}

static void its_rates_are_those_of_differences(void **state)
{
    (void)state;
    uint64_t seed = 5;
    const double h = 1e-4;
    for (size_t i = 0; i < SIZE_COUNT; i++) {
        const Vec3 s = vec3_scale(SIZES[i], draw(&seed, 1.0));
        const Vec3 rate = draw(&seed, 1.0);
        Turn at;
        Turn after;
        Turn before;
        turn_by_vector(s, rate, &at);
        turn_by_vector(vec3_add(s, vec3_scale(h, rate)), rate, &after);
        turn_by_vector(vec3_sub(s, vec3_scale(h, rate)), rate, &before);
        assert_true(vec3_length(vec3_sub(at.omega, omega_between(s, rate, h))) < 1e-8);
        const Vec3 bias = vec3_scale(0.5 / h, vec3_sub(after.omega, before.omega));
        assert_true(vec3_length(vec3_sub(at.bias, bias)) < 1e-8);
        const Vec3 sum =
            vec3_add(vec3_scale(rate.x, at.rate[0]),
                     vec3_add(vec3_scale(rate.y, at.rate[1]), vec3_scale(rate.z, at.rate[2])));
        assert_true(vec3_length(vec3_sub(sum, at.omega)) < 1e-15);
        // control: the rate of the vector is not the angular velocity
        assert_true(SIZES[i] < 0.1 || vec3_length(vec3_sub(at.omega, rate)) > 1e-2);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_turn_is_that_of_its_quaternion),
        cmocka_unit_test(its_rates_are_those_of_differences),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
