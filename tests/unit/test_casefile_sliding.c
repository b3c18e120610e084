// Do the keys of prismatic joints, guides and stops become the joints they describe?
#include "casefile/casefile.h"

#include "close.h"
#include "contact/law.h"
#include "kept.h"
#include "model/coordinate.h"
#include "model/kinematics.h"

#include <string.h>

// A slider-crank whose line is 20 mm below the pivot and inclined by 10 deg; the block starts off
// the middle, tilted, where `guide` says so.
#define SLIDER_CRANK(slide)                                                                        \
    "bodies:\n"                                                                                    \
    "  crank:  {mass: 0.3 kg, inertia: 1e-4 kg m^2, at: [30 mm, 40 mm]}\n"                         \
    "  rod:    {mass: 0.2 kg, inertia: 1e-3 kg m^2, at: [200 mm, 0 mm], angle: 30 deg}\n"          \
    "  slider: {mass: 0.5 kg, inertia: 1e-3 kg m^2, at: [300 mm, 10 mm], angle: 15 deg}\n"         \
    "joints:\n"                                                                                    \
    "  main:  {between: [ground, crank], at: [0 mm, 0 mm]}\n"                                      \
    "  big:   {between: [crank, rod], at: [60 mm, 80 mm]}\n"                                       \
    "  small: {between: [rod, slider], at: [300 mm, 0 mm]}\n"                                      \
    "  slide: {between: [ground, slider], at: [310 mm, -20 mm], along: 10 deg" slide "}\n"         \
    "drive: {joint: main, speed: 1000 rpm}\n"

#define GUIDE                                                                                      \
    ", guide: 52 mm, block: 50 mm, length: 100 mm,\n"                                              \
    "          start: [-0.2 mm, 0.1 deg], stiffness: 2e8 N/m, restitution: 0.5"

static const char BALLS[] =
    "bodies:\n"
    "  first:  {mass: 0.1 kg, inertia: 1e-5 kg m^2, at: [1 mm, 11 mm], angle: 90 deg}\n"
    "  second: {mass: 0.1 kg, inertia: 1e-5 kg m^2, at: [0 mm, 40 mm]}\n"
    "joints:\n"
    "  floor: {between: [ground, first], at-a: [0 mm, 0 mm], at-b: [1 mm, 11 mm],\n"
    "          normal: 90 deg, radius: 10 mm}\n"
    "  tip: {between: [first, second], at-a: [1 mm, 21 mm], at-b: [0 mm, 40 mm], normal: 90 deg}\n"
    "  discs: {between: [first, second], at-a: [1 mm, 11 mm], at-b: [0 mm, 40 mm],\n"
    "          discs: [20 mm, 30 mm], stiffness: 1e9 N/m^1.5}\n"
    "contact: {stiffness: 1e6 N/m, restitution: 0.9}\n"
    "run: {duration: 10 ms, samples: 50}\n";

static Scenario load_sliding(const char *text)
{
    Scenario scenario;
    Err err = {0};
    if (!casefile_load_text("memory", text, strlen(text), NULL, 0, &scenario, &err)) {
        fail_msg("%s", err.text);
    }
    return kept_instead(&scenario);
}

static JointRows rows_at_start(const Linkage *linkage, int joint)
{
    Motion motions[KINEMATICS_BODY_MAX];
    JointRows rows;
    linkage_start(linkage, motions);
    joint_rows_find(linkage, motions, joint, &rows);
    return rows;
}

static void a_prismatic_joint_keeps_the_angle_that_the_bodies_are_given(void **state)
{
    (void)state;
    const Scenario scenario = load_sliding(SLIDER_CRANK(""));
    const Joint *slide = &scenario.linkage.joints[3];
    assert_int_equal(slide->kind, JOINT_PRISMATIC);
    assert_near(slide->direction, M_PI / 18.0, 1e-16);
    assert_near(slide->held_angle, M_PI / 12.0, 1e-16);
    assert_near(scenario.linkage.bodies[2].start.angle, M_PI / 12.0, 1e-16);
    const JointRows rows = rows_at_start(&scenario.linkage, 3);
    assert_near(rows.position[0], 0.0, 1e-16);
    assert_near(rows.position[1], 0.0, 1e-16);
    // the drive takes the slider along its line
    const Vec2 along = {cos(M_PI / 18.0), sin(M_PI / 18.0)};
    const Motion *slider = &scenario.linkage.bodies[2].start;
    assert_near(vec2_cross(along, slider->velocity), 0.0, 1e-15);
    assert_true(vec2_length(slider->velocity) > 0.1);
    assert_near(slider->omega, 0.0, 1e-14);
}

static void a_block_starts_off_the_middle_and_tilted_as_the_case_says(void **state)
{
    (void)state;
    const Scenario scenario = load_sliding(SLIDER_CRANK(GUIDE));
    const Joint *slide = &scenario.linkage.joints[3];
    assert_int_equal(slide->kind, JOINT_GUIDE);
    assert_near(linkage_radial_clearance(slide), 1e-3, 1e-17);
    const JointRows rows = rows_at_start(&scenario.linkage, 3);
    assert_near(rows.position[0], -0.2e-3, 1e-16);
    assert_near(rows.position[1], 0.1 * M_PI / 180.0, 1e-16);
    // at rest between its guides
    assert_near(rows.rate[0], 0.0, 1e-14);
    assert_near(rows.rate[1], 0.0, 1e-14);
    ForceLaw law;
    Err err = {0};
    assert_true(law_of_joint(&scenario, slide, &law, &err));
    assert_near(force_law_elastic(&law, 1e-6), 200.0, 1e-12);
}

static void a_stop_is_between_the_places_that_the_case_gives(void **state)
{
    (void)state;
    const Scenario scenario = load_sliding(BALLS);
    const Joint *joints = scenario.linkage.joints;
    for (int i = 0; i < 3; i++) {
        assert_int_equal(joints[i].kind, JOINT_STOP);
    }
    assert_near(joints[0].direction, 0.5 * M_PI, 1e-16);
    assert_near(joints[0].stop.radius_b, 0.01, 1e-18);
    assert_false(joints[0].stop.is_disc);
    // the line and its normal turn with the first body, which stands at 90 deg
    assert_near(joints[1].direction, 0.0, 1e-16);
    assert_near(joints[1].anchor_a.x, 0.01, 1e-17);
    assert_near(joints[1].anchor_a.y, 0.0, 1e-17);
    assert_near(joints[1].anchor_b.y, 0.0, 1e-17);
    assert_true(joints[2].stop.is_disc);
    assert_near(joints[2].stop.radius_a, 0.01, 1e-18);
    assert_near(joints[2].stop.radius_b, 0.015, 1e-18);
}

static void a_joints_own_stiffness_and_restitution_go_before_those_of_the_contact(void **state)
{
    (void)state;
    const Scenario balls = load_sliding(BALLS);
    const Scenario slider = load_sliding(SLIDER_CRANK(GUIDE));
    ForceLaw law;
    Err err = {0};
    assert_true(law_of_joint(&balls, &balls.linkage.joints[0], &law, &err));
    assert_near(force_law_elastic(&law, 1e-4), 100.0, 1e-12);
    assert_true(law_of_joint(&balls, &balls.linkage.joints[2], &law, &err));
    assert_near(force_law_elastic(&law, 1e-4), 1000.0, 1e-11);
    assert_near(law_options(&slider.contact, &slider.linkage.joints[3]).restitution, 0.5, 0.0);
    assert_near(law_options(&balls.contact, &balls.linkage.joints[2]).restitution, 0.9, 0.0);
}

// By a speed, in place of the contact's damping: F = F_el (1 + c d').
static void a_joints_own_dissipation_goes_before_the_contacts_damping(void **state)
{
    (void)state;
    const Scenario balls = load_sliding(BALLS);
    Joint joint = balls.linkage.joints[2];
    ForceLaw law;
    Err err = {0};
    joint.contact.dissipation = 0.4;
    assert_true(law_of_joint(&balls, &joint, &law, &err));
    const double elastic = force_law_elastic(&law, 1e-4);
    assert_near(force_law_force(&law, 1e-4, 0.5, 2.0), 1.2 * elastic, 1e-9 * elastic);
    assert_near(force_law_force(&law, 1e-4, 0.5, 0.1), 1.2 * elastic, 1e-9 * elastic);
    // the control: that of the contact depends on the speed of the impact
    assert_true(law_of_joint(&balls, &balls.linkage.joints[2], &law, &err));
    assert_true(force_law_force(&law, 1e-4, 0.5, 0.1) >
                (1.0 + 1e-3) * force_law_force(&law, 1e-4, 0.5, 2.0));
}

// A depth of full damping of its own, with its own coefficient or the contact's; without one the
// coefficient alone is that of a damper that is whole at the wall.
static void a_joints_own_damping_may_grow_with_the_depth(void **state)
{
    (void)state;
    Scenario balls = load_sliding(BALLS);
    Joint joint = balls.linkage.joints[2];
    ForceLaw law;
    Err err = {0};
    joint.contact.viscous = 40.0;
    assert_true(law_of_joint(&balls, &joint, &law, &err));
    assert_near(law.full_damping_depth, 0.0, 0.0);
    assert_near(force_law_damping(&law, 1e-5, 1.0), 40.0, 0.0);
    joint.contact.full_depth = 2e-5;
    assert_true(law_of_joint(&balls, &joint, &law, &err));
    assert_near(force_law_damping(&law, 1e-5, 1.0), 20.0, 1e-13);
    // that of the contact, and of both in their parts
    balls.contact.damping = DAMPING_STEP;
    balls.contact.viscous_coefficient = 10.0;
    balls.contact.full_damping_depth = 1e-5;
    joint.contact.full_depth = joint.contact.viscous = 0.0;
    assert_true(law_of_joint(&balls, &joint, &law, &err));
    assert_near(force_law_damping(&law, 5e-6, 1.0), 5.0, 1e-13);
    joint.contact.viscous = 40.0;
    assert_true(law_of_joint(&balls, &joint, &law, &err));
    assert_near(force_law_damping(&law, 5e-6, 1.0), 20.0, 1e-13);
    joint.contact.full_depth = 2e-5;
    assert_true(law_of_joint(&balls, &joint, &law, &err));
    assert_near(force_law_damping(&law, 1e-5, 1.0), 20.0, 1e-13);
}

// What tune and map try goes before both.
static void one_stiffness_for_all_joints_goes_before_their_own(void **state)
{
    (void)state;
    Scenario balls = load_sliding(BALLS);
    const Scenario slider = load_sliding(SLIDER_CRANK(GUIDE));
    ForceLaw law;
    Err err = {0};
    scenario_set_stiffness(&balls, 3e6, 1.0);
    assert_true(law_of_joint(&balls, &balls.linkage.joints[2], &law, &err));
    assert_near(force_law_elastic(&law, 1e-4), 300.0, 1e-11);
    assert_near(scenario_restitution(&slider, &slider.linkage.joints[3]), 0.5, 0.0);
    assert_near(scenario_restitution(&balls, &balls.linkage.joints[2]), 0.9, 0.0);
}

static bool is_setting(const Scenario *scenario, const char *key, CasefileSetting *setting)
{
    CasefileWalk walk = casefile_walk(scenario);
    while (casefile_next(&walk, setting)) {
        if (strcmp(setting->key, key) == 0) {
            return setting->applies;
        }
    }
    return false;
}

static void settings_hold_what_the_case_says(void **state)
{
    (void)state;
    const Scenario slider = load_sliding(SLIDER_CRANK(GUIDE));
    const Scenario balls = load_sliding(BALLS);
    CasefileSetting setting;
    assert_true(is_setting(&slider, "joints.slide.along", &setting));
    assert_near(setting.numbers[0], M_PI / 18.0, 1e-16);
    assert_true(is_setting(&slider, "joints.slide.start", &setting));
    assert_near(setting.numbers[0], -0.2e-3, 1e-18);
    assert_near(setting.numbers[1], 0.1 * M_PI / 180.0, 1e-18);
    assert_string_equal(setting.unit, "m, rad");
    assert_true(is_setting(&slider, "joints.slide.stiffness", &setting));
    assert_string_equal(setting.unit, "N/m");
    assert_false(is_setting(&slider, "joints.slide.hole", &setting));
    assert_false(is_setting(&slider, "joints.small.stiffness", &setting));
    // the guide's stiffness is its own, so that no law is asked
    assert_false(is_setting(&slider, "contact.law", &setting));
    assert_true(is_setting(&balls, "joints.tip.at-a", &setting));
    assert_near(setting.numbers[1], 0.021, 1e-17);
    assert_true(is_setting(&balls, "joints.tip.at-b", &setting));
    assert_near(setting.numbers[1], 0.04, 1e-17);
    assert_true(is_setting(&balls, "joints.tip.normal", &setting));
    assert_near(setting.numbers[0], 0.5 * M_PI, 1e-16);
    assert_true(is_setting(&balls, "joints.discs.discs", &setting));
    assert_near(setting.numbers[1], 0.03, 1e-18);
    assert_false(is_setting(&balls, "joints.discs.at", &setting));
}

// A planet on an arm with an internal gear round it, an arm's hinge with stops, the planet's output
// with backlash.
static const char GEARED[] =
    "bodies:\n"
    "  arm:    {mass: 1 kg, inertia: 1e-3 kg m^2, at: [20 mm, 0 mm], angle: 10 deg}\n"
    "  planet: {mass: 0.1 kg, inertia: 1e-5 kg m^2, at: [40 mm, 0 mm], angle: 40 deg}\n"
    "  ring:   {mass: 2 kg, inertia: 1e-2 kg m^2, at: [0 mm, 0 mm]}\n"
    "  output: {mass: 0.1 kg, inertia: 1e-5 kg m^2, at: [40 mm, 0 mm], angle: 25 deg}\n"
    "joints:\n"
    "  turn: {between: [ground, arm], at: [0 mm, 0 mm], low: -30 deg, high: 90 deg,\n"
    "         stiffness: 2 N m/deg, viscous-coefficient: 3 N mm s/rad}\n"
    "  pin:  {between: [arm, planet], at: [40 mm, 0 mm]}\n"
    "  case: {between: [ring, arm], at: [0 mm, 0 mm]}\n"
    "  mesh: {gears: [pin, case], teeth: [20, -60], backlash: 0.1 deg, start: -10 um}\n"
    "  coupling: {between: [planet, output], at: [40 mm, 0 mm], backlash: 0.5 deg,\n"
    "             start: 0.1 deg, stiffness: 7 N m/rad^1.5}\n"
    "contact: {stiffness: 1e7 N/m}\n"
    "run: {duration: 10 ms, samples: 50}\n";

static void limits_and_gears_are_what_the_case_gives(void **state)
{
    (void)state;
    const double degree = M_PI / 180.0;
    const Scenario scenario = load_sliding(GEARED);
    const Joint *joints = scenario.linkage.joints;
    assert_int_equal(joints[0].kind, JOINT_REVOLUTE);
    assert_true(linkage_is_torsional(&joints[0]) && linkage_has_play(&joints[0]));
    assert_near(coordinate_low(&joints[0]), -30.0 * degree, 1e-15);
    assert_near(coordinate_high(&joints[0]), 90.0 * degree, 1e-15);
    assert_near(joints[0].contact.stiffness, 2.0 / degree, 1e-12);
    assert_near(joints[0].contact.viscous, 3e-3, 1e-18);
    // an internal gear: both radii together are the distance, from the planet to the ring
    const Gear *gear = &joints[3].gear;
    assert_int_equal(joints[3].body_a, 1);
    assert_int_equal(joints[3].body_b, 2);
    assert_near(gear->radius_a, -0.02, 1e-17);
    assert_near(gear->radius_b, 0.06, 1e-17);
    // the angle is one of the ring
    assert_near(joints[3].limits.backlash, 0.1 * degree * 0.06, 1e-18);
    assert_near(joints[3].limits.start, -1e-5, 1e-18);
    Motion motions[KINEMATICS_BODY_MAX];
    linkage_start(&scenario.linkage, motions);
    assert_near(coordinate_position(&scenario.linkage, motions, 3) - joints[3].limits.middle, -1e-5,
                1e-16);
    assert_near(coordinate_position(&scenario.linkage, motions, 4), -15.0 * degree, 1e-15);
    assert_near(joints[4].limits.middle, -15.1 * degree, 1e-15);
    assert_near(coordinate_high(&joints[4]), -14.85 * degree, 1e-15);
    assert_near(joints[4].contact.exponent, 1.5, 0.0);
    ForceLaw law;
    Err err = {0};
    assert_true(law_of_joint(&scenario, &joints[0], &law, &err));
    assert_near(law.viscous, 3e-3, 1e-18);
    assert_true(law_of_joint(&scenario, &joints[3], &law, &err));
    assert_near(law.stiffness, 1e7, 0.0);
    // one stiffness for all joints is one of lengths
    Scenario given = scenario;
    scenario_set_stiffness(&given, 5e8, 1.0);
    assert_true(law_of_joint(&given, &joints[3], &law, &err));
    assert_near(law.stiffness, 5e8, 0.0);
    assert_true(law_of_joint(&given, &joints[4], &law, &err));
    assert_near(law.stiffness, 7.0, 0.0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_prismatic_joint_keeps_the_angle_that_the_bodies_are_given),
        cmocka_unit_test(a_block_starts_off_the_middle_and_tilted_as_the_case_says),
        cmocka_unit_test(a_stop_is_between_the_places_that_the_case_gives),
        cmocka_unit_test(a_joints_own_stiffness_and_restitution_go_before_those_of_the_contact),
        cmocka_unit_test(a_joints_own_dissipation_goes_before_the_contacts_damping),
        cmocka_unit_test(a_joints_own_damping_may_grow_with_the_depth),
        cmocka_unit_test(one_stiffness_for_all_joints_goes_before_their_own),
        cmocka_unit_test(settings_hold_what_the_case_says),
        cmocka_unit_test(limits_and_gears_are_what_the_case_gives),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
