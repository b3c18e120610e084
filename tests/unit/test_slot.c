// Is a pin in a slot where geometry says, and back at its wall when the motion says?
#include "close.h"
#include "kept.h"

#include "base/lcg.h"
#include "contact/touch.h"
#include "kernel/internal.h"

enum { TRIALS = 200, SEGMENT_POINTS = 20000 };

static const double CLEARANCE = 3e-4; // m
static const double PIN = 4e-3;
static const double LENGTH = 0.02;
static const double LITTLE_S = 1e-7;

// A body with a slot and a body with a pin, both anywhere and on the move.
static Linkage slotted_pair(uint64_t *seed, Motion motions[2])
{
    Linkage linkage = kept_default().linkage;
    linkage.body_count = 2;
    linkage.joint_count = 1;
    Joint *joint = &linkage.joints[0];
    *joint = (Joint){
        .kind = JOINT_STOP,
        .body_a = 0,
        .body_b = 1,
        .anchor_a = {0.03 * lcg_draw(seed), 0.03 * lcg_draw(seed)},
        .anchor_b = {0.03 * lcg_draw(seed), 0.03 * lcg_draw(seed)},
        .direction = 3.0 * lcg_draw(seed),
        .stop = {.slot = LENGTH, .radius_a = PIN + CLEARANCE, .radius_b = PIN},
    };
    for (int i = 0; i < 2; i++) {
        linkage.bodies[i] = (Body){.mass = 1.0, .inertia = 1e-3};
        motions[i] = (Motion){
            .position = {0.2 * lcg_draw(seed), 0.2 * lcg_draw(seed)},
            .angle = 3.0 * lcg_draw(seed),
            .velocity = {lcg_draw(seed), lcg_draw(seed)},
            .omega = 30.0 * lcg_draw(seed),
        };
    }
    // somewhere in the slot, or in its wall
    const Vec2 across =
        vec2_rotate(motions[0].angle + joint->direction, (Vec2){CLEARANCE * 1.2, 0.0});
    const Vec2 along = vec2_rotate(motions[0].angle + joint->direction, (Vec2){0.0, 0.5 * LENGTH});
    const Vec2 at =
        vec2_add(vec2_scale(lcg_draw(seed), across), vec2_scale(1.02 * lcg_draw(seed), along));
    const Vec2 to = vec2_add(linkage_point(motions, 0, joint->anchor_a), at);
    motions[1].position =
        vec2_add(motions[1].position, vec2_sub(to, linkage_point(motions, 1, joint->anchor_b)));
    return linkage;
}

// The distance of the pin's centre from the nearest of many points of the middle line.
static double distance_by_points(const Linkage *linkage, const Motion *motions)
{
    const Joint *joint = &linkage->joints[0];
    const Vec2 pin = linkage_point(motions, 1, joint->anchor_b);
    double least = INFINITY;
    for (int i = 0; i <= SEGMENT_POINTS; i++) {
        const double way = LENGTH * ((double)i / SEGMENT_POINTS - 0.5);
        const Vec2 local =
            vec2_add(joint->anchor_a, vec2_rotate(joint->direction, (Vec2){0.0, way}));
        least = fmin(least, vec2_length(vec2_sub(pin, linkage_point(motions, 0, local))));
    }
    return least;
}

static void moved_by(const Motion *from, double since_s, Motion *to)
{
    for (int i = 0; i < 2; i++) {
        to[i] = from[i];
        to[i].position = vec2_add(from[i].position, vec2_scale(since_s, from[i].velocity));
        to[i].angle = from[i].angle + since_s * from[i].omega;
    }
}

static void the_gap_is_to_the_nearest_wall_and_its_rate_is_the_rate(void **state)
{
    (void)state;
    uint64_t seed = 1;
    double without_turning = 0.0; // the control: how far off the rate is then
    int ends = 0;
    for (int i = 0; i < TRIALS; i++) {
        Motion motions[2];
        const Linkage linkage = slotted_pair(&seed, motions);
        Touch places[TOUCH_CORNERS];
        assert_int_equal(touch_places(&linkage, 0, places), 1);
        assert_int_equal(places[0].shape, TOUCH_SLOT);
        const TouchPose pose = touch_pose(&linkage, places, motions);
        const double distance = distance_by_points(&linkage, motions);
        // a point is half a micron from the nearest one at most
        const double apart = 0.5 * LENGTH / SEGMENT_POINTS;
        assert_true(pose.gap >= CLEARANCE - distance - 1e-15);
        assert_true(pose.gap - (CLEARANCE - distance) < 0.5 * apart * apart / distance + 1e-15);
        Motion beside[2];
        double gaps[2];
        for (int k = 0; k < 2; k++) {
            moved_by(motions, k == 0 ? -LITTLE_S : LITTLE_S, beside);
            gaps[k] = touch_pose(&linkage, places, beside).gap;
        }
        const double rate = (gaps[1] - gaps[0]) / (2.0 * LITTLE_S);
        // where the pin crosses the middle line the gap has its corner
        const bool is_smooth = distance > 2.0 * LITTLE_S * fabs(pose.approach_speed);
        assert_true(!is_smooth || fabs(rate + pose.approach_speed) < 1e-4);
        motions[0].omega = 0.0;
        const double other = touch_pose(&linkage, places, motions).approach_speed;
        without_turning = fmax(without_turning, fabs(other - pose.approach_speed));
        // the force goes through the pin's centre, at its wall
        Vec2 from_a;
        Vec2 from_b;
        touch_points(places, &pose, &from_a, &from_b);
        assert_near(vec2_cross(from_b, pose.normal), 0.0, 1e-15);
        assert_near(vec2_length(from_b), PIN + pose.gap, 1e-15);
        ends += fabs(vec2_length(pose.middle) - 0.5 * LENGTH) < 1e-12 ? 1 : 0;
    }
    assert_true(without_turning > 0.01);
    assert_true(ends > 2 && ends < TRIALS / 2);
}

// Whether the pin is at the wall again after a time, by the distance alone.
static bool is_back(const SlotFlight *flight, double t)
{
    const Vec2 at = {
        flight->position.x + t * (flight->speed.x + 0.5 * t * flight->acceleration.x),
        flight->position.y + t * (flight->speed.y + 0.5 * t * flight->acceleration.y),
    };
    const double beyond = fmax(fabs(at.y) - flight->half_length, 0.0);
    return hypot(at.x, beyond) >= flight->distance;
}

static void a_flight_ends_at_the_first_wall_that_it_comes_to(void **state)
{
    (void)state;
    enum { STEPS = 200000 };
    const double last_s = 0.02;
    uint64_t seed = 1;
    int ends = 0;
    for (int i = 0; i < 60; i++) {
        const double half = 0.002 * (1.01 + lcg_draw(&seed));
        const bool is_at_end = i % 3 == 0;
        const double angle = 3.0 * lcg_draw(&seed);
        const Vec2 wall = is_at_end ? (Vec2){CLEARANCE * cos(angle),
                                             CLEARANCE * sin(angle) + copysign(half, sin(angle))}
                                    : (Vec2){copysign(CLEARANCE, sin(angle)), half * cos(angle)};
        const Vec2 out =
            is_at_end ? (Vec2){cos(angle), sin(angle)} : (Vec2){copysign(1.0, sin(angle)), 0.0};
        // inwards, and somewhere along
        const double inward = 0.02 * (1.1 + lcg_draw(&seed));
        const double aside = 0.5 * lcg_draw(&seed);
        const SlotFlight flight = {
            .position = wall,
            .speed = vec2_add(vec2_scale(-inward, out), vec2_scale(aside, vec2_perp(out))),
            .acceleration = {30.0 * lcg_draw(&seed), 30.0 * lcg_draw(&seed)},
            .half_length = half,
            .distance = CLEARANCE,
        };
        double expected = INFINITY;
        for (int k = 1; k <= STEPS && expected == INFINITY; k++) {
            // the first steps are at the wall to rounding
            const double t = last_s * k / STEPS;
            expected = is_back(&flight, t) && !is_back(&flight, 1e-9) ? t : INFINITY;
        }
        const double found = kernel_slot_return(&flight, last_s);
        if (expected == INFINITY) {
            assert_true(found == INFINITY);
            continue;
        }
        assert_true(found <= expected && expected - found < 1.01 * last_s / STEPS);
        ends += fabs(flight.position.y +
                     found * (flight.speed.y + 0.5 * found * flight.acceleration.y)) > half
                    ? 1
                    : 0;
    }
    assert_true(ends > 5);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_gap_is_to_the_nearest_wall_and_its_rate_is_the_rate),
        cmocka_unit_test(a_flight_ends_at_the_first_wall_that_it_comes_to),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
