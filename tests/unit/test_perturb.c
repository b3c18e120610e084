// Is a perturbation of the size that is asked for, whatever the mechanism is written down in?
#include "close.h"

#include "mechanism.h"
#include "rocker.h"

#include "kept.h"
#include "model/kinematics.h"
#include "model/nearest.h"
#include "model/perturb.h"

enum { SEEDS = 20 };

// The units of a scenario's start, as of a trajectory of one sample.
static void start_units(const Scenario *scenario, PerturbUnit units[KINEMATICS_BODY_MAX])
{
    Trajectory *trajectory = trajectory_create(scenario, "start");
    trajectory->sample_count = 1;
    linkage_start(&scenario->linkage, trajectory->motions);
    perturb_units(trajectory, units);
    trajectory_destroy(trajectory);
}

static Scenario perturbed(const Scenario *scenario, double size, unsigned member)
{
    PerturbUnit units[KINEMATICS_BODY_MAX];
    start_units(scenario, units);
    Scenario beside = kept_copy(scenario);
    assert_true(perturb_start(&beside, units, size, member));
    return beside;
}

static double omega_change(const Scenario *scenario, const Scenario *beside, size_t body)
{
    return beside->linkage.bodies[body].start.omega - scenario->linkage.bodies[body].start.omega;
}

static Vec2 velocity_change(const Scenario *scenario, const Scenario *beside, size_t body)
{
    return vec2_sub(beside->linkage.bodies[body].start.velocity,
                    scenario->linkage.bodies[body].start.velocity);
}

static void a_start_of_some_size_is_that_far_away(void **state)
{
    (void)state;
    Scenario scenario = mechanism_loose(1);
    PerturbUnit units[KINEMATICS_BODY_MAX];
    start_units(&scenario, units);
    for (unsigned member = 1; member <= SEEDS; member++) {
        const Scenario beside = perturbed(&scenario, 1e-4, member);
        double largest = 0.0;
        for (size_t i = 1; i < 3; i++) {
            const double moving = vec2_length(velocity_change(&scenario, &beside, i));
            largest = fmax(largest, fabs(omega_change(&scenario, &beside, i)) / units[i].turning);
            largest = fmax(largest, moving / units[i].moving);
        }
        assert_close(largest, 1e-4, 1e-9);
        Motion motions[KINEMATICS_BODY_MAX];
        int joint;
        double distance;
        linkage_start(&beside.linkage, motions);
        assert_true(nearest_check(&beside.linkage, motions, &joint, &distance));
        assert_near(omega_change(&scenario, &beside, 0), 0.0, 1e-12);
    }
}

static void where_nothing_is_free_nothing_is_perturbed(void **state)
{
    (void)state;
    const Scenario ideal = mechanism_paper();
    const Scenario redundant = mechanism_parallelogram();
    const Scenario *const scenarios[] = {&ideal, &redundant};
    for (int i = 0; i < 2; i++) {
        Scenario beside = *scenarios[i];
        PerturbUnit units[KINEMATICS_BODY_MAX];
        start_units(&beside, units);
        assert_false(perturb_start(&beside, units, 1e-3, 1));
        assert_memory_equal(&beside, scenarios[i], sizeof beside);
    }
}

static void a_body_that_rests_or_does_not_turn_is_perturbed(void **state)
{
    (void)state;
    Scenario scenario = mechanism_pin(0.1, 1e-4);
    Scenario beside = perturbed(&scenario, 1e-6, 1);
    assert_true(vec2_length(velocity_change(&scenario, &beside, 0)) > 0.0);
    assert_true(vec2_length(velocity_change(&scenario, &beside, 0)) <= 1e-6);
    scenario.linkage.bodies[0].start.velocity = (Vec2){3.0, 0.0};
    for (unsigned member = 1; member <= SEEDS; member++) {
        beside = perturbed(&scenario, 1e-6, member);
        const double radius = linkage_reach(&scenario.linkage, 0);
        const double moving = vec2_length(velocity_change(&scenario, &beside, 0)) / 3.0;
        const double turning = fabs(omega_change(&scenario, &beside, 0)) * radius / 3.0;
        assert_close(fmax(moving, turning), 1e-6, 1e-6);
    }
}

// The old measure, the drive's speed at the longest arm, makes the changes grow with the arm.
static void a_pivot_far_away_changes_nothing(void **state)
{
    (void)state;
    for (unsigned member = 1; member <= SEEDS; member++) {
        const Scenario near = rocker_make((RockerView){.length = 30.0});
        const Scenario far = rocker_make((RockerView){.length = 900.0});
        const Scenario beside_near = perturbed(&near, 1e-3, member);
        const Scenario beside_far = perturbed(&far, 1e-3, member);
        const double speed = vec2_length(near.linkage.bodies[2].start.velocity);
        // what is left is the arc that the pin moves on
        assert_near(omega_change(&far, &beside_far, 1), omega_change(&near, &beside_near, 1),
                    0.01 * 1e-3 * fabs(near.linkage.bodies[1].start.omega));
        assert_near(velocity_change(&far, &beside_far, 2).x,
                    velocity_change(&near, &beside_near, 2).x, 0.01 * 1e-3 * speed);
        // control: what it would be by the longest arm
        const double arms = 900.0 / 30.0;
        assert_false(fabs(arms * velocity_change(&near, &beside_near, 2).x -
                          velocity_change(&far, &beside_far, 2).x) <= 0.01 * 1e-3 * speed);
    }
}

static void units_frames_and_origins_change_nothing(void **state)
{
    (void)state;
    const RockerView plain = {.length = 10.0};
    const RockerView views[] = {
        {.length = 10.0, .in_millimetres = true},
        {.length = 10.0, .turn = 0.7},
        {.length = 10.0, .shift = {30.0, -20.0}},
        {.length = 10.0, .frames = 1.1},
        {.length = 10.0, .in_millimetres = true, .turn = -2.0, .shift = {1.0, 2.0}, .frames = -0.4},
    };
    const Scenario scenario = rocker_make(plain);
    for (unsigned member = 1; member <= SEEDS; member++) {
        const Scenario beside = perturbed(&scenario, 1e-3, member);
        for (size_t i = 0; i < sizeof views / sizeof views[0]; i++) {
            const Scenario other = rocker_make(views[i]);
            const Scenario other_beside = perturbed(&other, 1e-3, member);
            for (size_t body = 1; body < 3; body++) {
                const Vec2 change = velocity_change(&scenario, &beside, body);
                const Vec2 turned = vec2_rotate(views[i].turn, change);
                const Vec2 there = velocity_change(&other, &other_beside, body);
                assert_near(omega_change(&other, &other_beside, body),
                            omega_change(&scenario, &beside, body), 1e-11);
                assert_near(there.x, turned.x, 1e-11);
                assert_near(there.y, turned.y, 1e-11);
                // control: along fixed axes they would not turn
                assert_true(views[i].turn == 0.0 || !(fabs(there.x - change.x) <= 1e-11));
            }
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_start_of_some_size_is_that_far_away),
        cmocka_unit_test(where_nothing_is_free_nothing_is_perturbed),
        cmocka_unit_test(a_body_that_rests_or_does_not_turn_is_perturbed),
        cmocka_unit_test(a_pivot_far_away_changes_nothing),
        cmocka_unit_test(units_frames_and_origins_change_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
