// Sizes of speeds belong to the bodies: no far pivot, origin, unit or frame has a part in them.
#include "close.h"

#include "rocker.h"

#include "model/scale.h"

enum { ROCKER = 2 };

static SpeedScale scale_of(RockerView view)
{
    const Scenario scenario = rocker_make(view);
    return scale_speeds(&scenario);
}

static void a_far_pivot_changes_nothing_but_its_own_body(void **state)
{
    (void)state;
    SpeedScale near = scale_of((RockerView){.length = 10.0});
    SpeedScale far = scale_of((RockerView){.length = 1000.0});
    assert_close(far.moving, near.moving, 1e-3);
    assert_close(far.changing, near.changing, 1e-3);
    for (int body = 0; body < ROCKER; body++) {
        assert_close(far.turning[body], near.turning[body], 1e-3);
    }
    assert_close(1000.0 * far.turning[ROCKER], 10.0 * near.turning[ROCKER], 1e-3);
    assert_close(1000.0 * far.speeding[ROCKER], 10.0 * near.speeding[ROCKER], 1e-3);
    // control: what is not divided by the reach is a hundred times too large
    assert_false(fabs(far.turning[ROCKER] / near.turning[ROCKER] - 1.0) < 0.5);
    scale_free(&near);
    scale_free(&far);
}

static void it_does_not_matter_how_the_case_is_written(void **state)
{
    (void)state;
    SpeedScale plain = scale_of((RockerView){.length = 1.0});
    const RockerView views[] = {
        {.length = 1.0, .in_millimetres = true},
        {.length = 1.0, .turn = 0.7},
        {.length = 1.0, .shift = {300.0, -500.0}},
        {.length = 1.0, .frames = 0.4},
    };
    for (size_t i = 0; i < sizeof views / sizeof *views; i++) {
        SpeedScale other = scale_of(views[i]);
        assert_close(other.moving, plain.moving, 1e-9);
        assert_close(other.changing, plain.changing, 1e-9);
        for (int body = 0; body <= ROCKER; body++) {
            assert_close(other.turning[body], plain.turning[body], 1e-9);
        }
        scale_free(&other);
    }
    scale_free(&plain);
}

// A driven linkage is not as fast as a body that falls for ever.
static void gravity_counts_for_as_long_as_it_pulls(void **state)
{
    (void)state;
    Scenario scenario = rocker_make((RockerView){.length = 1000.0});
    SpeedScale light = scale_speeds(&scenario);
    scenario.gravity = scenario_downward(9.81);
    SpeedScale heavy = scale_speeds(&scenario);
    assert_close(heavy.moving, light.moving, 1e-12);
    scenario.linkage.driver.is_present = false;
    for (size_t i = 0; i < scenario.linkage.body_count; i++) {
        scenario.linkage.bodies[i].start.omega = 0.0;
        scenario.linkage.bodies[i].start.velocity = (Vec2){0.0, 0.0};
    }
    SpeedScale falling = scale_speeds(&scenario);
    assert_close(falling.moving, sqrt(2.0 * 9.81 * 1000.0), 1e-6);
    scale_free(&light);
    scale_free(&heavy);
    scale_free(&falling);
}

static void raising_goes_up_only(void **state)
{
    (void)state;
    const Scenario scenario = rocker_make((RockerView){.length = 1.0});
    SpeedScale scale = scale_speeds(&scenario);
    const double moving = scale.moving;
    const double turning = scale.turning[ROCKER];
    assert_false(scale_raise(&scenario.linkage, 0.5 * moving, &scale));
    assert_close(scale.moving, moving, 0.0);
    assert_true(scale_raise(&scenario.linkage, 2.0 * moving, &scale));
    assert_close(scale.turning[ROCKER], 2.0 * turning, 1e-15);
    scale_free(&scale);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_far_pivot_changes_nothing_but_its_own_body),
        cmocka_unit_test(it_does_not_matter_how_the_case_is_written),
        cmocka_unit_test(gravity_counts_for_as_long_as_it_pulls),
        cmocka_unit_test(raising_goes_up_only),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
