// Does the general solution of a linkage agree with the closed form, and does it say no when it
// must?
#include "close.h"

#include "mechanism.h"

#include "analytic/fourbar_motion.h"
#include "model/kinematics.h"

#include <string.h>

static void copy_start(const Linkage *linkage, Motion *motions)
{
    linkage_start(linkage, motions);
}

// Newton's method and the closed form share no formula but the loop itself.
static void newton_and_the_closed_form_agree_over_a_turn(void **state)
{
    (void)state;
    const Scenario scenario = mechanism_paper();
    const FourBarLengths lengths = fourbar_motion_nominal(&scenario.fourbar);
    const double speed = scenario.linkage.driver.speed;
    Motion motions[KINEMATICS_BODY_MAX];
    copy_start(&scenario.linkage, motions);
    Err err = {ERR_NONE, ""};
    for (int degree = 0; degree <= 360; degree += 5) {
        const double crank = degree * M_PI / 180.0;
        Motion closed[3];
        assert_true(kinematics_solve(&scenario.linkage, crank, motions, &err));
        assert_true(fourbar_motion_bodies(&lengths, speed, crank, closed));
        for (int i = 0; i < 3; i++) {
            // conditioning: the smallest transmission angle of 31 deg costs a digit or two
            assert_near(motions[i].position.x, closed[i].position.x, 1e-13);
            assert_near(motions[i].position.y, closed[i].position.y, 1e-13);
            assert_near(remainder(motions[i].angle - closed[i].angle, 2.0 * M_PI), 0.0, 1e-12);
            assert_near(motions[i].omega, closed[i].omega, 1e-9);
            assert_near(motions[i].alpha, closed[i].alpha, 1e-6);
            assert_near(motions[i].velocity.y, closed[i].velocity.y, 1e-10);
            assert_near(motions[i].acceleration.x, closed[i].acceleration.x, 1e-7);
        }
    }
}

static void a_fourbar_has_one_freedom_and_two_more_with_each_loose_joint(void **state)
{
    (void)state;
    Scenario scenario = mechanism_paper();
    Motion motions[KINEMATICS_BODY_MAX];
    copy_start(&scenario.linkage, motions);
    assert_int_equal(kinematics_mobility(&scenario.linkage, motions, true), 1);
    mechanism_loosen(&scenario, "crank-coupler");
    assert_int_equal(kinematics_mobility(&scenario.linkage, motions, true), 3);
    mechanism_loosen(&scenario, "coupler-follower");
    assert_int_equal(kinematics_mobility(&scenario.linkage, motions, true), 5);
    assert_int_equal(kinematics_mobility(&scenario.linkage, motions, false), 1);
}

static void a_redundant_bar_leaves_the_freedom_that_counting_denies(void **state)
{
    (void)state;
    // counting gives 3 * 4 - 2 * 6 = 0; three parallel cranks of one length move all the same
    const Scenario scenario = mechanism_parallelogram();
    Motion motions[KINEMATICS_BODY_MAX];
    copy_start(&scenario.linkage, motions);
    assert_int_equal(kinematics_mobility(&scenario.linkage, motions, true), 1);
    Err err = {ERR_NONE, ""};
    assert_false(kinematics_solve(&scenario.linkage, 1.0, motions, &err));
    assert_int_equal(err.kind, ERR_SOLVER);
}

static void a_linkage_that_cannot_close_says_so_and_stays_where_it_was(void **state)
{
    (void)state;
    Scenario scenario = mechanism_paper();
    scenario.linkage.joints[3].anchor_b.x = 0.9;
    Motion motions[KINEMATICS_BODY_MAX];
    copy_start(&scenario.linkage, motions);
    Err err = {ERR_NONE, ""};
    assert_false(kinematics_solve(&scenario.linkage, 0.0, motions, &err));
    assert_non_null(strstr(err.text, "does not close"));
    assert_true(motions[1].angle == scenario.linkage.bodies[1].start.angle);
}

static void closure_error_is_the_largest_gap_between_anchors(void **state)
{
    (void)state;
    const Scenario scenario = mechanism_paper();
    Motion motions[KINEMATICS_BODY_MAX];
    copy_start(&scenario.linkage, motions);
    assert_true(kinematics_closure_error(&scenario.linkage, motions) <= 1e-13);
    motions[2].position.x += 3e-4;
    motions[2].position.y -= 4e-4;
    assert_near(kinematics_closure_error(&scenario.linkage, motions), 5e-4, 1e-12);
}

static void without_a_driver_there_is_no_motion_to_solve(void **state)
{
    (void)state;
    Scenario scenario = mechanism_paper();
    scenario.linkage.driver.is_present = false;
    Motion motions[KINEMATICS_BODY_MAX];
    copy_start(&scenario.linkage, motions);
    Err err = {ERR_NONE, ""};
    assert_false(kinematics_solve(&scenario.linkage, 0.0, motions, &err));
    assert_non_null(strstr(err.text, "0 drives"));
}

// Place by place round a turn, as a start a hundred steps back is found: at each the motion that
// follows is that of a mechanism which had its motion all the way.
static void a_placed_mechanism_moves_as_one_that_was_solved(void **state)
{
    (void)state;
    enum { PLACES = 36, BODIES = 3 };
    const Scenario scenario = mechanism_paper();
    const Linkage *linkage = &scenario.linkage;
    Motion placed[BODIES], solved[BODIES];
    Err err = {0};
    assert_int_equal(linkage->body_count, BODIES);
    linkage_start(linkage, placed);
    linkage_start(linkage, solved);
    for (int k = 1; k <= PLACES; k++) {
        const DriveState drive = {.angle = linkage->driver.start + 2.0 * M_PI * k / PLACES,
                                  .omega = linkage->driver.speed};
        const Vec2 before = placed[1].velocity;
        assert_true(kinematics_place_driven(linkage, &drive, placed, &err));
        // the control: placing alone leaves the velocities behind
        assert_memory_equal(&placed[1].velocity, &before, sizeof before);
        assert_true(kinematics_solve_driven(linkage, &drive, solved, &err));
        assert_true(vec2_length(vec2_sub(solved[1].velocity, before)) > 0.0);
        Motion then[BODIES];
        memcpy(then, placed, sizeof then);
        assert_true(kinematics_solve_driven(linkage, &drive, then, &err));
        assert_memory_equal(then, solved, sizeof then);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_placed_mechanism_moves_as_one_that_was_solved),
        cmocka_unit_test(newton_and_the_closed_form_agree_over_a_turn),
        cmocka_unit_test(a_fourbar_has_one_freedom_and_two_more_with_each_loose_joint),
        cmocka_unit_test(a_redundant_bar_leaves_the_freedom_that_counting_denies),
        cmocka_unit_test(a_linkage_that_cannot_close_says_so_and_stays_where_it_was),
        cmocka_unit_test(closure_error_is_the_largest_gap_between_anchors),
        cmocka_unit_test(without_a_driver_there_is_no_motion_to_solve),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
