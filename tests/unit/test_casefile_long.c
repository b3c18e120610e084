// Does a case with bodies become the linkage it describes? Runs in the source root.
#include "casefile/casefile.h"

#include "close.h"
#include "kept.h"
#include "model/kinematics.h"
#include "scratch.h"

#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static const char PIN[] =
    "bodies:\n"
    "  pin: {mass: 0.1 kg, inertia: 2 kg mm^2, at: [1 mm, -2 mm], angle: 30 deg,\n"
    "        velocity: [0.5 m/s, 0 m/s], spin: 3 rad/s}\n"
    "joints:\n"
    "  hole: {between: [ground, pin], at: [0 mm, 0 mm], hole: 10.2 mm, pin: 10 mm}\n"
    "run: {duration: 10 ms, samples: 50}\n";

// A four-bar's joints and drive, to be filled with the places of elbow and wrist.
static const char LINKS[] = "joints:\n"
                            "  pivot: {between: [crank, ground], at: [0 mm, 0 mm]}\n"
                            "  elbow: {between: [crank, coupler], at: [%.17g m, %.17g m]}\n"
                            "  wrist: {between: [coupler, follower], at: [%.17g m, %.17g m]}\n"
                            "  heel:  {between: [follower, ground], at: [254 mm, 0 mm]}\n"
                            "drive: {joint: pivot, speed: 1000 rpm}\n";

// A driven crank with a rod that hangs on it and a pin in the rod's end: the drive moves the crank
// alone.
static const char CHAIN[] = "bodies:\n"
                            "  crank: {mass: 0.1 kg, inertia: 90 kg mm^2, at: [50 mm, 0 mm]}\n"
                            "  rod: {mass: 0.2 kg, inertia: 700 kg mm^2, at: [200 mm, 0 mm]}\n"
                            "joints:\n"
                            "  pivot: {between: [ground, crank], at: [0 mm, 0 mm]}\n"
                            "  elbow: {between: [crank, rod], at: [100 mm, 0 mm]}\n"
                            "drive: {joint: pivot, speed: 10 rad/s}\n";

static Scenario load_long(const char *text, const char *const *overrides, size_t count)
{
    Scenario scenario;
    Err err = {0};
    if (!casefile_load_text("memory", text, strlen(text), overrides, count, &scenario, &err)) {
        fail_msg("%s", err.text);
    }
    return kept_instead(&scenario);
}

static Scenario load_file(const char *path, const char *override)
{
    Scenario scenario;
    Err err = {0};
    if (!casefile_load(path, &override, override != NULL ? 1 : 0, &scenario, &err)) {
        fail_msg("%s", err.text);
    }
    return kept_instead(&scenario);
}

static void refuse_long(const char *text, const char *override, const char *message)
{
    Scenario scenario;
    Err err = {0};
    const size_t count = override != NULL ? 1 : 0;
    assert_false(
        casefile_load_text("memory", text, strlen(text), &override, count, &scenario, &err));
    assert_string_equal(err.text, message);
}

static Vec2 eccentricity(const Linkage *linkage, size_t number)
{
    Motion motions[KINEMATICS_BODY_MAX];
    linkage_start(linkage, motions);
    const Joint *joint = &linkage->joints[number];
    return vec2_sub(linkage_point(motions, joint->body_b, joint->anchor_b),
                    linkage_point(motions, joint->body_a, joint->anchor_a));
}

static void a_pin_in_a_hole_is_what_the_case_says(void **state)
{
    (void)state;
    const Scenario scenario = load_long(PIN, NULL, 0);
    const Linkage *linkage = &scenario.linkage;
    assert_int_equal(linkage->body_count, 1);
    assert_int_equal(linkage->joint_count, 1);
    assert_false(linkage->driver.is_present);
    assert_false(scenario.has_fourbar);
    const Motion *start = &linkage->bodies[0].start;
    assert_near(start->position.x, 1e-3, 0.0);
    assert_near(start->angle, M_PI / 6.0, 1e-16);
    assert_near(start->velocity.x, 0.5, 0.0);
    assert_near(start->omega, 3.0, 0.0);
    assert_int_equal(linkage->joints[0].kind, JOINT_CLEARANCE);
    assert_int_equal(linkage->joints[0].body_a, LINKAGE_GROUND);
    assert_near(linkage_radial_clearance(&linkage->joints[0]), 1e-4, 1e-17);
    // the anchor follows the body's frame: R(-30 deg) (-1, 2) mm
    assert_near(linkage->joints[0].anchor_b.x, 1e-3 * (1.0 - cos(M_PI / 6.0)), 1e-17);
    assert_near(linkage->joints[0].anchor_b.y, 1e-3 * (0.5 + 2.0 * cos(M_PI / 6.0)), 1e-17);
    assert_near(scenario_duration(&scenario), 0.01, 0.0);
    assert_int_equal(scenario_sample_count(&scenario), 51);
    // the closed form knows four-bars only
    assert_int_equal(scenario.run.backend_count, 2);
    assert_int_equal(scenario.run.backends[0], BACKEND_REFERENCE);
    assert_int_equal(scenario.run.backends[1], BACKEND_ODE);
}

static void append_link(Text *text, const Body *body)
{
    text_append(text,
                "  %s: {mass: %.17g kg, inertia: %.17g kg m^2, at: [%.17g m, %.17g m], angle: "
                "%.17g rad}\n",
                body->name, body->mass, body->inertia, body->start.position.x,
                body->start.position.y, body->start.angle);
}

// The short form is the outside truth: the same four-bar as bodies starts and moves alike.
static void a_four_bar_as_bodies_moves_as_the_short_form_says(void **state)
{
    (void)state;
    const Scenario truth = load_file("cases/paper/ideal-nominal.yaml", "drive.start=50 deg");
    const Linkage *links = &truth.linkage;
    Motion motions[KINEMATICS_BODY_MAX];
    Text text;
    text_init(&text);
    text_append(&text, "bodies:\n");
    for (size_t i = 0; i < links->body_count; i++) {
        motions[i] = links->bodies[i].start;
        append_link(&text, &links->bodies[i]);
    }
    const Vec2 elbow = linkage_point(motions, 0, links->joints[1].anchor_a);
    const Vec2 wrist = linkage_point(motions, 1, links->joints[2].anchor_a);
    text_append(&text, LINKS, elbow.x, elbow.y, wrist.x, wrist.y);
    const Scenario built = load_long(text.data, NULL, 0);
    for (size_t i = 0; i < links->body_count; i++) {
        const Motion *motion = &built.linkage.bodies[i].start;
        assert_near(motion->position.x, motions[i].position.x, 1e-12);
        assert_near(motion->angle, motions[i].angle, 1e-12);
        assert_near(motion->velocity.y, motions[i].velocity.y, 1e-9);
        assert_near(motion->omega, motions[i].omega, 1e-8);
        assert_near(motion->alpha, motions[i].alpha, 1e-5);
    }
    // an ideal joint has no sides: the drive finds the ground in its first place
    assert_int_equal(built.linkage.joints[0].body_a, LINKAGE_GROUND);
    assert_int_equal(linkage_driven_body(&built.linkage), 0);
    assert_near(built.linkage.driver.start, 50.0 * M_PI / 180.0, 1e-12);
    text_finish(&text);
}

static void a_pin_off_the_centre_moves_the_bodies(void **state)
{
    (void)state;
    static const char *const OVERRIDE[] = {"joints.hole.start=[60 um, 80 um]"};
    const Scenario pin = load_long(PIN, OVERRIDE, 1);
    assert_near(eccentricity(&pin.linkage, 0).x, 60e-6, 1e-15);
    assert_near(eccentricity(&pin.linkage, 0).y, 80e-6, 1e-15);
    // at the wall, however the radii are rounded
    assert_true(vec2_length(pin.linkage.joints[0].clearance.start) <=
                linkage_radial_clearance(&pin.linkage.joints[0]));
    const Scenario linkage =
        load_file("cases/literature/parallelogram.yaml", "joints.wrist.start=[3 um, -4 um]");
    // joints close to 1e-13 m
    assert_near(eccentricity(&linkage.linkage, 2).x, 3e-6, 1e-13);
    assert_near(eccentricity(&linkage.linkage, 2).y, -4e-6, 1e-13);
    assert_near(eccentricity(&linkage.linkage, 1).x, 0.0, 1e-13);
    static const char *const PLAY[] = {
        "joints.elbow={radial-clearance: 1 mm, pin: 10 mm, start: [0.3 mm, 0.4 mm]}"};
    const Scenario chain = load_long(CHAIN, PLAY, 1);
    assert_near(eccentricity(&chain.linkage, 1).x, 3e-4, 1e-15);
    assert_near(chain.linkage.bodies[0].start.angle, 0.0, 1e-13);
}

static bool is_setting(const Scenario *scenario, const char *key)
{
    CasefileSetting setting;
    CasefileWalk walk = casefile_walk(scenario);
    while (casefile_next(&walk, &setting)) {
        if (strcmp(setting.key, key) == 0) {
            return setting.applies;
        }
    }
    return false;
}

static void hole_and_pin_stand_where_each_is_said_to(void **state)
{
    (void)state;
    static const char *const APART[] = {
        "joints.hole={between: [ground, pin], at-a: [2 mm, 1 mm], at-b: [2.03 mm, 0.96 mm], "
        "hole: 10.2 mm, pin: 10 mm}"};
    const Scenario apart = load_long(PIN, APART, 1);
    const Joint *joint = &apart.linkage.joints[0];
    const Motion *body = &apart.linkage.bodies[0].start;
    // the body stays where it is, and the pin is at its place on it
    assert_true(body->position.x == 1e-3 && body->position.y == -2e-3);
    assert_near(joint->anchor_a.x, 2e-3, 1e-18);
    assert_near(joint->anchor_a.y, 1e-3, 1e-18);
    const Vec2 arm = vec2_rotate(-M_PI / 6.0, (Vec2){1.03e-3, 2.96e-3});
    assert_near(joint->anchor_b.x, arm.x, 1e-17);
    assert_near(joint->anchor_b.y, arm.y, 1e-17);
    assert_near(eccentricity(&apart.linkage, 0).x, 30e-6, 1e-17);
    assert_near(joint->clearance.start.x, 30e-6, 1e-17);
    assert_near(joint->clearance.start.y, -40e-6, 1e-17);
    assert_true(is_setting(&apart, "joints.hole.at-a") && is_setting(&apart, "joints.hole.at-b"));
    assert_false(is_setting(&apart, "joints.hole.at") || is_setting(&apart, "joints.hole.start"));
    // one place instead of the two, and two instead of the one
    const char *const ONE[] = {APART[0], "joints.hole.at=[0 mm, 0 mm]"};
    const Scenario one = load_long(PIN, ONE, 2);
    assert_true(is_setting(&one, "joints.hole.at") && is_setting(&one, "joints.hole.start"));
    assert_false(is_setting(&one, "joints.hole.at-a") || is_setting(&one, "joints.hole.at-b"));
    static const char *const TWO[] = {"joints.hole.at-a=[1 mm, 0 mm]",
                                      "joints.hole.at-b=[1.1 mm, 0 mm]"};
    // at the wall, however the places are rounded
    const Scenario two = load_long(PIN, TWO, 2);
    assert_near(eccentricity(&two.linkage, 0).x, 1e-4, 1e-16);
    assert_true(vec2_length(two.linkage.joints[0].clearance.start) <=
                linkage_radial_clearance(&two.linkage.joints[0]));
    refuse_long(PIN, "joints.hole.at-a=[1 mm, 0 mm]",
                "memory:5:3: joints.hole.at-b is missing\n"
                "      hole: {between: [ground, pin], at: [0 mm, 0 mm], hole: 10.2 mm, pin:...\n"
                "      ^~~~\n"
                "allowed: [x, y] such as [25 mm, 0 mm]");
}

// In a loop that a drive determines the pin begins where it stands as well.
static void a_pin_that_stands_apart_is_there_in_a_driven_loop(void **state)
{
    (void)state;
    static const char LOOP[] =
        "bodies:\n"
        "  crank: {mass: 0.1 kg, inertia: 90 kg mm^2, at: [0 mm, 25 mm], angle: 90 deg}\n"
        "  rod: {mass: 0.2 kg, inertia: 700 kg mm^2, at: [60 mm, 65 mm], angle: 14 deg}\n"
        "  rocker: {mass: 0.1 kg, inertia: 90 kg mm^2, at: [120 mm, 40 mm], angle: 90 deg}\n"
        "joints:\n"
        "  pivot: {between: [ground, crank], at: [0 mm, 0 mm]}\n"
        "  elbow: {between: [crank, rod], at-a: [0 mm, 50 mm], at-b: [0.03 mm, 49.98 mm],\n"
        "          radial-clearance: 50 um, pin: 10 mm}\n"
        "  wrist: {between: [rod, rocker], at: [120 mm, 80 mm]}\n"
        "  heel:  {between: [ground, rocker], at: [120 mm, 0 mm]}\n"
        "drive: {joint: pivot, speed: 100 rpm}\n";
    const Scenario loop = load_long(LOOP, NULL, 0);
    assert_near(eccentricity(&loop.linkage, 1).x, 30e-6, 1e-13);
    assert_near(eccentricity(&loop.linkage, 1).y, -20e-6, 1e-13);
    for (size_t i = 0; i < 4; i++) {
        assert_true(i == 1 || vec2_length(eccentricity(&loop.linkage, i)) < 1e-14);
    }
    // the bodies are where the case has them
    assert_near(loop.linkage.bodies[1].start.position.x, 60e-3, 1e-12);
    assert_near(loop.linkage.bodies[2].start.position.y, 40e-3, 1e-12);
    // and the motion is one that the places decide, not settled from a start of the case's own
    assert_int_equal(loop.run.start, START_SETTLED);
}

// Two holes 10 um apart on one pin are one place, and no link of that length.
static void holes_of_one_pin_are_no_link(void **state)
{
    (void)state;
    static const char PLATES[] =
        "bodies:\n"
        "  bolt: {mass: 0.1 kg, inertia: 2 kg mm^2, at: [0 mm, 0 mm]}\n"
        "  plate: {mass: 0.1 kg, inertia: 90 kg mm^2, at: [40 mm, 0 mm]}\n"
        "joints:\n"
        "  first:  {between: [ground, bolt], at-a: [0 mm, 0 mm], at-b: [5 um, 0 um],\n"
        "           radial-clearance: 20 um, pin: 10 mm}\n"
        "  second: {between: [plate, bolt], at-a: [10 um, 0 mm], at-b: [5 um, 0 um],\n"
        "           radial-clearance: 20 um, pin: 10 mm}\n";
    const Scenario plates = load_long(PLATES, NULL, 0);
    assert_near(eccentricity(&plates.linkage, 1).x, -5e-6, 1e-17);
    static const char APART[] =
        "bodies:\n"
        "  bolt: {mass: 0.1 kg, inertia: 2 kg mm^2, at: [0 mm, 0 mm]}\n"
        "joints:\n"
        "  first: {between: [ground, bolt], at: [0 mm, 0 mm], radial-clearance: 20 um}\n"
        "  other: {between: [ground, bolt], at: [10 um, 0 mm], radial-clearance: 20 um}\n"
        "contact: {stiffness: 1e8 N/m}\n";
    Scenario scenario;
    Err err = {0};
    assert_false(casefile_load_text("memory", APART, strlen(APART), NULL, 0, &scenario, &err));
    assert_non_null(strstr(err.text, "is as long as a link"));
}

// A third crank: with every joint held one is redundant, and the third turns with the others.
static void redundant_play_is_no_hindrance(void **state)
{
    (void)state;
    static const char *const OVERRIDES[] = {
        "bodies.third={mass: 0.1 kg, inertia: 90 kg mm^2, at: [100 mm, 50 mm]}",
        "joints.foot={between: [ground, third], at: [100 mm, 0 mm]}",
        "joints.head={between: [coupler, third], at: [100 mm, 100 mm], pin: 5 mm, hole: 5.02 mm}",
    };
    Scenario scenario;
    Err err = {0};
    assert_true(
        casefile_load("cases/literature/parallelogram.yaml", OVERRIDES, 3, &scenario, &err));
    const double speed = scenario.linkage.driver.speed;
    for (size_t i = 0; i < scenario.linkage.body_count; i++) {
        const double omega = strcmp(scenario.linkage.bodies[i].name, "coupler") == 0 ? 0.0 : speed;
        assert_near(scenario.linkage.bodies[i].start.omega, omega, 1e-9 * speed);
    }
    scenario_free(&scenario);
}

// Rounding of two hundred metres is more than a joint of some centimetres was once held to be
// closed by; the search for what was to blame then had no end.
static void a_body_far_from_its_joints_is_placed(void **state)
{
    (void)state;
    static const char FAR[] =
        "bodies:\n"
        "  crank: {mass: 0.1 kg, inertia: 563.3 kg mm^2, at: [112.583302492 mm, 65 mm],\n"
        "          angle: 30 deg}\n"
        "  coupler: {mass: 0.2 kg, inertia: 1301 kg mm^2, at: [348.635773552 mm, 195.633675 m]}\n"
        "  follower: {mass: 0.15 kg, inertia: 914.6 kg mm^2,\n"
        "             at: [436.05247106 mm, 130.356364749 mm]}\n"
        "  pendulum: {mass: 0.1 kg, inertia: 80 kg mm^2, at: [348.6 mm, 145 mm]}\n"
        "joints:\n"
        "  pivot: {between: [ground, crank], at: [0 mm, 0 mm]}\n"
        "  elbow: {between: [crank, coupler], at: [225.166604984 mm, 130 mm]}\n"
        "  wrist: {between: [coupler, follower], at: [472.10494212 mm, 260.712729497 mm]}\n"
        "  heel: {between: [ground, follower], at: [400 mm, 0 mm]}\n"
        "  hook: {between: [coupler, pendulum], at: [348.6 mm, 195 mm],\n"
        "         radial-clearance: 50 um, pin: 10 mm}\n"
        "drive: {joint: pivot, speed: 300 rpm}\n"
        "run: {revolutions: 0.1}\n";
    const Scenario scenario = load_long(FAR, NULL, 0);
    const Linkage *linkage = &scenario.linkage;
    for (size_t i = 0; i < linkage->joint_count; i++) {
        // a hundredth of the clearance would show in a run
        assert_near(vec2_length(eccentricity(linkage, i)), 0.0, 1e-11);
    }
}

static Vec2 parting(const Linkage *linkage, size_t number)
{
    Motion motions[KINEMATICS_BODY_MAX];
    linkage_start(linkage, motions);
    const Joint *joint = &linkage->joints[number];
    return vec2_sub(linkage_point_velocity(motions, joint->body_b, joint->anchor_b),
                    linkage_point_velocity(motions, joint->body_a, joint->anchor_a));
}

// The rod starts as a blow on its end leaves it, which then moves with the crank's.
static void a_drive_takes_free_bodies_with_it(void **state)
{
    (void)state;
    const Scenario scenario = load_long(CHAIN, NULL, 0);
    const Body *rod = &scenario.linkage.bodies[1];
    assert_near(vec2_length(parting(&scenario.linkage, 0)), 0.0, 1e-15);
    assert_near(vec2_length(parting(&scenario.linkage, 1)), 0.0, 1e-15);
    assert_near(scenario.linkage.bodies[0].start.omega, 10.0, 1e-14);
    // impulse J at the end: m v_c = J, I omega = -J l/2, v_c - omega l/2 = 1 m/s with l/2 = 0.1 m
    const double impulse = 1.0 / (1.0 / rod->mass + 0.01 / rod->inertia);
    assert_close(rod->start.velocity.y, impulse / rod->mass, 1e-12);
    assert_close(rod->start.omega, -0.1 * impulse / rod->inertia, 1e-12);
}

static void speeds_that_agree_are_taken_as_they_are(void **state)
{
    (void)state;
    static const char *const OVERRIDES[] = {
        "bodies.crank.spin=10 rad/s", "bodies.crank.velocity=[0 m/s, 0.5 m/s]",
        "bodies.rod.velocity=[0 m/s, 1.2 m/s]", "bodies.rod.spin=2 rad/s"};
    const Scenario scenario = load_long(CHAIN, OVERRIDES, 4);
    assert_near(scenario.linkage.bodies[1].start.velocity.y, 1.2, 1e-12);
    assert_near(scenario.linkage.bodies[1].start.omega, 2.0, 1e-12);
    // rounded to nine digits they still agree, and are then made to
    static const char *const ROUNDED[] = {
        "bodies.crank.spin=10 rad/s", "bodies.crank.velocity=[0 m/s, 0.5 m/s]",
        "bodies.rod.velocity=[0 m/s, 1.2000000005 m/s]", "bodies.rod.spin=2 rad/s"};
    const Scenario rounded = load_long(CHAIN, ROUNDED, 4);
    assert_near(vec2_length(parting(&rounded.linkage, 1)), 0.0, 1e-15);
    refuse_long(
        CHAIN, "bodies.rod.spin=2 rad/s",
        "--set bodies.rod.spin=2 rad/s: the speeds at the start pull the ideal joint 'elbow' "
        "apart by 1.2 m/s\n"
        "    --set bodies.rod.spin=2 rad/s\n"
        "                          ^~~~~~~\n"
        "allowed: speeds that keep the joints closed, such as the nearest: rod: {velocity: [0 "
        "m/s, 0.311111111111 m/s], spin: -6.88888888889 rad/s}");
    // and so it is
    static const char *const NEAREST[] = {"bodies.rod.velocity=[0 m/s, 0.311111111111 m/s]",
                                          "bodies.rod.spin=-6.88888888889 rad/s"};
    const Scenario nearest = load_long(CHAIN, NEAREST, 2);
    assert_near(vec2_length(parting(&nearest.linkage, 1)), 0.0, 1e-15);
    refuse_long(
        CHAIN, "bodies.crank.spin=0 rad/s",
        "--set bodies.crank.spin=0 rad/s: a driven body does not turn as its drive does\n"
        "    --set bodies.crank.spin=0 rad/s\n"
        "                            ^~~~~~~\n"
        "allowed: speeds that keep the joints closed, such as the nearest: crank: {velocity: [0 "
        "m/s, 0.5 m/s], spin: 10 rad/s}, rod: {velocity: [0 m/s, 0.259259259259 m/s], spin: "
        "-7.40740740741 rad/s}");
}

static void points_stand_on_any_body(void **state)
{
    (void)state;
    static const char *const OVERRIDES[] = {"points.tip={body: rod, along: 100 mm, offset: 5 mm}"};
    const Scenario scenario = load_long(CHAIN, OVERRIDES, 1);
    assert_int_equal(scenario.points[0].body, 1);
    assert_near(scenario.points[0].local.x, 0.1, 0.0);
    assert_near(scenario.points[0].local.y, 0.005, 0.0);
    refuse_long(
        CHAIN, "points.tip={body: rood, along: 1 mm}",
        "--set points.tip={body: rood, along: 1 mm}: unknown body 'rood'; did you mean 'rod'?\n"
        "    --set points.tip={body: rood, along: 1 mm}\n"
        "                            ^~~~\n"
        "allowed: crank, rod");
}

static bool find_long_setting(const Scenario *scenario, const char *key, CasefileSetting *setting)
{
    CasefileWalk walk = casefile_walk(scenario);
    while (casefile_next(&walk, setting)) {
        if (strcmp(setting->key, key) == 0) {
            return setting->applies;
        }
    }
    return false;
}

static void settings_tell_bodies_and_joints(void **state)
{
    (void)state;
    CasefileSetting setting;
    const Scenario pin = load_long(PIN, NULL, 0);
    assert_true(find_long_setting(&pin, "bodies.pin.velocity", &setting));
    assert_int_equal(setting.number_count, 2);
    assert_near(setting.numbers[0], 0.5, 0.0);
    assert_string_equal(setting.unit, "m/s");
    assert_true(find_long_setting(&pin, "joints.hole.between", &setting));
    assert_string_equal(setting.text, "ground, pin");
    assert_true(find_long_setting(&pin, "joints.hole.at", &setting));
    assert_near(setting.numbers[1], 0.0, 1e-18);
    assert_true(find_long_setting(&pin, "run.duration", &setting));
    assert_false(find_long_setting(&pin, "run.revolutions", &setting));
    assert_false(find_long_setting(&pin, "drive.speed", &setting));
    assert_false(find_long_setting(&pin, "four-bar.crank.length", &setting));
    assert_false(find_long_setting(&pin, "contact.friction-speed", &setting));
    static const char *const POINT[] = {"points.tip={body: rod, along: 100 mm}",
                                        "contact.friction=0.1", "reference.tolerance=1e-9"};
    const Scenario chain = load_long(CHAIN, POINT, 3);
    assert_true(find_long_setting(&chain, "drive.joint", &setting));
    assert_string_equal(setting.text, "pivot");
    assert_true(find_long_setting(&chain, "points.tip.body", &setting));
    assert_string_equal(setting.text, "rod");
    assert_true(find_long_setting(&chain, "points.tip.along", &setting));
    assert_near(setting.numbers[0], 0.1, 0.0);
    assert_true(find_long_setting(&chain, "reference.tolerance", &setting));
    assert_near(chain.reference.tolerance, 1e-9, 0.0);
    assert_false(find_long_setting(&chain, "joints.elbow.hole", &setting));
    // of a determined mechanism the drive sets the speeds
    const Scenario linkage = load_file("cases/literature/parallelogram.yaml", NULL);
    assert_false(find_long_setting(&linkage, "bodies.coupler.spin", &setting));
    assert_true(find_long_setting(&linkage, "joints.wrist.radial-clearance", &setting));
}

static void the_cases_of_the_literature_load(void **state)
{
    (void)state;
    static const char *const CASES[] = {"four-bar-half-mm", "parallelogram", "pin-in-hole-drop",
                                        "pin-in-hole-orbit", "three-clearances"};
    for (size_t i = 0; i < sizeof CASES / sizeof CASES[0]; i++) {
        char path[128];
        snprintf(path, sizeof path, "cases/literature/%s.yaml", CASES[i]);
        const Scenario scenario = load_file(path, NULL);
        assert_true(scenario_has_clearance(&scenario));
        Motion motions[KINEMATICS_BODY_MAX];
        linkage_start(&scenario.linkage, motions);
        // with the play open nothing is redundant: each freedom is one a body, less two a joint
        size_t held = 0;
        for (size_t k = 0; k < scenario.linkage.joint_count; k++) {
            held += scenario.linkage.joints[k].kind == JOINT_REVOLUTE ? 2 : 0;
        }
        assert_int_equal(kinematics_mobility(&scenario.linkage, motions, true),
                         3 * scenario.linkage.body_count - held);
    }
    const Scenario orbit = load_file("cases/literature/pin-in-hole-orbit.yaml", NULL);
    assert_near(orbit.linkage.bodies[0].start.position.x, 1e-4, 1e-15);
    assert_near(orbit.linkage.bodies[0].start.velocity.y, 0.5, 0.0);
}

// An arm with a load from a table of so many bytes, which lies in a file of its own.
static bool load_table(const char *table, size_t size, const char *area, Scenario *scenario,
                       Err *err)
{
    char path[128];
    char text[1024];
    scratch_path("load.csv", path, sizeof path);
    FILE *stream = fopen(path, "w");
    assert_non_null(stream);
    assert_int_equal(fwrite(table, 1, size, stream), size);
    assert_int_equal(fclose(stream), 0);
    snprintf(text, sizeof text,
             "bodies:\n  arm: {mass: 0.1 kg, inertia: 2 kg mm^2, at: [50 mm, 0 mm]}\n"
             "joints:\n  pivot: {between: [ground, arm], at: [0 mm, 0 mm]}\n"
             "loads: {gas: {body: arm, %sforce: %s}}\n",
             area, path);
    *err = (Err){0};
    const bool is_loaded = casefile_load_text("memory", text, strlen(text), NULL, 0, scenario, err);
    unlink(path);
    return is_loaded;
}

static void check_table(const char *table, const char *area)
{
    Scenario scenario;
    Err err;
    if (!load_table(table, strlen(table), area, &scenario, &err)) {
        fail_msg("%s", err.text);
    }
    const Scenario kept = kept_instead(&scenario);
    const LoadTable *load_long = &kept.linkage.loads[0].table;
    assert_int_equal(load_long->count, 2);
    assert_near(load_long->at[1], 0.002, 1e-15);
    assert_near(load_long->values[0], -3000.0, 1e-9);
    assert_near(load_long->values[1], 1500.0, 1e-9);
}

static void refuse_table(const char *table, size_t size, const char *message)
{
    Scenario scenario;
    Err err;
    assert_false(load_table(table, size, "", &scenario, &err));
    if (strstr(err.text, message) == NULL) {
        fail_msg("'%s' lacks '%s'", err.text, message);
    }
    // what would be allowed stands in a line of its own
    assert_null(strstr(err.text, "\\n"));
}

static void loads_are_read_from_tables_as_spreadsheets_write_them(void **state)
{
    (void)state;
    check_table("time [ms], force [kN]\n0, -3\n2, 1.5\n", "");
    check_table("\xef\xbb\xbf\"time, \"\"t\"\" [ms]\";\"force [kN]\"\r\n\"0\";\"-3\"\r\n"
                " \"2\" ; \"1.5\" \r\n",
                "");
    check_table("\"time [ms]\",force [kN]\n0,\"-3\"\n\"2\",1.5\n", "");
    check_table("time [ms],pressure [bar]\n0,24\n2,-12\n", "area: -12.5 cm^2, ");
#define REFUSE(table, message) refuse_table(table, sizeof(table) - 1, message)
    REFUSE("time [ms],force [kN]\n\"0,-3\n", ":2: expected two numbers with a comma between");
    REFUSE("time [ms],force [kN]\n0,-3\n2,1\n2,1.5\n",
           ":4: this point is not in order: 0.002 s after 0.002 s\nallowed: each point behind the "
           "one before; a jump is two points close together");
    REFUSE("time [ms],pressure [bar]\n0,24\n",
           ":1: [bar] is a pressure, and the load has no area that it acts on\nallowed: area: ");
    REFUSE("time [ms],force [kN]\n0,-3\0 N\n2,1.5\n", ": byte 25 (0x00) is not text");
}

// A pipe without a writer would be waited for for ever.
static void a_pipe_is_no_table(void **state)
{
    (void)state;
    char path[128];
    char text[512];
    scratch_path("pipe.csv", path, sizeof path);
    assert_int_equal(mkfifo(path, 0600), 0);
    snprintf(text, sizeof text, "loads.gas.force=%s", path);
    static const char CASE[] =
        "bodies:\n  arm: {mass: 0.1 kg, inertia: 2 kg mm^2, at: [50 mm, 0 mm]}\n"
        "joints:\n  pivot: {between: [ground, arm], at: [0 mm, 0 mm]}\n"
        "loads: {gas: {body: arm, force: 1 N}}\n";
    const char *const override = text;
    Scenario scenario;
    Err err = {0};
    assert_false(casefile_load_text("memory", CASE, strlen(CASE), &override, 1, &scenario, &err));
    assert_non_null(strstr(err.text, "cannot be read: it is no regular file"));
    err = (Err){0};
    assert_false(casefile_load(path, NULL, 0, &scenario, &err));
    assert_int_equal(err.kind, ERR_FILE);
    unlink(path);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_pin_in_a_hole_is_what_the_case_says),
        cmocka_unit_test(a_four_bar_as_bodies_moves_as_the_short_form_says),
        cmocka_unit_test(a_pin_off_the_centre_moves_the_bodies),
        cmocka_unit_test(hole_and_pin_stand_where_each_is_said_to),
        cmocka_unit_test(a_pin_that_stands_apart_is_there_in_a_driven_loop),
        cmocka_unit_test(holes_of_one_pin_are_no_link),
        cmocka_unit_test(redundant_play_is_no_hindrance),
        cmocka_unit_test(a_body_far_from_its_joints_is_placed),
        cmocka_unit_test(a_drive_takes_free_bodies_with_it),
        cmocka_unit_test(speeds_that_agree_are_taken_as_they_are),
        cmocka_unit_test(points_stand_on_any_body),
        cmocka_unit_test(settings_tell_bodies_and_joints),
        cmocka_unit_test(the_cases_of_the_literature_load),
        cmocka_unit_test(loads_are_read_from_tables_as_spreadsheets_write_them),
        cmocka_unit_test(a_pipe_is_no_table),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
