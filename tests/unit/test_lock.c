// Does the walk find where a driven linkage locks, and does it pass what can be passed?
#include "close.h"

#include "mechanism.h"

#include "base/lcg.h"
#include "kept.h"
#include "model/kinematics.h"
#include "model/lock.h"
#include "sample.h"

#include <stdio.h>
#include <string.h>

enum { CRANK, COUPLER, FOLLOWER };

static const double DEGREE = M_PI / 180.0;

static void set_body(Linkage *linkage, int body, Vec2 first, Vec2 second)
{
    const Vec2 along = vec2_sub(second, first);
    Body *link = &linkage->bodies[body];
    snprintf(link->name, sizeof link->name, "body-%d", body);
    link->mass = 0.1;
    link->inertia = 1e-4;
    link->start = (Motion){.position = vec2_scale(0.5, vec2_add(first, second)),
                           .angle = atan2(along.y, along.x)};
    linkage->body_count =
        (size_t)body + 1 > linkage->body_count ? (size_t)body + 1 : linkage->body_count;
}

static Vec2 to_body(const Linkage *linkage, int body, Vec2 place)
{
    const Motion *start = &linkage->bodies[body < 0 ? 0 : body].start;
    return body < 0 ? place : vec2_rotate(-start->angle, vec2_sub(place, start->position));
}

static void join(Linkage *linkage, int a, int b, Vec2 place)
{
    Joint *joint = &linkage->joints[linkage->joint_count];
    *joint = (Joint){.body_a = a, .body_b = b};
    joint->anchor_a = to_body(linkage, a, place);
    joint->anchor_b = to_body(linkage, b, place);
    snprintf(joint->name, sizeof joint->name, "joint-%zu", linkage->joint_count++);
}

// Where the circles about two points meet, to the left of the line between them or to the right.
static Vec2 meet(Vec2 p, double b, Vec2 q, double c, double side)
{
    const Vec2 line = vec2_sub(q, p);
    const double d = vec2_length(line);
    const double along = (d * d + b * b - c * c) / (2.0 * d);
    const double height = side * sqrt(fmax(0.0, b * b - along * along));
    const Vec2 x = vec2_scale(1.0 / d, line);
    return vec2_add(p, vec2_add(vec2_scale(along, x), vec2_scale(height, vec2_perp(x))));
}

// A four-bar as bodies from ground, crank, coupler and follower, m.
static Linkage four_bar(const double lengths[4], double start, double side, double speed)
{
    Linkage linkage = kept_linkage();
    const Vec2 pivot = {0.3, -0.2}; // where the crank's pivot lies does not matter
    const Vec2 far = vec2_add(pivot, (Vec2){lengths[0], 0.0});
    const Vec2 pin = vec2_add(pivot, vec2_rotate(start, (Vec2){lengths[1], 0.0}));
    const Vec2 end = meet(pin, lengths[2], far, lengths[3], side);
    set_body(&linkage, CRANK, pivot, pin);
    set_body(&linkage, COUPLER, pin, end);
    set_body(&linkage, FOLLOWER, far, end);
    join(&linkage, LINKAGE_GROUND, CRANK, pivot);
    join(&linkage, CRANK, COUPLER, pin);
    join(&linkage, COUPLER, FOLLOWER, end);
    join(&linkage, LINKAGE_GROUND, FOLLOWER, far);
    // atan2 has put the angle into one turn
    const double angle = linkage.bodies[CRANK].start.angle;
    linkage.driver = (Driver){.is_present = true, .joint = 0, .speed = speed, .start = angle};
    return linkage;
}

// How far the crank can turn from an angle until |b - c| <= diagonal <= b + c fails; infinite where
// it never does.
static double free_turn(const double lengths[4], double start, double direction)
{
    const double g = lengths[0];
    const double a = lengths[1];
    const double longest = lengths[2] + lengths[3];
    const double shortest = fabs(lengths[2] - lengths[3]);
    const double cosines[2] = {(a * a + g * g - longest * longest) / (2.0 * a * g),
                               (a * a + g * g - shortest * shortest) / (2.0 * a * g)};
    double least = INFINITY;
    for (int i = 0; i < 4; i++) {
        if (fabs(cosines[i / 2]) < 1.0) {
            const double angle = (i % 2 == 0 ? 1.0 : -1.0) * acos(cosines[i / 2]);
            const double turn = fmod(direction * (angle - start) + 8.0 * M_PI, 2.0 * M_PI);
            least = fmin(least, turn);
        }
    }
    return least;
}

// The walk knows nothing of circles; the closed form knows nothing else.
static void four_bars_lock_where_the_closed_form_says(void **state)
{
    (void)state;
    uint64_t draw = 7;
    int locked = 0;
    int turning = 0;
    for (size_t i = 0; i < sample_size(400); i++) {
        double lengths[4];
        for (int k = 0; k < 4; k++) {
            lengths[k] = 0.25 + 0.2 * lcg_draw(&draw);
        }
        const double start = M_PI * lcg_draw(&draw);
        const double direction = i % 2 == 0 ? 1.0 : -1.0;
        const double diagonal = sqrt(lengths[0] * lengths[0] + lengths[1] * lengths[1] -
                                     2.0 * lengths[0] * lengths[1] * cos(start));
        if (diagonal > 0.98 * (lengths[2] + lengths[3]) ||
            diagonal < 1.02 * fabs(lengths[2] - lengths[3])) {
            continue; // does not close there, or only just
        }
        const Linkage linkage = four_bar(lengths, start, i % 3 == 0 ? -1.0 : 1.0, 30.0 * direction);
        const double expected = free_turn(lengths, start, direction);
        const Lock lock = lock_find(&linkage, LOCK_ALL_AS_IDEAL, 2.0 * M_PI);
        if (isinf(expected)) {
            assert_int_equal(lock.state, LOCK_NONE);
            assert_false(lock.has_crossing);
            turning++;
        } else {
            assert_int_equal(lock.state, LOCK_FOUND);
            const double turn = direction * (lock.crank_angle - linkage.driver.start);
            assert_near(turn, expected, 1e-6 * DEGREE);
            // the control: a range that ends before the lock does not hold it
            const double before = expected - 1e-3;
            assert_int_equal(lock_find(&linkage, LOCK_ALL_AS_IDEAL, before).state,
                             before > 0.0 ? LOCK_NONE : LOCK_FOUND);
            locked++;
        }
    }
    assert_true((size_t)locked > sample_size(100) && (size_t)turning > sample_size(30));
}

static void parallelogram_and_kite_pass_their_change_points(void **state)
{
    (void)state;
    const double equal[4] = {0.2, 0.1, 0.2, 0.1};
    const double kite[4] = {0.1, 0.1, 0.2, 0.2};
    const Linkage parallelogram = four_bar(equal, 90.0 * DEGREE, 1.0, 30.0);
    const Linkage deltoid = four_bar(kite, 90.0 * DEGREE, 1.0, -30.0);
    assert_int_equal(lock_find(&parallelogram, LOCK_ALL_AS_IDEAL, 4.0 * M_PI).state, LOCK_NONE);
    assert_int_equal(lock_find(&deltoid, LOCK_ALL_AS_IDEAL, 4.0 * M_PI).state, LOCK_NONE);
    // the links of the one lie in line at 180 deg, those of the other at 0
    const Lock first = lock_find(&parallelogram, LOCK_ALL_AS_IDEAL, 4.0 * M_PI);
    const Lock second = lock_find(&deltoid, LOCK_ALL_AS_IDEAL, 4.0 * M_PI);
    assert_true(first.has_crossing && second.has_crossing);
    assert_near(first.crossing, 180.0 * DEGREE, 1e-5);
    assert_near(second.crossing, 0.0, 1e-5);
    // the control: nothing crosses before
    assert_false(lock_find(&parallelogram, LOCK_ALL_AS_IDEAL, 80.0 * DEGREE).has_crossing);
    // a bar too much, parallel to the others, changes nothing
    const Scenario three = mechanism_parallelogram();
    assert_int_equal(lock_find(&three.linkage, LOCK_ALL_AS_IDEAL, 2.0 * M_PI).state, LOCK_NONE);
}

// A parallelogram behind a parallelogram: both change at 180 deg, and the determinant of all rows
// does not change its sign.
static void change_points_that_coincide_are_found(void **state)
{
    (void)state;
    const double equal[4] = {0.2, 0.1, 0.2, 0.1};
    Linkage row = four_bar(equal, 90.0 * DEGREE, 1.0, 30.0);
    const Vec2 far = {0.3 + 0.4, -0.2};
    const Vec2 first = {0.3 + 0.2, -0.2 + 0.1};
    const Vec2 second = {0.3 + 0.4, -0.2 + 0.1};
    set_body(&row, 3, first, second);
    set_body(&row, 4, far, second);
    join(&row, FOLLOWER, 3, first);
    join(&row, 3, 4, second);
    join(&row, LINKAGE_GROUND, 4, far);
    const Lock lock = lock_find(&row, LOCK_ALL_AS_IDEAL, 2.0 * M_PI);
    assert_true(lock.has_crossing);
    assert_near(lock.crossing, 180.0 * DEGREE, 1e-5);
    assert_false(lock_find(&row, LOCK_ALL_AS_IDEAL, 80.0 * DEGREE).has_crossing);
}

// The control of the test above: a hair's breadth off, and it locks next to the change point.
static void nearly_a_parallelogram_locks_next_to_its_change_point(void **state)
{
    (void)state;
    for (double off = 1e-3; off > 1e-8; off *= 0.1) {
        // crank and follower longer than the others leave room for: a gap that opens at 0 deg
        const double lengths[4] = {0.2, 0.1, 0.2 - off, 0.1};
        const Linkage linkage = four_bar(lengths, 90.0 * DEGREE, 1.0, -30.0);
        const Lock lock = lock_find(&linkage, LOCK_ALL_AS_IDEAL, 2.0 * M_PI);
        const double expected = free_turn(lengths, 90.0 * DEGREE, -1.0);
        assert_int_equal(lock.state, LOCK_FOUND);
        assert_near(90.0 * DEGREE - lock.crank_angle, expected, 1e-6 * DEGREE);
    }
}

// A crank-rocker whose follower drives two more bars: they lock when they lie on one line. Where
// that is follows from the circles alone.
static Linkage six_bar(double reach, double start)
{
    const double lengths[4] = {0.254, 0.108, 0.2794, 0.2705};
    Linkage linkage = four_bar(lengths, start, 1.0, 30.0);
    const Motion *follower = &linkage.bodies[FOLLOWER].start;
    const Vec2 end =
        vec2_add(follower->position, vec2_rotate(follower->angle, (Vec2){0.5 * lengths[3], 0.0}));
    const Vec2 pivot = vec2_add((Vec2){0.3, -0.2}, (Vec2){0.5, 0.1});
    const Vec2 knee = meet(end, 0.5 * reach, pivot, 0.5 * reach, 1.0);
    set_body(&linkage, 3, end, knee);
    set_body(&linkage, 4, pivot, knee);
    join(&linkage, FOLLOWER, 3, end);
    join(&linkage, 3, 4, knee);
    join(&linkage, 4, LINKAGE_GROUND, pivot);
    return linkage;
}

// How much longer than `reach` the way from follower pin to the last pivot is at a crank angle.
static double excess(double crank, double reach)
{
    const Vec2 pin = vec2_rotate(crank, (Vec2){0.108, 0.0});
    const Vec2 end = meet(pin, 0.2794, (Vec2){0.254, 0.0}, 0.2705, 1.0);
    return vec2_length(vec2_sub((Vec2){0.5, 0.1}, end)) - reach;
}

static void a_six_bar_locks_when_its_last_two_bars_lie_on_one_line(void **state)
{
    (void)state;
    for (double reach = 0.36; reach < 0.46; reach += 0.01) {
        double angle = 0.0;
        while (excess(angle, reach) < 0.0) {
            angle += 0.001;
            assert_true(angle < 2.0 * M_PI);
        }
        double low = angle - 0.001;
        for (int i = 0; i < 60; i++) {
            const double middle = 0.5 * (low + angle);
            *(excess(middle, reach) < 0.0 ? &low : &angle) = middle;
        }
        const Linkage linkage = six_bar(reach, 0.0);
        const Lock lock = lock_find(&linkage, LOCK_ALL_AS_IDEAL, 2.0 * M_PI);
        assert_int_equal(lock.state, LOCK_FOUND);
        assert_near(lock.crank_angle, angle, 1e-6 * DEGREE);
    }
    // long enough, it turns on
    const Linkage linkage = six_bar(0.6, 0.0);
    assert_int_equal(lock_find(&linkage, LOCK_ALL_AS_IDEAL, 4.0 * M_PI).state, LOCK_NONE);
}

static void what_the_drive_does_not_determine_is_left_out(void **state)
{
    (void)state;
    const double lengths[4] = {0.4, 0.26, 0.2794, 0.2705};
    Linkage linkage = four_bar(lengths, 30.0 * DEGREE, 1.0, 30.0);
    const double expected = lock_find(&linkage, LOCK_ALL_AS_IDEAL, 2.0 * M_PI).crank_angle;
    // a pendulum on the coupler swings as it likes, and the rest locks where it did
    const Motion *coupler = &linkage.bodies[COUPLER].start;
    set_body(&linkage, 3, coupler->position, vec2_sub(coupler->position, (Vec2){0.0, 0.1}));
    join(&linkage, COUPLER, 3, coupler->position);
    const Lock lock = lock_find(&linkage, LOCK_ALL_AS_IDEAL, 2.0 * M_PI);
    assert_int_equal(lock.state, LOCK_FOUND);
    assert_near(lock.crank_angle, expected, 1e-6 * DEGREE);
    // with play in the loop its ideal joints alone do not lock, and without it they do
    assert_int_equal(lock_find(&linkage, LOCK_IDEAL_ONLY, 2.0 * M_PI).state, LOCK_FOUND);
    linkage.joints[1].kind = JOINT_CLEARANCE;
    linkage.joints[1].clearance = (Clearance){5.02e-3, 5e-3, 1e-2, {2e-5, 0.0}, false};
    assert_int_equal(lock_find(&linkage, LOCK_IDEAL_ONLY, 2.0 * M_PI).state, LOCK_UNKNOWN);
    assert_int_equal(lock_find(&linkage, LOCK_ALL_AS_IDEAL, 2.0 * M_PI).state, LOCK_FOUND);
    // without a driver nothing turns
    linkage.driver.is_present = false;
    assert_int_equal(lock_find(&linkage, LOCK_ALL_AS_IDEAL, 2.0 * M_PI).state, LOCK_UNKNOWN);
}

static void a_failure_near_the_lock_is_explained_and_one_before_it_is_not(void **state)
{
    (void)state;
    const double lengths[4] = {0.4, 0.26, 0.2794, 0.2705};
    Scenario scenario = kept_default();
    scenario.linkage = four_bar(lengths, 30.0 * DEGREE, 1.0, 30.0);
    const double at_s = free_turn(lengths, 30.0 * DEGREE, 1.0) / 30.0;
    Err err = {ERR_SOLVER, "the pin is too deep"};
    lock_explain(&scenario, 0.5 * at_s, &err);
    assert_string_equal(err.text, "the pin is too deep");
    lock_explain(&scenario, at_s, &err);
    assert_non_null(strstr(err.text, "the pin is too deep; with ideal joints the mechanism locks "
                                     "at a crank angle of 111.074 deg: "));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(four_bars_lock_where_the_closed_form_says),
        cmocka_unit_test(parallelogram_and_kite_pass_their_change_points),
        cmocka_unit_test(change_points_that_coincide_are_found),
        cmocka_unit_test(nearly_a_parallelogram_locks_next_to_its_change_point),
        cmocka_unit_test(a_six_bar_locks_when_its_last_two_bars_lie_on_one_line),
        cmocka_unit_test(what_the_drive_does_not_determine_is_left_out),
        cmocka_unit_test(a_failure_near_the_lock_is_explained_and_one_before_it_is_not),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
