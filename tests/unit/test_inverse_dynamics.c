// Are torque and pin forces those that Newton's laws demand, and does the power balance close?
#include "close.h"

#include "mechanism.h"

#include "analytic/fourbar_motion.h"
#include "analytic/inverse_dynamics.h"
#include "analytic/summary.h"
#include "model/kinematics.h"

#include <string.h>

static AnalyticSummary summary_at(double rpm, double gravity)
{
    Scenario scenario = mechanism_paper();
    scenario.linkage.driver.speed = rpm * 2.0 * M_PI / 60.0;
    scenario.gravity = scenario_downward(gravity);
    AnalyticSummary summary;
    Err err = {ERR_NONE, ""};
    assert_true(summary_compute(&scenario, &summary, &err));
    return summary;
}

// Largest pin forces of the paper's mechanism with gravity, computed independently.
static void pin_forces_are_those_known_at_each_speed(void **state)
{
    (void)state;
    const struct {
        double rpm;
        double crank_coupler;
        double coupler_follower;
    } rows[] = {
        {100, 14.1, 12.0},      {300, 134.5, 96.8},     {500, 375.4, 266.6},
        {700, 736.8, 521.1},    {900, 1218.6, 860.5},   {1000, 1504.7, 1062.1},
        {1100, 1821.0, 1284.8}, {1300, 2543.8, 1794.0}, {1500, 3387.0, 2387.9},
    };
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        const AnalyticSummary summary = summary_at(rows[i].rpm, 9.80665);
        assert_near(summary.reaction_max[1].value, rows[i].crank_coupler, 0.06);
        assert_near(summary.reaction_max[2].value, rows[i].coupler_follower, 0.06);
    }
}

static void without_gravity_forces_go_with_the_square_of_the_speed(void **state)
{
    (void)state;
    const AnalyticSummary slow = summary_at(100, 0.0);
    const AnalyticSummary fast = summary_at(1000, 0.0);
    assert_near(fast.reaction_max[1].value / slow.reaction_max[1].value, 100.0, 1e-9);
    assert_near(slow.reaction_max[1].value / 1e4, 1.5058e-3, 5e-8);
    assert_near(slow.reaction_max[2].value / 1e4, 1.0607e-3, 5e-8);
    // the control: with gravity the ratio is another one
    const AnalyticSummary heavy = summary_at(100, 9.80665);
    assert_true(fabs(fast.reaction_max[1].value / heavy.reaction_max[1].value - 100.0) > 1.0);
}

static void drive_power_is_the_change_of_energy(void **state)
{
    (void)state;
    assert_true(summary_at(1000, 9.80665).power_residual <= 1e-10);
    assert_true(summary_at(-1500, 9.80665).power_residual <= 1e-10);
    // the control: gravity left out of the energy but not of the forces
    const Scenario scenario = mechanism_paper();
    const FourBarLengths lengths = fourbar_motion_nominal(&scenario.fourbar);
    Motion motions[3];
    Reactions reactions;
    Err err = {ERR_NONE, ""};
    const double speed = scenario.linkage.driver.speed;
    assert_true(fourbar_motion_bodies(&lengths, speed, 1.0, motions));
    assert_true(inverse_dynamics_solve(&scenario.linkage, motions, scenario_gravity(&scenario),
                                       (InverseTime){0.0, 0.0}, &reactions, &err));
    const double power = reactions.drive_torques[0] * speed;
    assert_true(fabs(power - inverse_dynamics_power(&scenario.linkage, motions, (Vec2){0.0, 0.0},
                                                    (InverseTime){0.0, 0.0})) > 1e-6 * fabs(power));
}

// A crank alone: the pivot carries its weight and its centripetal force, the drive its moment.
static void a_crank_alone_obeys_the_textbook(void **state)
{
    (void)state;
    Scenario scenario = mechanism_paper();
    scenario.linkage.body_count = 1;
    scenario.linkage.joint_count = 1;
    const double omega = 50.0;
    const Motion motion = {.position = {0.0, 0.054},
                           .angle = 0.5 * M_PI,
                           .velocity = {-0.054 * omega, 0.0},
                           .omega = omega,
                           .acceleration = {0.0, -0.054 * omega * omega}};
    Reactions reactions;
    Err err = {ERR_NONE, ""};
    assert_true(inverse_dynamics_solve(&scenario.linkage, &motion, (Vec2){0.0, -10.0},
                                       (InverseTime){0.0, 0.0}, &reactions, &err));
    assert_near(reactions.force_on_b[0].x, 0.0, 1e-12);
    assert_near(reactions.force_on_b[0].y, 0.12 * (10.0 - 0.054 * omega * omega), 1e-9);
    assert_near(reactions.drive_torques[0], 0.0, 1e-12);
}

// Along x a spring pulls at the middle of the crank with 1000 N/m (300 mm - 100 mm) and a damper
// with 10 N s/m times the speed at which it is drawn out.
static void a_spring_and_a_damper_pull_at_the_crank(void **state)
{
    (void)state;
    Scenario scenario = mechanism_paper();
    scenario.linkage.body_count = 1;
    scenario.linkage.joint_count = 1;
    scenario.linkage.spring_count = 1;
    scenario.linkage.springs[0] = (Spring){.body_a = LINKAGE_GROUND,
                                           .body_b = 0,
                                           .anchor_a = {0.3, 0.054},
                                           .stiffness = 1000.0,
                                           .length = 0.1,
                                           .damping = 10.0};
    const double omega = 50.0;
    const Motion motion = {.position = {0.0, 0.054},
                           .angle = 0.5 * M_PI,
                           .velocity = {-0.054 * omega, 0.0},
                           .omega = omega,
                           .acceleration = {0.0, -0.054 * omega * omega}};
    Reactions reactions;
    Err err = {ERR_NONE, ""};
    assert_true(inverse_dynamics_solve(&scenario.linkage, &motion, (Vec2){0.0, -10.0},
                                       (InverseTime){0.0, 0.0}, &reactions, &err));
    const double pull = 1000.0 * 0.2 + 10.0 * 0.054 * omega;
    assert_near(reactions.force_on_b[0].x, -pull, 1e-9);
    assert_near(reactions.force_on_b[0].y, 0.12 * (10.0 - 0.054 * omega * omega), 1e-9);
    assert_near(reactions.drive_torques[0], 0.054 * pull, 1e-9);
}

static void reactions_that_are_not_determined_are_refused(void **state)
{
    (void)state;
    const Scenario redundant = mechanism_parallelogram();
    Motion motions[KINEMATICS_BODY_MAX];
    linkage_start(&redundant.linkage, motions);
    Reactions reactions;
    Err err = {ERR_NONE, ""};
    assert_false(inverse_dynamics_solve(&redundant.linkage, motions, (Vec2){0.0, 0.0},
                                        (InverseTime){0.0, 0.0}, &reactions, &err));
    assert_int_equal(err.kind, ERR_SOLVER);
}

// At its limits the follower stands still, and crank and coupler lie in one line.
static void the_follower_stands_still_at_its_limits(void **state)
{
    (void)state;
    const Scenario scenario = mechanism_paper();
    const FourBarLengths lengths = fourbar_motion_nominal(&scenario.fourbar);
    const AnalyticSummary summary = summary_at(1000, 9.80665);
    assert_true(summary.has_limits);
    const double limits[2] = {summary.limit_extended, summary.limit_folded};
    for (int i = 0; i < 2; i++) {
        Motion motions[3];
        assert_true(fourbar_motion_bodies(&lengths, 100.0, limits[i], motions));
        assert_near(motions[2].omega, 0.0, 1e-11);
        assert_near(sin(motions[1].angle - motions[0].angle), 0.0, 1e-14);
    }
    assert_near(summary.follower_low, 84.83 * M_PI / 180.0, 1e-4);
    assert_near(summary.follower_high, 142.02 * M_PI / 180.0, 1e-4);
}

static void a_summary_needs_a_fourbar_whose_crank_turns(void **state)
{
    (void)state;
    AnalyticSummary summary;
    Err err = {ERR_NONE, ""};
    const Scenario pin = mechanism_pin(1.0, 1e-4);
    assert_false(summary_compute(&pin, &summary, &err));
    assert_non_null(strstr(err.text, "four-bars and slider-cranks only"));
    Scenario rocker = mechanism_paper();
    rocker.fourbar.ground.nominal = 0.5;
    err = (Err){ERR_NONE, ""};
    assert_false(summary_compute(&rocker, &summary, &err));
    assert_non_null(strstr(err.text, "does not turn fully"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(pin_forces_are_those_known_at_each_speed),
        cmocka_unit_test(without_gravity_forces_go_with_the_square_of_the_speed),
        cmocka_unit_test(drive_power_is_the_change_of_energy),
        cmocka_unit_test(a_crank_alone_obeys_the_textbook),
        cmocka_unit_test(a_spring_and_a_damper_pull_at_the_crank),
        cmocka_unit_test(reactions_that_are_not_determined_are_refused),
        cmocka_unit_test(the_follower_stands_still_at_its_limits),
        cmocka_unit_test(a_summary_needs_a_fourbar_whose_crank_turns),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
