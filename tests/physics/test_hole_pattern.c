// Do several pins between two bodies, whose holes and pins are off their places, share a load as
// statics says, and are they put into their holes together?
//
// Statics of a plate with pins b_i in holes a_i, place p and angle phi:
//     e_i = p + R(phi) b_i - a_i,   F_i = -K max(|e_i| - c, 0) e_i / |e_i|
//     sum F_i + F = 0,              sum (R b_i) x F_i + T = 0
// Six pins on a circle of radius r with the first hole off by s along the circle, all of them
// pressed, by hand, where s is small beside e = c + F / K, and that beside r. With F = T / (6 r),
// n_i the directions along the circle, whose sum is 0 and the sum of whose dyads is 3, and F / e
// the stiffness across them, the plate moves by d and turns further by u / r,
//     3 (K + F / e) d = K s n_1,        6 K u = K s
//     F_i = F + K s (k n_1 . n_i / 3 + 1/6 - [i = 1]),        k = K / (K + F / e)
// and with the plate on a pivot of its own k = 0.
#include "complete_run.h"

#include "base/lcg.h"
#include "kept.h"
#include "model/kinematics.h"
#include "run/settle.h"
#include "run/settle_draw.h"
#include "run/settle_together.h"
#include "sample.h"

#include "casefile/casefile.h"

#include <stdio.h>
#include <string.h>

enum { PINS = 6 };

static const double RADIUS = 20e-3;  // m, of the circle of the holes
static const double PLAY = 20e-6;    // m
static const double OFF = 10e-6;     // m, of the first hole
static const double STIFFNESS = 1e8; // N/m

// What differs from case to case.
typedef struct Pattern {
    Vec2 off;         // m, of the first hole from its place
    double torque;    // N m
    Vec2 force;       // N
    const char *head; // before the joints
    const char *tail; // behind the pins
    const char *body_a;
} Pattern;

static const char FREE_PLATE[] = "bodies:\n"
                                 "  plate: {mass: 0.5 kg, inertia: 400 kg mm^2, at: [0 mm, 0 mm]}\n"
                                 "joints:\n";
static const char COUPLING[] = "bodies:\n"
                               "  plate: {mass: 0.5 kg, inertia: 400 kg mm^2, at: [0 mm, 0 mm]}\n"
                               "  disc:  {mass: 0.5 kg, inertia: 400 kg mm^2, at: [0 mm, 0 mm]}\n"
                               "joints:\n"
                               "  shaft: {between: [ground, disc], at: [0 mm, 0 mm]}\n"
                               "  axle:  {between: [ground, plate], at: [0 mm, 0 mm]}\n";
static const char DAMPED[] =
    "contact: {stiffness: 1e8 N/m, damping: viscous, viscous-coefficient: 5e3 N s/m}\n"
    "gravity: 0 m/s^2\n"
    "run: {duration: 5 ms, step: 1 us, samples: 500}\n";
static const char DRIVEN[] = "drive: {joint: shaft, speed: 3000 rpm}\n"
                             "contact: {stiffness: 1e8 N/m, restitution: 0.5}\n"
                             "gravity: 0 m/s^2\n"
                             "run: {revolutions: 1, step: 1 us, samples: 360}\n";

// Where a pin is.
static Vec2 place_of(size_t pin)
{
    return vec2_rotate(2.0 * M_PI * (double)pin / PINS, (Vec2){RADIUS, 0.0});
}

static Vec2 hole_of(const Pattern *pattern, size_t pin)
{
    return vec2_add(place_of(pin), pin == 0 ? pattern->off : (Vec2){0.0, 0.0});
}

static Scenario made(const Pattern *pattern, const char *const *overrides, size_t count)
{
    Text text;
    text_init(&text);
    text_append(&text, "%s", pattern->head);
    for (size_t i = 0; i < PINS; i++) {
        const Vec2 hole = hole_of(pattern, i);
        const Vec2 pin = place_of(i);
        text_append(
            &text,
            "  pin-%zu: {between: [%s, plate], at-a: [%.17g m, %.17g m],\n"
            "          at-b: [%.17g m, %.17g m], hole: 10.04 mm, pin: 10 mm, width: 8 mm}\n",
            i + 1, pattern->body_a, hole.x, hole.y, pin.x, pin.y);
    }
    if (pattern->torque != 0.0) {
        text_append(&text, "loads:\n  twist: {body: plate, torque: %.17g N m}\n", pattern->torque);
    }
    if (pattern->force.x != 0.0 || pattern->force.y != 0.0) {
        text_append(&text, "  push: {body: plate, force: %.17g N, direction: %.17g rad}\n",
                    vec2_length(pattern->force), atan2(pattern->force.y, pattern->force.x));
    }
    text_append(&text, "%s", pattern->tail);
    Scenario scenario;
    Err err = {0};
    if (!casefile_load_text("memory", text.data, text.length, overrides, count, &scenario, &err)) {
        fail_msg("%s", err.text);
    }
    text_finish(&text);
    return kept_instead(&scenario);
}

// Statics.

typedef struct Pose {
    double x[3]; // m, m, rad
} Pose;

static Vec2 force_of(const Pattern *pattern, const Pose *pose, size_t pin)
{
    const Vec2 at =
        vec2_add((Vec2){pose->x[0], pose->x[1]}, vec2_rotate(pose->x[2], place_of(pin)));
    const Vec2 off = vec2_sub(at, hole_of(pattern, pin));
    const double distance = vec2_length(off);
    return distance > PLAY ? vec2_scale(-STIFFNESS * (distance - PLAY) / distance, off)
                           : (Vec2){0.0, 0.0};
}

// What is missing of balance: N, N, and N.
static void missing(const Pattern *pattern, const Pose *pose, double left[3])
{
    left[0] = pattern->force.x;
    left[1] = pattern->force.y;
    left[2] = pattern->torque / RADIUS;
    for (size_t i = 0; i < PINS; i++) {
        const Vec2 force = force_of(pattern, pose, i);
        left[0] += force.x;
        left[1] += force.y;
        left[2] += vec2_cross(vec2_rotate(pose->x[2], place_of(i)), force) / RADIUS;
    }
}

// Solves the 3 x 3 system by Cramer's rule.
static void solve(double m[3][3], const double b[3], double x[3])
{
    const double det = m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
                       m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
                       m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
    for (int k = 0; k < 3; k++) {
        double of[3][3];
        memcpy(of, m, sizeof of);
        for (int i = 0; i < 3; i++) {
            of[i][k] = b[i];
        }
        x[k] = (of[0][0] * (of[1][1] * of[2][2] - of[1][2] * of[2][1]) -
                of[0][1] * (of[1][0] * of[2][2] - of[1][2] * of[2][0]) +
                of[0][2] * (of[1][0] * of[2][1] - of[1][1] * of[2][0])) /
               det;
    }
}

// The plate at rest, by Newton's method with differences, from where all pins are pressed.
static Pose at_rest(const Pattern *pattern)
{
    Pose pose = {{0.0, 0.0, (PLAY + OFF) / RADIUS * copysign(1.0, pattern->torque)}};
    for (int i = 0; i < 60; i++) {
        double left[3];
        double slopes[3][3];
        double step[3];
        missing(pattern, &pose, left);
        for (int k = 0; k < 3; k++) {
            const double by = k < 2 ? 1e-11 : 1e-11 / RADIUS;
            Pose beside = pose;
            double changed[3];
            beside.x[k] += by;
            missing(pattern, &beside, changed);
            for (int row = 0; row < 3; row++) {
                slopes[row][k] = (changed[row] - left[row]) / by;
            }
        }
        solve(slopes, left, step);
        for (int k = 0; k < 3; k++) {
            pose.x[k] -= (i < 20 ? 0.5 : 1.0) * step[k];
        }
    }
    double left[3];
    missing(pattern, &pose, left);
    assert_near(left[0], 0.0, 1e-6);
    assert_near(left[1], 0.0, 1e-6);
    assert_near(left[2], 0.0, 1e-6);
    return pose;
}

// The force on a pin when the run has come to rest, N.
static Vec2 borne(const Trajectory *run, size_t joint)
{
    return trajectory_state(run, run->sample_count - 1, joint)->force_on_b;
}

// How far a run's forces are from statics at the most, N.
static double off_statics(const Pattern *pattern, const Trajectory *run)
{
    const Pose pose = at_rest(pattern);
    double worst = 0.0;
    for (size_t i = 0; i < PINS; i++) {
        const Vec2 off = vec2_sub(borne(run, i), force_of(pattern, &pose, i));
        worst = fmax(worst, vec2_length(off));
    }
    return worst;
}

// A hole off along the circle, and a torque under which all pins press.
static const Pattern TWISTED = {
    .off = {0.0, 10e-6},
    .torque = 180.0,
    .head = FREE_PLATE,
    .tail = DAMPED,
    .body_a = "ground",
};

// What a pin bears by hand, N; of a plate on a pivot of its own, or a free one.
static double by_hand(const Pattern *pattern, size_t pin, bool is_free)
{
    const double equal = pattern->torque / (PINS * RADIUS);
    const double across = equal / (PLAY + equal / STIFFNESS);
    const double moved = is_free ? STIFFNESS / (STIFFNESS + across) / 3.0 : 0.0;
    const double share =
        moved * cos(2.0 * M_PI * (double)pin / PINS) + 1.0 / 6.0 - (pin == 0 ? 1.0 : 0.0);
    return equal + STIFFNESS * OFF * share;
}

static void six_pins_share_a_torque(void **state)
{
    (void)state;
    const Scenario scenario = made(&TWISTED, NULL, 0);
    const BackendKind backends[] = {BACKEND_REFERENCE, BACKEND_ODE};
    const double equal = TWISTED.torque / (PINS * RADIUS);
    for (size_t b = 0; b < 2; b++) {
        Trajectory *run = complete_run(&scenario, backends[b]);
        // of 1500 N; what damping has left is far below
        assert_true(off_statics(&TWISTED, run) < 1e-4);
        // by hand, but for the square of s / e: some 0.02 of K s
        for (size_t i = 0; i < PINS; i++) {
            assert_near(vec2_length(borne(run, i)), by_hand(&TWISTED, i, true),
                        0.02 * STIFFNESS * OFF);
        }
        // an equal share is far off
        assert_true(fabs(vec2_length(borne(run, 0)) - equal) > 0.5 * STIFFNESS * OFF);
        trajectory_destroy(run);
    }
}

// The controls: without the error, and with the hole off to the other side, each pin bears another
// force by far more than what is asked for above.
static void the_error_of_place_is_what_differs(void **state)
{
    (void)state;
    Pattern nominal = TWISTED;
    Pattern other = TWISTED;
    nominal.off = (Vec2){0.0, 0.0};
    other.off = (Vec2){0.0, -OFF};
    const Scenario scenario = made(&TWISTED, NULL, 0);
    Trajectory *run = complete_run(&scenario, BACKEND_REFERENCE);
    assert_true(off_statics(&nominal, run) > 400.0);
    assert_true(off_statics(&other, run) > 800.0);
    trajectory_destroy(run);
    const Scenario in_place = made(&nominal, NULL, 0);
    Trajectory *equal = complete_run(&in_place, BACKEND_REFERENCE);
    assert_true(off_statics(&nominal, equal) < 1e-4);
    assert_true(off_statics(&TWISTED, equal) > 400.0);
    trajectory_destroy(equal);
}

// Some pins press, others are free, and the plate leans on those that do.
static void a_force_is_borne_by_the_pins_that_touch(void **state)
{
    (void)state;
    Pattern pushed = TWISTED;
    pushed.off = (Vec2){-6e-6, 8e-6};
    pushed.torque = 60.0;
    pushed.force = (Vec2){1500.0, 2000.0};
    const char *const LONGER[] = {"run.duration=60 ms", "run.step=10 us"};
    const Scenario scenario = made(&pushed, LONGER, 2);
    Trajectory *run = complete_run(&scenario, BACKEND_REFERENCE);
    assert_true(off_statics(&pushed, run) < 1e-4);
    size_t touching = 0;
    for (size_t i = 0; i < PINS; i++) {
        touching += vec2_length(borne(run, i)) > 0.0 ? 1 : 0;
    }
    assert_true(touching >= 2 && touching < PINS);
    trajectory_destroy(run);
    Pattern without = pushed;
    without.off = (Vec2){0.0, 0.0};
    const Scenario in_place = made(&without, LONGER, 2);
    Trajectory *other = complete_run(&in_place, BACKEND_REFERENCE);
    assert_true(off_statics(&pushed, other) > 100.0);
    trajectory_destroy(other);
}

// Largest difference of the plate's angular velocity between two runs, rad/s.
static double apart(const Trajectory *a, const Trajectory *b)
{
    double largest = 0.0;
    for (size_t k = 0; k < a->sample_count; k++) {
        largest = fmax(largest,
                       fabs(trajectory_motion(a, k, 0)->omega - trajectory_motion(b, k, 0)->omega));
    }
    return largest;
}

// In ODE the error falls with the square of the step, or faster.
static void solvers_agree_on_the_way_there(void **state)
{
    (void)state;
    const Scenario scenario = made(&TWISTED, NULL, 0);
    Trajectory *truth = complete_run(&scenario, BACKEND_REFERENCE);
    double errors[2];
    for (int i = 0; i < 2; i++) {
        Scenario stepped = scenario;
        stepped.run.step = i == 0 ? 20e-6 : 5e-6;
        Trajectory *run = complete_run(&stepped, BACKEND_ODE);
        errors[i] = apart(run, truth);
        trajectory_destroy(run);
    }
    // of some 40 rad/s
    assert_true(errors[1] < 1e-6);
    assert_true(errors[1] < errors[0] / 16.0);
    trajectory_destroy(truth);
}

// In space the pattern falls as in the plane; with its centre beside the pins' middle it tilts, in
// ODE as in the reference.
static void patterns_move_in_space(void **state)
{
    (void)state;
    Pattern fallen = TWISTED;
    fallen.torque = 0.0;
    const char *const PLANE[] = {"gravity=[300 m/s^2, -500 m/s^2]"};
    const char *const SPACE[] = {PLANE[0], "space=spatial"};
    const char *const TILTED[] = {PLANE[0], "space=spatial", "bodies.plate.offset=2 mm"};
    const Scenario planar = made(&fallen, PLANE, 1);
    const Scenario spatial = made(&fallen, SPACE, 2);
    const Scenario tilted = made(&fallen, TILTED, 3);
    Trajectory *truth = complete_run(&planar, BACKEND_REFERENCE);
    Trajectory *in_space = complete_run(&spatial, BACKEND_REFERENCE);
    Trajectory *tilts = complete_run(&tilted, BACKEND_REFERENCE);
    Trajectory *in_ode = complete_run(&tilted, BACKEND_ODE);
    // of some 3 rad/s
    assert_true(apart(in_space, truth) < 1e-7);
    assert_true(apart(tilts, truth) > 0.1);
    assert_true(apart(in_ode, tilts) < 1e-6);
    trajectory_destroy(in_ode);
    trajectory_destroy(tilts);
    trajectory_destroy(in_space);
    trajectory_destroy(truth);
}

// A coupling of two discs on pivots of their own, driven, braked.
static const Pattern COUPLED = {
    .off = {0.0, 10e-6},
    .torque = 180.0,
    .head = COUPLING,
    .tail = DRIVEN,
    .body_a = "disc",
};

enum { FIRST_PIN = 2 }; // number of the first of its pins

static void a_settled_coupling_has_the_static_forces(void **state)
{
    (void)state;
    const char *const STARTS[] = {"run.settle-starts=6", "run.settle-budget=100 s"};
    Scenario scenario = made(&COUPLED, STARTS, 2);
    assert_int_equal(scenario.run.start, START_SETTLED);
    settle_scenario(&scenario, (RunWatch){NULL, NULL});
    kept_settled(&scenario);
    const SettledStart *settled = &scenario.settled;
    assert_int_equal(settled->motion_count, 1);
    // every start was drawn, and came to it
    assert_int_equal(settled->tried, 6);
    assert_int_equal(settled->motions[0].starts, 6);
    for (size_t i = 0; i < PINS; i++) {
        assert_near(settled->motions[0].joints[FIRST_PIN + i].force.headline,
                    by_hand(&COUPLED, i, false), 0.005 * STIFFNESS * OFF);
    }
}

// How far a pin is from its hole's centre, over its play.
static double share_of_play(const Linkage *linkage, int joint)
{
    Motion motions[KINEMATICS_BODY_MAX];
    linkage_start(linkage, motions);
    return vec2_length(linkage_joint_gap(linkage, motions, joint).position) / PLAY;
}

// The mean of the square of that of the first pin over what the play allows, by drawing the plate's
// place and angle from a box and keeping those with every pin in its hole.
static double mean_square(const Pattern *pattern, size_t pins)
{
    uint64_t seed = 7;
    double sum = 0.0;
    size_t kept = 0;
    while (kept < 20000) {
        const Vec2 at = {2.0 * PLAY * lcg_draw(&seed), 2.0 * PLAY * lcg_draw(&seed)};
        const double angle = 2.0 * PLAY / RADIUS * lcg_draw(&seed);
        bool is_in = true;
        for (size_t i = 0; i < pins && is_in; i++) {
            const Vec2 off =
                vec2_sub(vec2_add(at, vec2_rotate(angle, place_of(i))), hole_of(pattern, i));
            is_in = vec2_length(off) <= PLAY;
        }
        if (is_in) {
            const Vec2 off =
                vec2_sub(vec2_add(at, vec2_rotate(angle, place_of(0))), hole_of(pattern, 0));
            sum += vec2_dot(off, off) / (PLAY * PLAY);
            kept++;
        }
    }
    return sum / (double)kept;
}

// Every pin is in its hole, no two starts are alike, and together they are where positions that are
// drawn and kept or thrown away are.
static void pins_are_drawn_together(void **state)
{
    (void)state;
    const size_t starts = sample_size(600);
    Pattern pattern = TWISTED;
    pattern.body_a = "disc";
    pattern.head = "bodies:\n"
                   "  plate: {mass: 0.5 kg, inertia: 400 kg mm^2, at: [0 mm, 0 mm]}\n"
                   "  disc:  {mass: 0.5 kg, inertia: 400 kg mm^2, at: [0 mm, 0 mm]}\n"
                   "joints:\n"
                   "  shaft: {between: [ground, disc], at: [0 mm, 0 mm]}\n";
    pattern.tail = DRIVEN;
    const Scenario scenario = made(&pattern, NULL, 0);
    const SettleReach reach[1 + PINS] = {{.gap = 0.0}};
    double sum = 0.0;
    double before = -1.0;
    for (size_t k = 0; k < starts; k++) {
        Scenario drawn = scenario_copy(&scenario);
        assert_true(settle_draw(&drawn, reach, k, starts));
        for (int i = 0; i < PINS; i++) {
            assert_true(share_of_play(&drawn.linkage, 1 + i) <= 1.0);
        }
        const double share = share_of_play(&drawn.linkage, 1);
        assert_true(share != before);
        before = share;
        sum += share * share;
        scenario_free(&drawn);
    }
    // the square of a share has a deviation of some 0.25: four of the mean's
    const double mean = sum / (double)starts;
    const double allowed = 4.0 * 0.25 / sqrt((double)starts);
    assert_near(mean, mean_square(&pattern, PINS), allowed);
    // the control: alone in its hole the first pin would be drawn farther out, 1/2
    assert_near(mean_square(&pattern, 1), 0.5, 0.02);
    assert_true(fabs(mean - mean_square(&pattern, 1)) > allowed);
}

// With pivots of both discs one freedom is left, and all of it is drawn: from wall to wall.
static void pins_that_close_loops_are_drawn_together(void **state)
{
    (void)state;
    enum { STARTS = 60 };
    const Scenario scenario = made(&COUPLED, NULL, 0);
    const SettleReach reach[2 + PINS] = {{.gap = 0.0}};
    double low = INFINITY;
    double high = -INFINITY;
    for (size_t k = 0; k < STARTS; k++) {
        Scenario drawn = scenario_copy(&scenario);
        assert_true(settle_draw(&drawn, reach, k, STARTS));
        Motion motions[2];
        linkage_start(&drawn.linkage, motions);
        for (int i = 0; i < FIRST_PIN; i++) {
            const Vec2 opening = linkage_joint_gap(&drawn.linkage, motions, i).position;
            assert_true(vec2_length(opening) < 1e-14);
        }
        for (int i = 0; i < PINS; i++) {
            assert_true(share_of_play(&drawn.linkage, FIRST_PIN + i) <= 1.0);
        }
        low = fmin(low, motions[0].angle - motions[1].angle);
        high = fmax(high, motions[0].angle - motions[1].angle);
        scenario_free(&drawn);
    }
    // the first pin begins at -s, so that it goes from s - c to c with the others; they from -c
    const double span = (2.0 * PLAY - OFF) / RADIUS;
    assert_true(high - low > 0.85 * span);
    assert_true(high - low <= span);
    assert_true(high <= PLAY / RADIUS && low >= (OFF - PLAY) / RADIUS);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(six_pins_share_a_torque),
        cmocka_unit_test(the_error_of_place_is_what_differs),
        cmocka_unit_test(a_force_is_borne_by_the_pins_that_touch),
        cmocka_unit_test(solvers_agree_on_the_way_there),
        cmocka_unit_test(patterns_move_in_space),
        cmocka_unit_test(a_settled_coupling_has_the_static_forces),
        cmocka_unit_test(pins_are_drawn_together),
        cmocka_unit_test(pins_that_close_loops_are_drawn_together),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
