// Do the two rows of ODE that stand for friction in space hold with what the law says at the mean
// speed of the step?
#include "close.h"
#include "space_pin.h"

#include "ode/space/space_friction.h"

#include <stdlib.h>
#include <string.h>

static const double MASS = 1.0;       // kg, of space_pin
static const double STEP_S = 1e-4;    // s
static const double PRESS = 50.0;     // N
static const double FRICTION = 0.3;   // 1
static const double PER_FORCE = 1e-9; // s/kg, CFM of the normal's row

// The pin pressed at its centre of mass against a wall at right angles to x, sliding at a speed
// along a direction that is neither of the row's; nothing else acts.
static SpaceFrictionRow pressed_pin(double speed, double friction_speed)
{
    const Scenario scenario = space_pin(1e-3, 1e-3, 0.0, 1e8);
    SpaceMotion motion;
    memset(&motion, 0, sizeof motion);
    motion.turn.w = 1.0;
    motion.velocity = (Vec3){0.0, 0.6 * speed, 0.8 * speed};
    SpaceResponse response;
    Err err = {ERR_NONE, ""};
    const SpaceResponsePlace pin = {0, 3};
    assert_true(space_response_init(&scenario.linkage, &motion, &pin, 1, &response, &err));
    const double pushed = STEP_S / MASS + PER_FORCE;
    SpaceFrictionRow row = {
        .body = {LINKAGE_GROUND, 0},
        .point = motion.position,
        .normal = {1.0, 0.0, 0.0},
        .side = {0.0, 1.0, 0.0},
        .has_friction = true,
        .friction = FRICTION,
        .friction_speed = friction_speed,
        .target = PRESS * pushed,
        .cfm = PER_FORCE,
        .sliding = motion.velocity,
    };
    const SpaceFrictionStep step = {&motion, STEP_S, 0.2};
    const size_t place = 0;
    assert_true(space_friction_find(&response, &step, &place, &row, 1));
    space_response_finish(&response);
    return row;
}

// The force with which ODE comes out of the row along the slide, N: of v' + slip F = surface and
// v' = v + h F / m.
static double force_of(const SpaceFrictionRow *row, double speed)
{
    return (row->surface[0] - speed) / (row->slip[0] + STEP_S / MASS);
}

// Up to a friction that takes the speed within two steps, the mean is the step's middle.
static void the_force_is_that_of_the_law_at_the_mean_speed(void **state)
{
    (void)state;
    static const double TAKEN[] = {0.02, 0.3, 1.9}; // of the sliding speed of the law, a step
    static const double SPEEDS[] = {0.05, 0.7, 1.5, 4.0};
    for (size_t i = 0; i < 3; i++) {
        const double law_speed = STEP_S * FRICTION * PRESS / MASS / TAKEN[i];
        for (size_t k = 0; k < 4; k++) {
            const double speed = SPEEDS[k] * law_speed;
            const SpaceFrictionRow row = pressed_pin(speed, law_speed);
            const double force = force_of(&row, speed);
            const double mean = speed + 0.5 * STEP_S * force / MASS;
            const double law = -FRICTION * PRESS * tanh(mean / law_speed);
            assert_close(force, law, 1e-6);
            assert_near(row.along.y, 0.6, 1e-12);
            assert_near(row.along.z, 0.8, 1e-12);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_force_is_that_of_the_law_at_the_mean_speed),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
