// Where does a pin in space touch its hole, and how fast does it go deeper?
#include "contact/pin_space.h"

#include "base/lcg.h"
#include "close.h"
#include "kernel/pin_hole.h"
#include "mechanism.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double RADIAL = 20e-6;
static const double WIDTH = 12e-3;
static const double AXIAL = 50e-6;

// A pin in a hole of the ground whose axis is z, both about the origin.
static Scenario single_pin(void)
{
    Scenario scenario = mechanism_pin(0.1, RADIAL);
    scenario.linkage.is_spatial = true;
    scenario.contact.stiffness = 1e8;
    scenario.contact.exponent = 1.5;
    Joint *joint = &scenario.linkage.joints[0];
    joint->clearance.width = WIDTH;
    joint->space.axis = (Vec3){0.0, 0.0, 1.0};
    joint->space.axial_clearance = AXIAL;
    return scenario;
}

static size_t places_of(const Scenario *scenario, PinSpace places[PIN_SPACE_PLACES])
{
    Err err = {0};
    size_t count = 0;
    PinSpace *listed = pin_space_list(scenario, &count, &err);
    if (listed == NULL) {
        fail_msg("%s", err.text);
    }
    assert_true(count <= PIN_SPACE_PLACES);
    memcpy(places, listed, count * sizeof *places);
    free(listed);
    return count;
}

static void a_pin_that_stands_straight_is_the_planes_twice(void **state)
{
    (void)state;
    const Scenario scenario = single_pin();
    PinSpace places[PIN_SPACE_PLACES];
    assert_int_equal(places_of(&scenario, places), 3);
    SpaceMotion motion;
    space_start(&scenario.linkage, &motion);
    motion.position = (Vec3){15e-6, -21e-6, 7e-6};
    motion.velocity = (Vec3){0.3, -0.4, 0.05};
    motion.omega = (Vec3){0.0, 0.0, 100.0};
    const PinHole plane =
        pin_hole_pose((Vec2){0.0, 0.0}, (Vec2){15e-6, -21e-6}, (Vec2){0.3, -0.4}, RADIAL);
    for (int i = 0; i < PIN_SPACE_ENDS; i++) {
        const PinSpacePose pose = pin_space_pose(&places[i], &motion);
        assert_near(pose.gap, plane.gap, 1e-18); // rounding of the width
        assert_near(pose.normal.x, plane.normal.x, 1e-15);
        assert_near(pose.normal.y, plane.normal.y, 1e-15);
        assert_near(pose.approach_speed, plane.approach_speed, 1e-15);
        // half of the plane's force each
        ForceLaw whole = force_law_power(1e8, 1.5);
        assert_near(2.0 * force_law_elastic(&places[i].law, -pose.gap),
                    force_law_elastic(&whole, -plane.gap), 1e-12);
    }
    const PinSpacePose collar = pin_space_pose(&places[PIN_SPACE_COLLAR], &motion);
    assert_near(collar.gap, AXIAL - 7e-6, 1e-20);
    assert_near(collar.normal.z, -1.0, 0.0);
    assert_near(collar.approach_speed, 0.05, 1e-17);
}

// With the pin's middle in the hole's, both ends touch where sin(phi) = 2 c / w.
static void a_pin_tilts_to_twice_the_play_over_the_width(void **state)
{
    (void)state;
    const Scenario scenario = single_pin();
    PinSpace places[PIN_SPACE_PLACES];
    places_of(&scenario, places);
    const double limit = asin(2.0 * RADIAL / WIDTH);
    for (int k = 0; k < 8; k++) {
        const double along = 0.25 * M_PI * k;
        SpaceMotion motion;
        space_start(&scenario.linkage, &motion);
        motion.turn = quat_of_turn((Vec3){limit * cos(along), limit * sin(along), 0.0});
        const PinSpacePose back = pin_space_pose(&places[0], &motion);
        const PinSpacePose front = pin_space_pose(&places[1], &motion);
        assert_near(back.gap, 0.0, 1e-18);
        assert_near(front.gap, 0.0, 1e-18);
        // on opposite sides
        assert_near(vec3_dot(back.normal, front.normal), -1.0, 1e-12);
    }
    // as the field writes it, tan(phi) = 2 c / w, to half the square of the angle
    assert_near(tan(limit) / (2.0 * RADIAL / WIDTH), 1.0 + 0.5 * limit * limit, 1e-10);
}

static SpaceMotion moved_by(SpaceMotion motion, double step)
{
    motion.position = vec3_add(motion.position, vec3_scale(step, motion.velocity));
    motion.turn = quat_product(quat_of_turn(vec3_scale(step, motion.omega)), motion.turn);
    return motion;
}

// Two bodies that tumble: the approach speed is the rate of the penetration, and the power of the
// forces on both bodies is minus the force times that rate, so that no energy comes from geometry.
static void the_approach_speed_is_the_rate_of_the_depth_and_the_power_goes_with_it(void **state)
{
    (void)state;
    Scenario scenario = single_pin();
    Linkage *linkage = &scenario.linkage;
    linkage->bodies[1] = linkage->bodies[0];
    snprintf(linkage->bodies[1].name, LINKAGE_NAME_SIZE, "holder");
    linkage->body_count = 2;
    linkage->joints[0].body_a = 1;
    linkage->joints[0].space.axis = (Vec3){0.48, -0.6, 0.64};
    PinSpace places[PIN_SPACE_PLACES];
    const size_t count = places_of(&scenario, places);
    uint64_t seed = lcg_stirred(7);
    for (int i = 0; i < 200; i++) {
        SpaceMotion motions[2];
        space_start(linkage, motions);
        for (int body = 0; body < 2; body++) {
            SpaceMotion *motion = &motions[body];
            motion->position =
                (Vec3){3e-5 * lcg_draw(&seed), 3e-5 * lcg_draw(&seed), 3e-5 * lcg_draw(&seed)};
            motion->turn = quat_of_turn((Vec3){3e-3 * lcg_draw(&seed), 3e-3 * lcg_draw(&seed),
                                               3.0 * (double)body * lcg_draw(&seed)});
            motion->velocity = (Vec3){lcg_draw(&seed), lcg_draw(&seed), lcg_draw(&seed)};
            motion->omega =
                (Vec3){90.0 * lcg_draw(&seed), 90.0 * lcg_draw(&seed), 90.0 * lcg_draw(&seed)};
        }
        // one frame turns much: the pin's body with it
        motions[0].turn = quat_unit(quat_product(motions[0].turn, motions[1].turn));
        for (size_t place = 0; place < count; place++) {
            const PinSpacePose pose = pin_space_pose(&places[place], motions);
            const double step = 1e-9;
            const SpaceMotion ahead[] = {moved_by(motions[0], step), moved_by(motions[1], step)};
            const SpaceMotion behind[] = {moved_by(motions[0], -step), moved_by(motions[1], -step)};
            const double rate = (pin_space_pose(&places[place], behind).gap -
                                 pin_space_pose(&places[place], ahead).gap) /
                                (2.0 * step);
            assert_near(rate, pose.approach_speed, 1e-5 * (1.0 + fabs(rate)));
            const double power = vec3_dot(pose.normal, space_velocity_at(motions, 0, pose.at_b)) -
                                 vec3_dot(pose.normal, space_velocity_at(motions, 1, pose.at_a));
            assert_near(power, -pose.approach_speed, 1e-12);
            assert_near(vec3_length(pose.normal), 1.0, 1e-14);
            // equal and opposite forces have no moment: they lie on one line
            const Vec3 apart = vec3_sub(pose.at_b, pose.at_a);
            assert_near(vec3_length(vec3_cross(apart, pose.normal)), 0.0, 1e-17);
        }
    }
}

// Every elastic law and the viscous damper: places that share a load bear it together.
static void shares_of_a_law_add_up_to_it(void **state)
{
    (void)state;
    ForceLaw laws[] = {force_law_power(6.6e10, 1.5), force_law_logarithmic(3e-12, 18.0)};
    for (int i = 0; i < 2; i++) {
        laws[i].viscous = 40.0;
        laws[i].hysteresis = 0.7;
        const ForceLaw third = force_law_share(&laws[i], 1.0 / 3.0);
        for (double depth = 1e-9; depth < 2e-5; depth *= 3.0) {
            const double whole = force_law_force(&laws[i], depth, 0.03, 0.2);
            assert_near(3.0 * force_law_force(&third, depth, 0.03, 0.2), whole, 1e-12 * whole);
            const double energy = force_law_energy(&laws[i], depth);
            assert_near(3.0 * force_law_energy(&third, depth), energy, 1e-12 * energy);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_pin_that_stands_straight_is_the_planes_twice),
        cmocka_unit_test(a_pin_tilts_to_twice_the_play_over_the_width),
        cmocka_unit_test(the_approach_speed_is_the_rate_of_the_depth_and_the_power_goes_with_it),
        cmocka_unit_test(shares_of_a_law_add_up_to_it),
    };
    return cmocka_run_group_tests_name("pin_space", tests, NULL, NULL);
}
