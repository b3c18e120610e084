// Is the curve through a cam's points the one that they are taken from, smooth, and met where it is
// nearest?
#include "close.h"

#include "base/cam.h"
#include "base/lcg.h"

#include <stdbool.h>
#include <string.h>

static const double ECCENTRICITY = 5e-3; // m
static const double DISC = 20e-3;        // m

static double eccentric(double t)
{
    const double side = ECCENTRICITY * sin(t);
    return ECCENTRICITY * cos(t) + sqrt(DISC * DISC - side * side);
}

// By points that are not evenly spaced where there is a share to move them by.
static Profile profile_of(double (*radius)(double t), size_t count, double moved)
{
    Profile profile = {.count = count};
    Err err = {ERR_NONE, ""};
    uint64_t seed = 7;
    for (size_t i = 0; i < count; i++) {
        const double t = 2.0 * M_PI * ((double)i + moved * lcg_draw(&seed)) / (double)count - 0.3;
        profile.angles[i] = t;
        profile.radii[i] = radius(t);
    }
    if (!profile_settle(&profile, &err)) {
        fail_msg("%s", err.text);
    }
    return profile;
}

// With twice the points it is 64 times as close.
static void the_error_falls_with_the_sixth_power_of_the_points(void **state)
{
    (void)state;
    double errors[3];
    for (int i = 0; i < 3; i++) {
        const Profile profile = profile_of(eccentric, 24U << i, 0.0);
        errors[i] = 0.0;
        for (int k = 0; k < 5000; k++) {
            const double t = 2.0 * M_PI * k / 5000.0 + 20.0;
            errors[i] = fmax(errors[i], fabs(profile_at(&profile, t).r - eccentric(t)));
        }
    }
    print_message("# off by %.3g, %.3g and %.3g m\n", errors[0], errors[1], errors[2]);
    assert_true(errors[0] / errors[1] > 40.0 && errors[1] / errors[2] > 40.0);
    assert_true(errors[2] < 1e-11);
}

static void derivatives_are_those_of_the_curve_and_do_not_jump(void **state)
{
    (void)state;
    const Profile profile = profile_of(eccentric, 40, 0.3);
    const double h = 1e-5;
    for (size_t i = 0; i < profile.count; i++) {
        // across a point, and within a piece
        for (int k = 0; k < 2; k++) {
            const double t = profile.angles[i] + (k == 0 ? 0.0 : 0.01);
            const ProfileAt at = profile_at(&profile, t);
            const ProfileAt before = profile_at(&profile, t - h);
            const ProfileAt behind = profile_at(&profile, t + h);
            assert_near(at.r1, (behind.r - before.r) / (2.0 * h), 1e-9);
            assert_near(at.r2, (behind.r1 - before.r1) / (2.0 * h), 1e-8);
            // the third derivative from either side
            const double left = (at.r2 - before.r2) / h;
            const double right = (behind.r2 - at.r2) / h;
            assert_near(left, right, 1e-6);
        }
    }
}

static double lobed(double t)
{
    return 0.03 + 2e-3 * cos(t) + 1.5e-3 * sin(3.0 * t);
}

// A random point beside the profile, by a search that knows nothing of derivatives.
static void the_nearest_point_is_the_nearest(void **state)
{
    (void)state;
    const Profile profile = profile_of(lobed, 120, 0.2);
    uint64_t seed = 3;
    for (int i = 0; i < 300; i++) {
        const double t = M_PI * lcg_draw(&seed);
        const double away = lobed(t) + 6e-3 + 7e-3 * lcg_draw(&seed);
        const Vec2 point = {away * cos(t), away * sin(t)};
        double least = INFINITY;
        for (int k = 0; k < 20000; k++) {
            const double at = 2.0 * M_PI * k / 20000.0;
            const double r = profile_at(&profile, at).r;
            least = fmin(least, hypot(point.x - r * cos(at), point.y - r * sin(at)));
        }
        const ProfileNearest nearest = profile_nearest(&profile, point);
        const double sign = away > profile_at(&profile, t).r ? 1.0 : -1.0;
        // the search misses the nearest point by up to half of its pitch
        assert_near(sign * nearest.distance, least, 5e-6);
        assert_true(sign * nearest.distance <= least + 1e-15);
        assert_near(vec2_length(nearest.normal), 1.0, 1e-15);
    }
}

static void the_furthest_point_is_the_furthest(void **state)
{
    (void)state;
    const Profile profile = profile_of(eccentric, 90, 0.2);
    for (int i = 0; i < 100; i++) {
        const double t = 2.0 * M_PI * i / 100.0;
        const Vec2 direction = {cos(t), sin(t)};
        const ProfileFurthest furthest = profile_furthest(&profile, direction);
        // of the disc
        assert_near(furthest.reach, DISC + ECCENTRICITY * cos(t), 1e-11);
        assert_near(1.0 / furthest.curvature, DISC, 1e-6);
    }
}

static double threefold(double t)
{
    return 17e-3 - 3e-3 * cos(3.0 * t);
}

// r = 17 - 3 cos 3 t mm has hollows at t = 0: r = 14, r'' = 27, a radius of 14^2 / (27 - 14) mm.
static void hollows_are_found(void **state)
{
    (void)state;
    const Profile profile = profile_of(threefold, 360, 0.0);
    assert_near(profile.least_hollow, 14e-3 * 14e-3 / 13e-3, 1e-6);
    assert_near(profile.reach, 20e-3, 1e-6);
    assert_near(profile.least, 14e-3, 1e-6);
    const Profile convex = profile_of(eccentric, 90, 0.0);
    assert_true(isinf(convex.least_hollow));
    assert_near(convex.least_hump, DISC, 1e-6);
}

// Gap, rate and second rate of a follower whose two bodies turn and move at steady speeds, by
// differences over time.
static void rates_of_the_gap_are_its_differences(void **state)
{
    (void)state;
    const Profile profile = profile_of(lobed, 180, 0.0);
    const Profile convex = profile_of(eccentric, 180, 0.0);
    const double omegas[2] = {11.0, -7.0};
    const double h = 1e-6;
    for (int i = 0; i < 2; i++) {
        const Cam cam = {.profile = i == 0 ? &profile : &convex,
                         .radius = i == 0 ? 4e-3 : 0.0,
                         .is_flat = i == 1};
        CamPose poses[3];
        double rates[3];
        double second = 0.0;
        for (int k = 0; k < 3; k++) {
            const double time = (k - 1) * h;
            const Vec2 x = {1.0, 0.0};
            const Vec2 velocity = {0.3, -0.2};
            const Vec2 offset = vec2_add((Vec2){6e-3, 38e-3}, vec2_scale(time, velocity));
            poses[k] = cam_pose(&cam, vec2_rotate(0.4 + omegas[0] * time, x),
                                vec2_rotate(-1.3 + omegas[1] * time, x), offset);
            rates[k] = cam_rate(&poses[k], offset, velocity, omegas[0], omegas[1]);
            if (k == 1) {
                // of steady turning, points of both bodies fall towards their anchors
                const Vec2 b = poses[k].measured;
                const Vec2 a = vec2_add(offset, b);
                const Vec2 falling = vec2_sub(vec2_scale(omegas[0] * omegas[0], a),
                                              vec2_scale(omegas[1] * omegas[1], b));
                const double w = cam_sliding(&poses[k], offset, velocity, omegas[0], omegas[1]);
                second = vec2_dot(poses[k].normal, falling) +
                         cam_bend(&cam, &poses[k], omegas[0], omegas[1], w);
                const double turning = cam_turning(&cam, &poses[k], omegas[0], omegas[1], w);
                print_message("# rate %.6g, second %.6g, turning %.4g\n", rates[k], second,
                              turning);
            }
        }
        assert_near((poses[2].gap - poses[0].gap) / (2.0 * h), rates[1], 1e-7);
        assert_near((rates[2] - rates[0]) / (2.0 * h), second, 1e-6 * (1.0 + fabs(second)));
        const double w =
            cam_sliding(&poses[1], (Vec2){6e-3, 38e-3}, (Vec2){0.3, -0.2}, omegas[0], omegas[1]);
        const double turned = vec2_cross(poses[0].normal, poses[2].normal) / (2.0 * h);
        assert_near(turned, cam_turning(&cam, &poses[1], omegas[0], omegas[1], w), 1e-6);
    }
}

static void points_that_make_no_profile_are_refused(void **state)
{
    (void)state;
    static const struct {
        size_t count;
        size_t at;
        double angle;
        double radius;
        const char *words;
    } WRONG[] = {
        {5, 0, 0.0, 0.02, "5 points"},
        {12, 3, 0.1, 0.02, "point 4"},
        {12, 11, 7.0, 0.02, "point 1"},
        {12, 2, 2.0 * M_PI / 6.0, 0.0, "point 3"},
    };
    for (size_t i = 0; i < sizeof WRONG / sizeof *WRONG; i++) {
        Profile profile = {.count = WRONG[i].count};
        Err err = {ERR_NONE, ""};
        for (size_t k = 0; k < profile.count; k++) {
            profile.angles[k] = 2.0 * M_PI * (double)k / (double)profile.count;
            profile.radii[k] = 0.02;
        }
        profile.angles[WRONG[i].at] = WRONG[i].angle;
        profile.radii[WRONG[i].at] = WRONG[i].radius;
        assert_false(profile_settle(&profile, &err));
        if (strstr(err.text, WRONG[i].words) == NULL) {
            fail_msg("'%s' does not say '%s'", err.text, WRONG[i].words);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_error_falls_with_the_sixth_power_of_the_points),
        cmocka_unit_test(derivatives_are_those_of_the_curve_and_do_not_jump),
        cmocka_unit_test(the_nearest_point_is_the_nearest),
        cmocka_unit_test(the_furthest_point_is_the_furthest),
        cmocka_unit_test(hollows_are_found),
        cmocka_unit_test(rates_of_the_gap_are_its_differences),
        cmocka_unit_test(points_that_make_no_profile_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
