// How does a linkage stand in space, and which rows hold it there? Runs in the source root.
#include "base/lcg.h"
#include "kept.h"
#include "load_case.h"
#include "model/space_nearest.h"

#include <string.h>

static const char PAPER[] = "cases/paper/impact-k66.yaml";
enum { BODIES = 8 }; // more than any of them has

static const char BENNETT[] = "cases/space/bennett.yaml";

static double draw(uint64_t *seed)
{
    return lcg_draw(seed);
}

static Quat drawn_turn(uint64_t *seed)
{
    const Vec3 turn = {3.0 * draw(seed), 3.0 * draw(seed), 3.0 * draw(seed)};
    return quat_of_turn(turn);
}

static void rotations_keep_lengths_and_go_back(void **state)
{
    (void)state;
    uint64_t seed = lcg_stirred(1);
    for (int i = 0; i < 100; i++) {
        const Quat turn = drawn_turn(&seed);
        const Vec3 a = {draw(&seed), draw(&seed), draw(&seed)};
        const Vec3 turned = quat_rotate(turn, a);
        const Vec3 back = quat_rotate_back(turn, turned);
        assert_near(vec3_length(turned), vec3_length(a), 4e-15);
        assert_near(vec3_length(vec3_sub(back, a)), 0.0, 4e-15);
    }
    // a quarter turn about z takes x to y, and a small turn is one to its last digits
    const Vec3 y = quat_rotate(quat_of_turn((Vec3){0.0, 0.0, M_PI / 2.0}), (Vec3){1.0, 0.0, 0.0});
    assert_near(y.y, 1.0, 1e-15);
    const Vec3 near = quat_rotate(quat_of_turn((Vec3){0.0, 0.0, 9e-5}), (Vec3){1.0, 0.0, 0.0});
    assert_near(near.y, sin(9e-5), 1e-19);
}

static void inverses_undo(void **state)
{
    (void)state;
    uint64_t seed = lcg_stirred(2);
    Mat3 m;
    for (int i = 0; i < 3; i++) {
        m.row[i] = (Vec3){draw(&seed), draw(&seed), draw(&seed)};
    }
    const Mat3 inverse = mat3_inverse(&m);
    const Vec3 a = {0.3, -0.2, 0.7};
    assert_near(vec3_length(vec3_sub(mat3_apply(&inverse, mat3_apply(&m, a)), a)), 0.0, 1e-13);
}

// Bodies with these inertias exist; by point masses on the axes, or not at all.
static void impossible_inertias_are_seen(void **state)
{
    (void)state;
    Body body = {.inertia = 3.0, .space = {.inertia_x = 1.0, .inertia_y = 2.0}};
    assert_true(space_is_possible(&body)); // a plate: its moments add up
    body.inertia = 3.001;
    assert_false(space_is_possible(&body));
    body.inertia = 2.0;
    body.space.product_xy = 0.5;
    assert_true(space_is_possible(&body));
    body.space.product_xy = 1.0; // sum m x x = 1.5, sum m y y = .5: at most .87
    assert_false(space_is_possible(&body));
}

static void the_kinetic_energy_is_that_of_the_points(void **state)
{
    (void)state;
    // four point masses, and the moments and products they have
    static const Vec3 POINTS[] = {
        {0.1, 0.2, -0.05}, {-0.3, 0.1, 0.2}, {0.25, -0.15, 0.1}, {-0.05, -0.15, -0.25}};
    Linkage linkage = kept_linkage();
    linkage.is_spatial = true;
    linkage.body_count = 1;
    Body *body = &linkage.bodies[0];
    for (int i = 0; i < 4; i++) {
        const Vec3 p = POINTS[i];
        body->mass += 0.5;
        body->space.inertia_x += 0.5 * (p.y * p.y + p.z * p.z);
        body->space.inertia_y += 0.5 * (p.x * p.x + p.z * p.z);
        body->inertia += 0.5 * (p.x * p.x + p.y * p.y);
        body->space.product_xy += 0.5 * p.x * p.y;
        body->space.product_xz += 0.5 * p.x * p.z;
        body->space.product_yz += 0.5 * p.y * p.z;
    }
    uint64_t seed = lcg_stirred(3);
    const SpaceMotion motion = {
        .turn = drawn_turn(&seed), .velocity = {0.3, -1.0, 2.0}, .omega = {4.0, -2.0, 1.0}};
    double energy = 0.0;
    for (int i = 0; i < 4; i++) {
        const Vec3 arm = quat_rotate(motion.turn, POINTS[i]);
        const Vec3 v = vec3_add(motion.velocity, vec3_cross(motion.omega, arm));
        energy += 0.25 * vec3_dot(v, v);
    }
    assert_true(space_is_possible(body));
    assert_near(space_kinetic_energy(&linkage, &motion), energy, 1e-14);
}

// Gruebler counts a planar four-bar in space as 6 (3) - 5 (4) = -2 freedoms, and so Bennett's
// linkage; both move.
static void loops_that_move_in_spite_of_the_count_are_found_to(void **state)
{
    (void)state;
    SpaceMotion motions[BODIES];
    const Scenario planar = load_with(PAPER, "space=spatial");
    space_start(&planar.linkage, motions);
    assert_int_equal(space_rows_mobility(&planar.linkage, motions, false), 1);
    assert_int_equal(space_rows_mobility(&planar.linkage, motions, true), 3);
    Scenario bennett = load(BENNETT, NULL, 0);
    space_start(&bennett.linkage, motions);
    assert_int_equal(space_rows_mobility(&bennett.linkage, motions, false), 1);
    // one axis a tenth of a degree off, and it is a frame
    Vec3 *axis = &bennett.linkage.joints[2].space.axis;
    *axis = quat_rotate(quat_of_turn((Vec3){2e-3, 0.0, 0.0}), *axis);
    assert_int_equal(space_rows_mobility(&bennett.linkage, motions, false), 0);
}

// Each row's velocity is the rate of its opening.
static void rows_are_the_rates_of_their_openings(void **state)
{
    (void)state;
    const Scenario bennett = load(BENNETT, NULL, 0);
    SpaceMotion motions[BODIES];
    space_start(&bennett.linkage, motions);
    uint64_t seed = lcg_stirred(4);
    const double step = 1e-6;
    SpaceMotion moved[BODIES];
    for (size_t i = 0; i < bennett.linkage.body_count; i++) {
        SpaceMotion *motion = &motions[i];
        motion->velocity = (Vec3){draw(&seed), draw(&seed), draw(&seed)};
        motion->omega = (Vec3){draw(&seed), draw(&seed), draw(&seed)};
        moved[i] = *motion;
        moved[i].position = vec3_add(motion->position, vec3_scale(step, motion->velocity));
        moved[i].turn = quat_product(quat_of_turn(vec3_scale(step, motion->omega)), motion->turn);
    }
    for (size_t joint = 0; joint < bennett.linkage.joint_count; joint++) {
        SpaceRow rows[SPACE_JOINT_ROWS];
        double before[SPACE_JOINT_ROWS];
        double after[SPACE_JOINT_ROWS];
        space_rows_of_joint(&bennett.linkage, motions, joint, rows);
        space_rows_opening(&bennett.linkage, motions, joint, before);
        space_rows_opening(&bennett.linkage, moved, joint, after);
        for (int k = 0; k < SPACE_JOINT_ROWS; k++) {
            assert_near(before[k], 0.0, 1e-11); // the digits of the case
            assert_near((after[k] - before[k]) / step, space_row_speed(&rows[k], motions), 1e-5);
        }
    }
}

static void speeds_found_in_space_are_those_of_the_plane(void **state)
{
    (void)state;
    const Scenario scenario = load_with(PAPER, "space=spatial");
    SpaceMotion motions[BODIES];
    space_start(&scenario.linkage, motions);
    for (size_t i = 0; i < scenario.linkage.body_count; i++) {
        motions[i].velocity = (Vec3){0.0, 0.0, 0.0};
        motions[i].omega = (Vec3){0.0, 0.0, 0.0};
    }
    space_nearest_speeds(&scenario.linkage, true, motions);
    for (size_t i = 0; i < scenario.linkage.body_count; i++) {
        const Motion *start = &scenario.linkage.bodies[i].start;
        assert_near(motions[i].omega.z, start->omega, 1e-9);
        assert_near(motions[i].velocity.x, start->velocity.x, 1e-10);
        assert_near(motions[i].velocity.y, start->velocity.y, 1e-10);
        assert_near(hypot(motions[i].omega.x, motions[i].omega.y), 0.0, 1e-10);
    }
}

// Joint angles theta at the ground axis of the drive and phi at the next: of Bennett's linkage
// tan(theta / 2) tan(phi / 2) = sin((beta + alpha) / 2) / sin((beta - alpha) / 2), so that
// phi' = -theta' sin(phi) / sin(theta). The coupler turns against the crank by phi about their
// axis.
static void the_start_of_bennetts_linkage_is_its_closed_form(void **state)
{
    (void)state;
    const Scenario scenario = load(BENNETT, NULL, 0);
    const double degree = M_PI / 180.0;
    const double theta = 30.0 * degree;
    const double phi = 2.0 * atan(sin(60.0 * degree) / sin(20.0 * degree) / tan(0.5 * theta));
    SpaceMotion motions[BODIES];
    space_start(&scenario.linkage, motions);
    const Vec3 relative = vec3_sub(motions[1].omega, motions[0].omega);
    const double rate = -scenario.linkage.driver.speed * sin(phi) / sin(theta);
    assert_near(vec3_dot(relative, scenario.linkage.joints[1].space.axis), rate, 1e-9);
    assert_near(vec3_length(relative), fabs(rate), 1e-9);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rotations_keep_lengths_and_go_back),
        cmocka_unit_test(inverses_undo),
        cmocka_unit_test(impossible_inertias_are_seen),
        cmocka_unit_test(the_kinetic_energy_is_that_of_the_points),
        cmocka_unit_test(loops_that_move_in_spite_of_the_count_are_found_to),
        cmocka_unit_test(rows_are_the_rates_of_their_openings),
        cmocka_unit_test(speeds_found_in_space_are_those_of_the_plane),
        cmocka_unit_test(the_start_of_bennetts_linkage_is_its_closed_form),
    };
    return cmocka_run_group_tests_name("space", tests, NULL, NULL);
}
