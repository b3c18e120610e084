// Do springs pull as their energy says, dampers take what they feel, and is a torque over time
// summed right?
#include "base/lcg.h"
#include "model/forces.h"

#include "close.h"
#include "kept.h"

#include <string.h>

// Two bodies that move as they like, every kind of spring between them and the ground.
static Linkage two_bodies(Motion *motions)
{
    Linkage linkage = kept_linkage();
    linkage.body_count = 2;
    linkage.joint_count = 2;
    linkage.spring_count = 2;
    linkage.torsion_count = 2;
    for (size_t i = 0; i < 2; i++) {
        linkage.bodies[i].mass = 1.0;
        linkage.bodies[i].inertia = 0.1;
    }
    linkage.joints[0] = (Joint){.body_a = LINKAGE_GROUND, .body_b = 0};
    linkage.joints[1] = (Joint){.body_a = 1, .body_b = 0};
    linkage.springs[0] = (Spring){.body_a = LINKAGE_GROUND,
                                  .body_b = 1,
                                  .anchor_a = {0.3, -0.1},
                                  .anchor_b = {0.05, 0.02},
                                  .stiffness = 120.0,
                                  .length = 0.4,
                                  .damping = 3.0};
    linkage.springs[1] = (Spring){.body_a = 0,
                                  .body_b = 1,
                                  .anchor_a = {-0.1, 0.07},
                                  .anchor_b = {0.0, -0.04},
                                  .stiffness = 70.0,
                                  .length = 0.1,
                                  .damping = 2.0};
    linkage.torsions[0] =
        (TorsionSpring){.joint = 0, .stiffness = 5.0, .angle = 0.2, .damping = 0.3};
    linkage.torsions[1] =
        (TorsionSpring){.joint = 1, .stiffness = 4.0, .angle = -1.0, .damping = 0.1};
    linkage.torque = (Torque){.joint = 1, .table = {.count = 1, .values = {2.5}}};
    motions[0] =
        (Motion){.position = {0.1, 0.2}, .angle = 0.7, .velocity = {0.4, -0.3}, .omega = 2.0};
    motions[1] =
        (Motion){.position = {-0.2, 0.5}, .angle = -1.9, .velocity = {-0.8, 0.1}, .omega = -5.0};
    return linkage;
}

static void move(const Motion *from, double time_s, Motion *to)
{
    for (size_t i = 0; i < 2; i++) {
        to[i] = from[i];
        to[i].position = vec2_add(from[i].position, vec2_scale(time_s, from[i].velocity));
        to[i].angle += time_s * from[i].omega;
    }
}

static double power_of(const BodyLoad *loads, const Motion *motions)
{
    return forces_load_power(&loads[0], &motions[0]) + forces_load_power(&loads[1], &motions[1]);
}

static void springs_give_what_their_energy_loses(void **state)
{
    (void)state;
    Motion motions[2];
    Motion before[2];
    Motion after[2];
    BodyLoad loads[2] = {{{0.0, 0.0}, 0.0}};
    const Linkage linkage = two_bodies(motions);
    const double width_s = 1e-5; // central differences are good to its square, 1e-10 of the power
    move(motions, -width_s, before);
    move(motions, width_s, after);
    const double rate =
        (forces_energy(&linkage, after) - forces_energy(&linkage, before)) / (2.0 * width_s);
    forces_add_springs(&linkage, motions, loads);
    assert_close(power_of(loads, motions), -rate, 1e-8);
    // the control: dampers do not store
    forces_add_dampers(&linkage, motions, loads);
    assert_true(fabs(power_of(loads, motions) + rate) > 1e-2 * fabs(rate));
}

static void dampers_take_their_power_and_the_torque_gives_its(void **state)
{
    (void)state;
    Motion motions[2];
    BodyLoad damping[2] = {{{0.0, 0.0}, 0.0}};
    BodyLoad pushing[2] = {{{0.0, 0.0}, 0.0}};
    const Linkage linkage = two_bodies(motions);
    forces_add_dampers(&linkage, motions, damping);
    assert_close(power_of(damping, motions), -forces_damping_power(&linkage, motions), 1e-14);
    forces_add_torque(&linkage, motions, 2.5, pushing);
    assert_close(power_of(pushing, motions), forces_torque_power(&linkage, motions, 1.0), 1e-14);
    // by hand: 2.5 N m on body 0, which turns at 2 rad/s, against body 1 at -5 rad/s
    assert_close(power_of(pushing, motions), 2.5 * 7.0, 1e-14);
}

// At a prismatic joint the drive's torque is a force along the line, which turns with body a.
static void a_force_along_a_line_gives_its_power_and_no_momentum(void **state)
{
    (void)state;
    Motion motions[2];
    BodyLoad loads[2] = {{{0.0, 0.0}, 0.0}};
    Linkage linkage = two_bodies(motions);
    linkage.joints[1] = (Joint){.kind = JOINT_PRISMATIC,
                                .body_a = 0,
                                .body_b = 1,
                                .anchor_a = {0.1, 0.02},
                                .anchor_b = {-0.03, 0.05},
                                .direction = 0.4};
    forces_add_torque(&linkage, motions, 2.5, loads);
    assert_near(loads[1].force.x, 2.5 * cos(1.1), 1e-15);
    assert_near(loads[1].force.y, 2.5 * sin(1.1), 1e-15);
    assert_close(power_of(loads, motions), forces_torque_power(&linkage, motions, 1.0), 1e-13);
    // the rate is that of the way along the line, a central difference
    const double width_s = 1e-5;
    double ways[2];
    for (int i = 0; i < 2; i++) {
        Motion moved[2];
        move(motions, i == 0 ? -width_s : width_s, moved);
        ways[i] = vec2_dot(vec2_rotate(moved[0].angle + 0.4, (Vec2){1.0, 0.0}),
                           linkage_joint_gap(&linkage, moved, 1).position);
    }
    assert_close(forces_drive_rate(&linkage, motions), (ways[1] - ways[0]) / (2.0 * width_s), 1e-8);
    const Vec2 sum = vec2_add(loads[0].force, loads[1].force);
    const double moment = loads[0].moment + loads[1].moment +
                          vec2_cross(motions[0].position, loads[0].force) +
                          vec2_cross(motions[1].position, loads[1].force);
    assert_near(vec2_length(sum), 0.0, 1e-15);
    assert_near(moment, 0.0, 1e-15);
    // a torque is another load
    linkage.joints[1].kind = JOINT_REVOLUTE;
    assert_true(fabs(power_of(loads, motions) - forces_torque_power(&linkage, motions, 1.0)) > 0.1);
}

static void bodies_that_nothing_else_holds_keep_their_momentum(void **state)
{
    (void)state;
    Motion motions[2];
    BodyLoad loads[2] = {{{0.0, 0.0}, 0.0}};
    Linkage linkage = two_bodies(motions);
    // what is between the two bodies alone
    linkage.springs[0] = linkage.springs[1];
    linkage.torsions[0] = linkage.torsions[1];
    forces_loads(&linkage, motions, 0.0, loads);
    const Vec2 sum = vec2_add(loads[0].force, loads[1].force);
    const double moment = loads[0].moment + loads[1].moment +
                          vec2_cross(motions[0].position, loads[0].force) +
                          vec2_cross(motions[1].position, loads[1].force);
    assert_near(vec2_length(sum), 0.0, 1e-13);
    assert_near(moment, 0.0, 1e-13);
}

static void a_torque_over_time_is_linear_between_its_points(void **state)
{
    (void)state;
    const TimeTable torque = {.count = 3, .times = {1.0, 2.0, 4.0}, .values = {3.0, 5.0, -1.0}};
    assert_near(time_table_at(&torque, 0.5), 3.0, 0.0);
    assert_near(time_table_at(&torque, 1.5), 4.0, 1e-15);
    assert_near(time_table_at(&torque, 3.0), 2.0, 1e-15);
    assert_near(time_table_at(&torque, 9.0), -1.0, 0.0);
    // 3 to t = 1, mean 4 to 2, mean 2 to 4, -1 to 5: (3 + 4 + 4 - 1) / 5
    assert_near(time_table_mean(&torque, 0.0, 5.0), 2.0, 1e-15);
    assert_near(time_table_mean(&torque, 1.25, 1.75), 4.0, 1e-15);
    assert_near(time_table_next_bend(&torque, 0.0), 1.0, 0.0);
    assert_near(time_table_next_bend(&torque, 2.0), 4.0, 0.0);
    assert_true(isinf(time_table_next_bend(&torque, 4.0)));
    // worlds that start before time zero see the line at time zero going on
    const TimeTable ramp = {.count = 2, .times = {0.0, 1.0}, .values = {1.0, 3.0}};
    assert_near(time_table_at(&ramp, -1.0), -1.0, 1e-15);
    assert_near(time_table_mean(&ramp, -1.0, 1.0), 1.0, 1e-15);
}

// The truth of a table that repeats: one that has all of its periods written down.
static void a_table_that_repeats_is_one_of_many_periods(void **state)
{
    (void)state;
    enum { PERIODS = 6 };
    for (int late = 0; late < 2; late++) {
        // a first point later than time zero leaves a line from the last period's there
        const TimeTable once = {
            .count = 3,
            .times = {0.7 * late, 1.0, 2.2},
            .values = {3.0, 5.0, -1.0},
            .period_s = 2.9,
        };
        TimeTable whole = {.count = 0};
        for (int k = -late; k < PERIODS; k++) {
            for (size_t i = 0; i < once.count; i++) {
                whole.times[whole.count] = once.times[i] + k * once.period_s;
                whole.values[whole.count++] = once.values[i];
            }
        }
        uint64_t seed = lcg_stirred(17);
        for (int i = 0; i < 1000; i++) {
            const double last_s = whole.times[whole.count - 1];
            const double time_s = (i % 7 == 0 ? 0.0 : fabs(lcg_draw(&seed))) * last_s;
            const double to_s = fmin(time_s + 1e-3 + fabs(lcg_draw(&seed)), last_s);
            assert_near(time_table_at(&once, time_s), time_table_at(&whole, time_s), 1e-13);
            assert_near(time_table_next_bend(&once, time_s),
                        fmin(time_table_next_bend(&whole, time_s), 1e9), 1e-13);
            assert_near(time_table_piece(&once, time_s).slope,
                        time_table_piece(&whole, time_s).slope, 1e-12);
            assert_near((double)time_table_integral(&once, time_s),
                        (double)time_table_integral(&whole, time_s), 1e-13);
            if (to_s > time_s) {
                assert_near(time_table_mean(&once, time_s, to_s),
                            time_table_mean(&whole, time_s, to_s), 1e-12);
            }
        }
        // control: it does go on changing
        assert_true(fabs(time_table_at(&once, 40.0 * once.period_s + 1.0) - 5.0) < 1e-12);
        assert_true(fabs(time_table_at(&once, 40.0 * once.period_s + 1.1) - 5.0) > 0.1);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(springs_give_what_their_energy_loses),
        cmocka_unit_test(dampers_take_their_power_and_the_torque_gives_its),
        cmocka_unit_test(a_force_along_a_line_gives_its_power_and_no_momentum),
        cmocka_unit_test(bodies_that_nothing_else_holds_keep_their_momentum),
        cmocka_unit_test(a_torque_over_time_is_linear_between_its_points),
        cmocka_unit_test(a_table_that_repeats_is_one_of_many_periods),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
