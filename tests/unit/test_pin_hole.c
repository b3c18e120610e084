// Is the gap between a pin and its hole what geometry says, seen without the same formula?
#include "close.h"
#include "sample.h"

#include "kernel/pin_hole.h"

#include <stdbool.h>

static const double HOLE_RADIUS = 5.0075e-3;
static const double PIN_RADIUS = 4.993e-3;
enum { POSE_COUNT = 100000 };

// A fixed stream of numbers in [0, 1): the 64-bit linear congruential generator of Knuth.
static double draw(uint64_t *seed)
{
    *seed = *seed * 6364136223846793005u + 1442695040888963407u;
    return (double)(*seed >> 11) * 0x1p-53;
}

// The gap by another road: the smallest distance from the pin's circle to the hole's wall,
// R - max over the pin's circle of the distance to the hole's centre, the maximum found by golden
// section over the angle, in long double.
static long double searched_gap(long double ex, long double ey, long double *at)
{
    const long double golden = 0.618033988749894848L;
    const long double pi = acosl(-1.0L);
    // the distance has one maximum over a turn; a coarse look says where
    long double best = 0.0L;
    long double best_square = -1.0L;
    for (int i = 0; i < 12; i++) {
        const long double angle = 2.0L * pi * i / 12.0L;
        const long double x = ex + PIN_RADIUS * cosl(angle);
        const long double y = ey + PIN_RADIUS * sinl(angle);
        if (x * x + y * y > best_square) {
            best_square = x * x + y * y;
            best = angle;
        }
    }
    long double low = best - pi / 6.0L;
    long double high = best + pi / 6.0L;
    long double distance = 0.0L;
    for (int i = 0; i < 60; i++) {
        const long double a = high - golden * (high - low);
        const long double b = low + golden * (high - low);
        const long double da = hypotl(ex + PIN_RADIUS * cosl(a), ey + PIN_RADIUS * sinl(a));
        const long double db = hypotl(ex + PIN_RADIUS * cosl(b), ey + PIN_RADIUS * sinl(b));
        if (da > db) {
            high = b;
        } else {
            low = a;
        }
        distance = fmaxl(distance, fmaxl(da, db));
    }
    *at = 0.5L * (low + high);
    return HOLE_RADIUS - distance;
}

static void a_hundred_thousand_poses_agree_with_a_search_over_the_circles(void **state)
{
    (void)state;
    uint64_t seed = 1;
    const double clearance = HOLE_RADIUS - PIN_RADIUS;
    for (size_t i = 0; i < sample_size(POSE_COUNT); i++) {
        const Vec2 hole = {draw(&seed) - 0.5, draw(&seed) - 0.5};
        // every scale from a nanometre to ten times the clearance
        const double size = 1e-9 * pow(1.45e5, draw(&seed));
        const double angle = 6.283185307179586 * draw(&seed);
        const Vec2 pin = {hole.x + size * cos(angle), hole.y + size * sin(angle)};
        const Vec2 velocity = {4.0 * draw(&seed) - 2.0, 4.0 * draw(&seed) - 2.0};
        const PinHole pose = pin_hole_pose(hole, pin, velocity, clearance);

        // the hole's centre rounds the pin's, so the search starts from the rounded difference
        const long double ex = (long double)pin.x - hole.x;
        const long double ey = (long double)pin.y - hole.y;
        long double direction;
        const double gap = (double)searched_gap(ex, ey, &direction);
        assert_near(pose.gap, gap, 2e-18); // two bits of the radii
        assert_near(pose.penetration, -pose.gap, 0.0);
        assert_true(pose.has_normal);
        // the flat maximum shows its place to the square root of long double's last bit
        const double blur = 1e-12 / size;
        assert_near(pose.normal.x, -(double)cosl(direction), blur);
        assert_near(pose.normal.y, -(double)sinl(direction), blur);
    }
}

static void the_approach_speed_is_the_rate_of_the_penetration(void **state)
{
    (void)state;
    uint64_t seed = 2;
    const double clearance = HOLE_RADIUS - PIN_RADIUS;
    for (size_t i = 0; i < sample_size(POSE_COUNT); i++) {
        const Vec2 hole = {0.0, 0.0};
        const Vec2 pin = {4e-5 * (draw(&seed) - 0.5), 4e-5 * (draw(&seed) - 0.5)};
        const Vec2 velocity = {2.0 * draw(&seed) - 1.0, 2.0 * draw(&seed) - 1.0};
        const PinHole now = pin_hole_pose(hole, pin, velocity, clearance);
        if (now.eccentricity_size < 1e-6) {
            continue; // the difference below is too coarse next to the centre
        }
        const Vec2 move = vec2_scale(1e-10, velocity);
        const PinHole later = pin_hole_pose(hole, vec2_add(pin, move), velocity, clearance);
        const PinHole before = pin_hole_pose(hole, vec2_sub(pin, move), velocity, clearance);
        const double rate = (later.penetration - before.penetration) / 2e-10;
        assert_near(now.approach_speed, rate, 1e-7);
        // control: the normal the other way round would have the pin come out of the wall
        assert_near(vec2_dot(now.normal, velocity), -now.approach_speed, 1e-15);
    }
}

static void the_force_on_the_pin_points_inwards(void **state)
{
    (void)state;
    const PinHole pose =
        pin_hole_pose((Vec2){0.1, 0.2}, (Vec2){0.1, 0.2 - 2e-5}, (Vec2){0.0, -0.3}, 1.45e-5);
    assert_near(pose.penetration, 5.5e-6, 1e-16);
    assert_near(pose.normal.x, 0.0, 0.0);
    assert_near(pose.normal.y, 1.0, 1e-15); // the pin lies low: the wall pushes it up
    assert_near(pose.approach_speed, 0.3, 1e-15);
    const Vec2 point = pin_hole_contact_point(&pose, (Vec2){0.1, 0.2}, HOLE_RADIUS);
    assert_near(point.x, 0.1, 1e-16);
    assert_near(point.y, 0.2 - HOLE_RADIUS, 1e-16);
}

static void a_concentric_pin_has_no_normal_and_no_nan(void **state)
{
    (void)state;
    const Vec2 centre = {0.3, -0.7};
    const PinHole pose = pin_hole_pose(centre, centre, (Vec2){3.0, 4.0}, 1.45e-5);
    assert_false(pose.has_normal);
    assert_near(pose.gap, 1.45e-5, 0.0);
    assert_near(pose.penetration, -1.45e-5, 0.0);
    assert_near(pose.normal.x, 0.0, 0.0);
    assert_near(pose.normal.y, 0.0, 0.0);
    assert_near(pose.approach_speed, 5.0, 0.0); // away from the centre, whichever way it goes
    const Vec2 point = pin_hole_contact_point(&pose, centre, HOLE_RADIUS);
    assert_near(point.x, centre.x, 0.0);
    assert_near(point.y, centre.y, 0.0);
}

static void the_smallest_eccentricities_keep_a_unit_normal(void **state)
{
    (void)state;
    for (double size = 1e-320; size < 1e-3; size *= 1e3) {
        const PinHole pose =
            pin_hole_pose((Vec2){0.0, 0.0}, (Vec2){3.0 * size, 4.0 * size}, (Vec2){1.0, 1.0}, 1e-5);
        assert_true(pose.has_normal);
        const double tolerance = size < 1e-300 ? 1e-3 : 1e-14; // subnormal numbers have few digits
        assert_near(pose.normal.x, -0.6, tolerance);
        assert_near(pose.normal.y, -0.8, tolerance);
        assert_near(pose.approach_speed, 1.4, 2.0 * tolerance);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_hundred_thousand_poses_agree_with_a_search_over_the_circles),
        cmocka_unit_test(the_approach_speed_is_the_rate_of_the_penetration),
        cmocka_unit_test(the_force_on_the_pin_points_inwards),
        cmocka_unit_test(a_concentric_pin_has_no_normal_and_no_nan),
        cmocka_unit_test(the_smallest_eccentricities_keep_a_unit_normal),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
