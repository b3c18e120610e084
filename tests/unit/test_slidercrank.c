// Does the closed form of a slider-crank agree with Newton's method on its joints, with the numbers
// that other programs give, and with Newton's laws?
#include "close.h"

#include "mechanism.h"

#include "analytic/closed_form.h"
#include "analytic/inverse_dynamics.h"
#include "analytic/slidercrank_motion.h"
#include "analytic/summary.h"
#include "casefile/casefile.h"
#include "kept.h"
#include "model/kinematics.h"

#include <string.h>

static const double DEGREE = M_PI / 180.0;

static double worst_of(double worst, Vec2 a, Vec2 b, double scale)
{
    return fmax(worst, vec2_length(vec2_sub(a, b)) / scale);
}

// The largest difference of the closed form from the positions, velocities and accelerations that
// satisfy the joints' rows, over a turn, relative to the largest of each.
static double kinematics_error(const Scenario *scenario, const SliderCrank *shape)
{
    const double speed = scenario->linkage.driver.speed;
    const double reach = shape->crank + shape->rod;
    Motion solved[KINEMATICS_BODY_MAX];
    linkage_start(&scenario->linkage, solved);
    double worst = 0.0;
    for (int degree = 0; degree < 360; degree++) {
        const double crank = scenario->linkage.driver.start + degree * DEGREE;
        Motion closed[3];
        Err err = {ERR_NONE, ""};
        assert_true(kinematics_solve(&scenario->linkage, crank, solved, &err));
        assert_true(slidercrank_motion_bodies(shape, speed, crank, closed));
        for (int i = 0; i < 3; i++) {
            worst = worst_of(worst, closed[i].position, solved[i].position, reach);
            worst = worst_of(worst, closed[i].velocity, solved[i].velocity, speed * reach);
            worst = worst_of(worst, closed[i].acceleration, solved[i].acceleration,
                             speed * speed * reach);
            const double turned = remainder(closed[i].angle - solved[i].angle, 2.0 * M_PI);
            worst = fmax(worst, fabs(turned));
            worst = fmax(worst, fabs(closed[i].omega - solved[i].omega) / speed);
            worst = fmax(worst, fabs(closed[i].alpha - solved[i].alpha) / (speed * speed));
        }
    }
    return worst;
}

static void the_closed_form_satisfies_the_joints_at_every_angle(void **state)
{
    (void)state;
    static const double OFFSETS[] = {0.0, 0.02, -0.035};
    static const double LINES[] = {0.0, 0.5 * M_PI, -2.0};
    for (int i = 0; i < 3; i++) {
        for (int side = 0; side < 2; side++) {
            const Scenario scenario = mechanism_slidercrank(OFFSETS[i], LINES[i], (SliderSide)side);
            assert_true(kinematics_error(&scenario, &scenario.slidercrank) <= 1e-12);
            // the controls: a line a micron off, and the slider on the other side
            SliderCrank other = scenario.slidercrank;
            other.offset += 1e-6;
            assert_true(kinematics_error(&scenario, &other) > 1e-6);
            other = scenario.slidercrank;
            other.side = other.side == SLIDER_RIGHT ? SLIDER_LEFT : SLIDER_RIGHT;
            assert_true(kinematics_error(&scenario, &other) > 0.1);
        }
    }
}

// Speed and accelerations of crank 50 mm, rod 120 mm at 5000 rpm, computed independently.
static void the_sliders_extremes_have_the_known_nine_digits(void **state)
{
    (void)state;
    const Scenario scenario = mechanism_slidercrank(0.0, 0.0, SLIDER_RIGHT);
    AnalyticSummary summary;
    Err err = {ERR_NONE, ""};
    assert_true(summary_compute(&scenario, &summary, &err));
    assert_near(summary.acceleration.low, -19419.3605, 5e-5);
    assert_near(summary.acceleration.high, 9695.85572, 5e-6);
    const double high = fmod(summary.acceleration.high_angle, 2.0 * M_PI) / DEGREE;
    // the curve has two such maxima, mirrored at 180 deg
    assert_near(fmin(high, 360.0 - high), 121.9976, 5e-5);
    assert_near(summary.velocity.high, 28.4113304, 5e-8);
    assert_near(summary.velocity.high_angle / DEGREE, 289.829, 5e-4);
    assert_near(summary.slide.high - summary.slide.low, 0.1, 1e-15);
    // the control: the usual first-order formula a w^2 (cos p + a/b cos 2p) is not this motion
    const double speed = scenario.linkage.driver.speed;
    assert_true(fabs(0.05 * speed * speed * (1.0 + 0.05 / 0.12) + summary.acceleration.low) < 1.0);
    const double angle = 121.9976 * DEGREE;
    const double harmonic = -0.05 * speed * speed * (cos(angle) + 0.05 / 0.12 * cos(2.0 * angle));
    assert_true(fabs(harmonic - summary.acceleration.high) > 1.0);
}

static void the_strokes_ends_stand_where_crank_and_rod_are_in_line(void **state)
{
    (void)state;
    for (int side = 0; side < 2; side++) {
        const Scenario scenario = mechanism_slidercrank(0.03, 0.7, (SliderSide)side);
        AnalyticSummary summary;
        Err err = {ERR_NONE, ""};
        assert_true(summary_compute(&scenario, &summary, &err));
        // right: stretched is the farthest; left: the other way round
        const double stretched = slidercrank_motion_quantity(
            &scenario.slidercrank, 1.0, SLIDERCRANK_POSITION, summary.limit_extended);
        const double folded = slidercrank_motion_quantity(
            &scenario.slidercrank, 1.0, SLIDERCRANK_POSITION, summary.limit_folded);
        const double sign = side == 0 ? 1.0 : -1.0;
        assert_near(sign * stretched, sqrt(0.17 * 0.17 - 0.03 * 0.03), 1e-15);
        assert_near(sign * folded, sqrt(0.07 * 0.07 - 0.03 * 0.03), 1e-15);
        assert_near(summary.slide.high, fmax(stretched, folded), 1e-14);
        assert_near(summary.slide.low, fmin(stretched, folded), 1e-14);
        // the rod is farthest off the line where the crank points away from it
        assert_near(summary.transmission_low, acos(0.08 / 0.12), 1e-12);
    }
}

// What Newton's laws ask of each body in turn, from the slider to the crank.
typedef struct Textbook {
    Vec2 on_slider; // N, of the rod on the slider
    Vec2 guide;     // N, of the guide on the slider
    Vec2 on_rod;    // N, of the crank on the rod
    double torque;  // N m, of the drive
} Textbook;

// m (a - g), which is what all forces but the weight must give.
static Vec2 inertia_force(const Scenario *scenario, const Motion *motions, int body)
{
    const Vec2 lifted = vec2_add(motions[body].acceleration, scenario_upward(scenario));
    return vec2_scale(scenario->linkage.bodies[body].mass, lifted);
}

static Textbook solve_by_hand(const Scenario *scenario, const Motion *motions)
{
    const Linkage *linkage = &scenario->linkage;
    const Vec2 along = vec2_rotate(scenario->slidercrank.line, (Vec2){1.0, 0.0});
    const Vec2 across = vec2_perp(along);
    const Vec2 of_slider = inertia_force(scenario, motions, 2);
    const Vec2 of_rod = inertia_force(scenario, motions, 1);
    const Vec2 pin = linkage_point(motions, 0, linkage->joints[1].anchor_a);
    const Vec2 to_slider = vec2_sub(motions[2].position, pin);
    const Vec2 to_middle = vec2_sub(motions[1].position, pin);
    // moments about the crank pin: (to slider) x (- force on slider) is what the rod's motion asks
    const double moment =
        linkage->bodies[1].inertia * motions[1].alpha + vec2_cross(to_middle, of_rod);
    const double force_along = vec2_dot(along, of_slider);
    const double force_across =
        (-moment - force_along * vec2_cross(to_slider, along)) / vec2_cross(to_slider, across);
    Textbook book;
    book.on_slider = vec2_add(vec2_scale(force_along, along), vec2_scale(force_across, across));
    book.guide = vec2_sub(of_slider, book.on_slider);
    book.on_rod = vec2_add(of_rod, book.on_slider);
    book.torque = vec2_cross(motions[0].position, inertia_force(scenario, motions, 0)) +
                  vec2_cross(pin, book.on_rod);
    return book;
}

static double reaction_error(const Scenario *scenario, double gravity_of_book)
{
    Scenario lighter = kept_copy(scenario);
    lighter.gravity = scenario_downward(gravity_of_book);
    double worst = 0.0;
    for (int degree = 0; degree < 360; degree += 7) {
        Motion motions[3];
        Reactions reactions;
        Err err = {ERR_NONE, ""};
        assert_true(closed_form_bodies(scenario, degree * DEGREE, motions));
        assert_true(inverse_dynamics_solve(&scenario->linkage, motions, scenario_gravity(scenario),
                                           (InverseTime){0.0, 0.0}, &reactions, &err));
        const Textbook book = solve_by_hand(&lighter, motions);
        const double scale = vec2_length(book.on_rod);
        worst = worst_of(worst, reactions.force_on_b[1], book.on_rod, scale);
        worst = worst_of(worst, reactions.force_on_b[2], book.on_slider, scale);
        worst = worst_of(worst, reactions.force_on_b[3], book.guide, scale);
        worst = fmax(worst, fabs(reactions.drive_torques[0] - book.torque) / (0.05 * scale));
        worst = fmax(worst, fabs(reactions.moment_on_b[3]) / (0.05 * scale));
    }
    return worst;
}

static void reactions_are_those_of_newtons_laws_body_by_body(void **state)
{
    (void)state;
    const Scenario scenario = mechanism_slidercrank(0.02, 0.4, SLIDER_RIGHT);
    assert_true(reaction_error(&scenario, -scenario.gravity.y) <= 1e-12);
    // the control: without weight they are others
    assert_true(reaction_error(&scenario, 0.0) > 1e-5);
}

// A guide that holds the slider at a point ahead of the pin takes the same force, and a couple.
static void a_guide_away_from_the_pin_takes_a_couple(void **state)
{
    (void)state;
    const Scenario scenario = mechanism_slidercrank(0.0, 0.0, SLIDER_RIGHT);
    Scenario ahead = kept_copy(&scenario);
    ahead.linkage.joints[3].anchor_b = (Vec2){0.03, 0.0};
    Motion motions[3];
    Reactions plain;
    Reactions shifted;
    Err err = {ERR_NONE, ""};
    assert_true(closed_form_bodies(&scenario, 1.0, motions));
    assert_true(inverse_dynamics_solve(&scenario.linkage, motions, (Vec2){0.0, -9.8},
                                       (InverseTime){0.0, 0.0}, &plain, &err));
    assert_true(inverse_dynamics_solve(&ahead.linkage, motions, (Vec2){0.0, -9.8},
                                       (InverseTime){0.0, 0.0}, &shifted, &err));
    const double force = plain.force_on_b[3].y;
    assert_true(fabs(force) > 100.0);
    assert_near(shifted.force_on_b[3].y, force, 1e-9 * fabs(force));
    assert_near(shifted.moment_on_b[3], -0.03 * force, 1e-9 * fabs(force));
}

static void a_rod_that_is_too_short_has_no_turn(void **state)
{
    (void)state;
    Scenario scenario = mechanism_slidercrank(0.03, 0.0, SLIDER_RIGHT);
    scenario.slidercrank.rod = 0.06;
    AnalyticSummary summary;
    Err err = {ERR_NONE, ""};
    assert_false(slidercrank_turns(&scenario.slidercrank));
    assert_false(summary_compute(&scenario, &summary, &err));
    assert_non_null(strstr(err.text, "does not turn fully"));
    // dead centre: sin p = (e - b) / a
    const double dead = asin((0.03 - 0.06) / 0.05);
    assert_near(slidercrank_travel(&scenario.slidercrank, 0.06, 0.0, -1.0), -dead, 1e-15);
    assert_near(slidercrank_travel(&scenario.slidercrank, 0.06, 0.0, 1.0), M_PI - dead, 1e-15);
    Motion motions[3];
    assert_true(slidercrank_motion_bodies(&scenario.slidercrank, 1.0, dead + 1e-3, motions));
    assert_false(slidercrank_motion_bodies(&scenario.slidercrank, 1.0, dead - 1e-3, motions));
    // the control: with a longer rod it turns
    scenario.slidercrank.rod = 0.0801;
    assert_true(slidercrank_turns(&scenario.slidercrank));
    assert_true(isinf(slidercrank_travel(&scenario.slidercrank, 0.0801, 0.0, 1.0)));
}

static Scenario load_text(const char *text)
{
    Scenario scenario;
    Err err = {ERR_NONE, ""};
    if (!casefile_load_text("text", text, strlen(text), NULL, 0, &scenario, &err)) {
        fail_msg("%s", err.text);
    }
    return kept_instead(&scenario);
}

static void the_short_form_makes_the_same_linkage(void **state)
{
    (void)state;
    const Scenario expected = mechanism_slidercrank(0.02, 0.4, SLIDER_LEFT);
    const Scenario scenario =
        load_text("slider-crank:\n"
                  "  crank: {length: 50 mm, mass: 0.3 kg, inertia: 100 kg mm^2}\n"
                  "  rod: {length: 120 mm, mass: 0.21 kg, inertia: 250 kg mm^2}\n"
                  "  slider: {mass: 0.14 kg, inertia: 100 kg mm^2}\n"
                  "  offset: 20 mm\n"
                  "  angle: 0.4 rad\n"
                  "  assembly: left\n"
                  "drive: {speed: 5000 rpm, start: 0.8 rad}\n");
    assert_true(scenario.has_slidercrank && !scenario.has_fourbar);
    const SliderCrank *made = &scenario.slidercrank;
    const SliderCrank *asked = &expected.slidercrank;
    assert_close(made->crank, asked->crank, 0.0);
    assert_close(made->rod, asked->rod, 0.0);
    assert_close(made->offset, asked->offset, 0.0);
    assert_close(made->line, asked->line, 0.0);
    assert_int_equal(made->side, asked->side);
    for (int i = 0; i < 3; i++) {
        const Body *body = &scenario.linkage.bodies[i];
        const Body *other = &expected.linkage.bodies[i];
        assert_string_equal(body->name, other->name);
        assert_near(body->mass, other->mass, 1e-15);
        assert_near(body->inertia, other->inertia, 1e-18);
        assert_near(body->start.position.x, other->start.position.x, 1e-15);
        assert_near(body->start.velocity.y, other->start.velocity.y, 1e-12);
        assert_near(body->start.omega, other->start.omega, 1e-11);
    }
    for (int i = 0; i < 4; i++) {
        const Joint *joint = &scenario.linkage.joints[i];
        const Joint *other = &expected.linkage.joints[i];
        assert_string_equal(joint->name, other->name);
        assert_int_equal(joint->kind, other->kind);
        assert_int_equal(joint->body_a, other->body_a);
        assert_int_equal(joint->body_b, other->body_b);
        assert_near(joint->direction, other->direction, 1e-15);
        assert_near(joint->held_angle, other->held_angle, 1e-15);
        assert_true(worst_of(0.0, joint->anchor_a, other->anchor_a, 1.0) <= 1e-15);
        assert_true(worst_of(0.0, joint->anchor_b, other->anchor_b, 1.0) <= 1e-15);
    }
}

// The play of each joint that can have some, and a block's start, by which it begins aside.
static void joints_of_the_short_form_can_have_play(void **state)
{
    (void)state;
    const Scenario scenario =
        load_text("slider-crank:\n"
                  "  crank: {length: 50 mm, mass: 0.3 kg, inertia: 100 kg mm^2}\n"
                  "  rod: {length: 120 mm, mass: 0.21 kg, inertia: 250 kg mm^2}\n"
                  "  slider: {mass: 0.14 kg, inertia: 100 kg mm^2}\n"
                  "joints:\n"
                  "  crank-rod: {hole: 20 mm, pin: 19.9 mm}\n"
                  "  rod-slider: {radial-clearance: 0.1 mm}\n"
                  "  slider-guide: {guide: 52 mm, block: 50 mm, length: 100 mm,\n"
                  "                 start: [0.5 mm, 0.3 deg]}\n"
                  "drive: {speed: 5000 rpm, start: 60 deg}\n"
                  "contact: {stiffness: 1e8 N/m}\n");
    const Joint *joints = scenario.linkage.joints;
    assert_int_equal(joints[0].kind, JOINT_REVOLUTE);
    assert_int_equal(joints[1].kind, JOINT_CLEARANCE);
    assert_int_equal(joints[2].kind, JOINT_CLEARANCE);
    assert_int_equal(joints[3].kind, JOINT_GUIDE);
    assert_near(linkage_radial_clearance(&joints[3]), 1e-3, 1e-17);
    const Motion *slider = &scenario.linkage.bodies[2].start;
    assert_near(slider->position.y, 0.5e-3, 1e-12);
    assert_near(slider->angle, 0.3 * DEGREE, 1e-12);
    // the rod still reaches from the crank's pin to the slider's
    const double rise = 0.05 * sin(60.0 * DEGREE) - 0.5e-3;
    assert_near(slider->position.x, 0.025 + sqrt(0.12 * 0.12 - rise * rise), 1e-12);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_closed_form_satisfies_the_joints_at_every_angle),
        cmocka_unit_test(the_sliders_extremes_have_the_known_nine_digits),
        cmocka_unit_test(the_strokes_ends_stand_where_crank_and_rod_are_in_line),
        cmocka_unit_test(reactions_are_those_of_newtons_laws_body_by_body),
        cmocka_unit_test(a_guide_away_from_the_pin_takes_a_couple),
        cmocka_unit_test(a_rod_that_is_too_short_has_no_turn),
        cmocka_unit_test(the_short_form_makes_the_same_linkage),
        cmocka_unit_test(joints_of_the_short_form_can_have_play),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
