// Do bodies that slide on a line move as the closed forms say, and does the drive stop where they
// cannot?
#include "close.h"

#include "slider.h"

#include "base/lcg.h"
#include "kept.h"
#include "model/joint_rows.h"
#include "model/kinematics.h"
#include "model/lock.h"
#include "model/nearest.h"

#include <string.h>

static const double DEGREE = M_PI / 180.0;

// Newton's method stops where joints are closed to 1e-13 of the linkage
static const double CLOSED = 1e-13;

// What is followed over a turn: a position with its two rates.
typedef struct Course {
    double position;
    double rate;
    double rates_rate;
} Course;

// The slider's way along its line, which is a distance from the pivot and inclined:
//     x = r cos t + sqrt(l^2 - (r sin t - e)^2),  t the crank's angle against the line
static Course slider_course(double r, double l, double offset, double omega, double turned)
{
    const double across = r * sin(turned) - offset;
    const double across_rate = r * omega * cos(turned);
    const double across_rates_rate = -r * omega * omega * sin(turned);
    const double root = sqrt(l * l - across * across);
    const double root_rate = -across * across_rate / root;
    const double root_rates_rate =
        -(across_rate * across_rate + across * across_rates_rate + root_rate * root_rate) / root;
    return (Course){r * cos(turned) + root, -r * omega * sin(turned) + root_rate,
                    -r * omega * omega * cos(turned) + root_rates_rate};
}

static void a_slider_on_a_line_off_the_pivot_follows_the_closed_form(void **state)
{
    (void)state;
    const double offset = 0.02;
    const double inclined = 25.0 * DEGREE;
    const double omega = 300.0;
    Scenario scenario = slider_driven(&SLIDER_USUAL, omega);
    Joint *guide = &scenario.linkage.joints[SLIDER_GUIDE];
    guide->anchor_a = vec2_rotate(inclined, (Vec2){0.07, offset});
    guide->direction = inclined;
    guide->held_angle = 0.4;
    Motion motions[KINEMATICS_BODY_MAX];
    linkage_start(&scenario.linkage, motions);
    Err err = {0};
    for (int degree = 0; degree <= 360; degree += 5) {
        assert_true(kinematics_solve(&scenario.linkage, degree * DEGREE, motions, &err));
        const Course truth = slider_course(SLIDER_USUAL.crank, SLIDER_USUAL.rod, offset, omega,
                                           degree * DEGREE - inclined);
        const Motion *slider = &motions[2];
        const Vec2 position = vec2_rotate(-inclined, slider->position);
        const Vec2 velocity = vec2_rotate(-inclined, slider->velocity);
        const Vec2 acceleration = vec2_rotate(-inclined, slider->acceleration);
        assert_near(position.x, truth.position, CLOSED);
        assert_near(position.y, offset, CLOSED);
        assert_near(velocity.x, truth.rate, 1e-12);
        assert_near(velocity.y, 0.0, 1e-12);
        assert_near(acceleration.x, truth.rates_rate, 1e-9);
        assert_near(acceleration.y, 0.0, 1e-9);
        assert_near(slider->angle, 0.4, CLOSED);
        assert_near(slider->alpha, 0.0, 1e-9);
    }
    // the same line without its offset is another motion
    const Course other = slider_course(SLIDER_USUAL.crank, SLIDER_USUAL.rod, 0.0, omega, -inclined);
    assert_true(fabs(vec2_rotate(-inclined, motions[2].position).x - other.position) > 1e-4);
}

// The lever's angle follows the pin of the crank: tan = y / x of the pin.
static Course lever_course(double omega, double turned, Vec2 *pin)
{
    const double r = 0.1;
    *pin = (Vec2){0.25 + r * cos(turned), r * sin(turned)};
    const Vec2 velocity = vec2_scale(r * omega, (Vec2){-sin(turned), cos(turned)});
    const Vec2 acceleration = vec2_scale(-r * omega * omega, (Vec2){cos(turned), sin(turned)});
    const double square = vec2_dot(*pin, *pin);
    const double rate = vec2_cross(*pin, velocity) / square;
    return (Course){atan2(pin->y, pin->x), rate,
                    (vec2_cross(*pin, acceleration) - 2.0 * rate * vec2_dot(*pin, velocity)) /
                        square};
}

static void a_block_on_a_turning_lever_follows_the_closed_form(void **state)
{
    (void)state;
    const double omega = 200.0;
    const Scenario scenario = slider_lever(omega);
    Motion motions[KINEMATICS_BODY_MAX];
    linkage_start(&scenario.linkage, motions);
    Err err = {0};
    double largest = 0.0;
    for (int degree = 0; degree <= 360; degree += 5) {
        Vec2 pin;
        const Course truth = lever_course(omega, degree * DEGREE, &pin);
        assert_true(kinematics_solve(&scenario.linkage, degree * DEGREE, motions, &err));
        for (int i = 1; i <= 2; i++) {
            assert_near(motions[i].angle, truth.position, 1e-12);
            assert_near(motions[i].omega, truth.rate, 1e-11);
            assert_near(motions[i].alpha, truth.rates_rate, 1e-8);
        }
        // the block's centre is 10 mm beyond the pin
        const Vec2 out = vec2_scale(1.0 / vec2_length(pin), pin);
        const Vec2 acceleration = vec2_add(
            vec2_scale(-0.1 * omega * omega, (Vec2){cos(degree * DEGREE), sin(degree * DEGREE)}),
            vec2_add(vec2_scale(-0.01 * truth.rate * truth.rate, out),
                     vec2_scale(0.01 * truth.rates_rate, vec2_perp(out))));
        assert_near(motions[2].position.x, pin.x + 0.01 * out.x, CLOSED);
        assert_near(motions[2].position.y, pin.y + 0.01 * out.y, CLOSED);
        assert_near(motions[2].acceleration.x, acceleration.x, 1e-9);
        assert_near(motions[2].acceleration.y, acceleration.y, 1e-9);
        largest = fmax(largest, fabs(truth.rates_rate));
    }
    assert_true(largest > 1e3);
}

// A crank whose pin carries a block in the upright slot of a yoke, which slides along x.
static Scenario scotch_yoke(double speed)
{
    Scenario scenario = slider_lever(speed);
    Linkage *linkage = &scenario.linkage;
    const Vec2 origin = {0.0, 0.0};
    linkage->bodies[1].start = (Motion){.position = {0.5, 0.1}};
    linkage->bodies[2].start = (Motion){.position = {0.34, 0.01}};
    linkage->joints[1].kind = JOINT_PRISMATIC;
    linkage->joints[1].anchor_a = (Vec2){0.0, 0.1};
    linkage->joints[1].anchor_b = origin;
    linkage->joints[2].anchor_b = origin;
    // the slot of the yoke, 0.1 m from its centre
    linkage->joints[3].anchor_a = (Vec2){-0.1, 0.3};
    linkage->joints[3].anchor_b = origin;
    linkage->joints[3].direction = 0.5 * M_PI;
    return scenario;
}

static void a_scotch_yoke_moves_as_the_cosine(void **state)
{
    (void)state;
    const double omega = 100.0;
    const Scenario scenario = scotch_yoke(omega);
    Motion motions[KINEMATICS_BODY_MAX];
    linkage_start(&scenario.linkage, motions);
    Err err = {0};
    for (int degree = 0; degree <= 720; degree += 15) {
        const double turned = degree * DEGREE;
        assert_true(kinematics_solve(&scenario.linkage, turned, motions, &err));
        assert_near(motions[1].position.x, 0.35 + 0.1 * cos(turned), CLOSED);
        assert_near(motions[1].position.y, 0.1, CLOSED);
        assert_near(motions[1].velocity.x, -10.0 * sin(turned), 1e-12);
        assert_near(motions[1].acceleration.x, -1000.0 * cos(turned), 1e-9);
        assert_near(motions[2].omega, 0.0, 1e-12);
    }
    assert_int_equal(kinematics_mobility(&scenario.linkage, motions, true), 1);
}

static Vec2 draw_vector(double size, uint64_t *seed)
{
    const double x = size * lcg_draw(seed);
    return (Vec2){x, size * lcg_draw(seed)};
}

static Motion draw_motion(uint64_t *seed)
{
    return (Motion){.position = draw_vector(0.3, seed),
                    .angle = 3.0 * lcg_draw(seed),
                    .velocity = draw_vector(2.0, seed),
                    .omega = 20.0 * lcg_draw(seed)};
}

// Where bodies without accelerations are after some time.
static void drift(const Motion *from, double time_s, Motion *to)
{
    for (int i = 0; i < 2; i++) {
        to[i] = from[i];
        to[i].position = vec2_add(from[i].position, vec2_scale(time_s, from[i].velocity));
        to[i].angle += time_s * from[i].omega;
    }
}

// The central difference of the rows' positions and rates.
static void difference(const Linkage *linkage, const Motion *motions, double rates[JOINT_ROWS],
                       double biases[JOINT_ROWS])
{
    const double step_s = 1e-5;
    Motion before[2];
    Motion after[2];
    JointRows first;
    JointRows last;
    drift(motions, -step_s, before);
    drift(motions, step_s, after);
    joint_rows_find(linkage, before, 0, &first);
    joint_rows_find(linkage, after, 0, &last);
    for (int i = 0; i < JOINT_ROWS; i++) {
        rates[i] = (last.position[i] - first.position[i]) / (2.0 * step_s);
        biases[i] = (last.rate[i] - first.rate[i]) / (2.0 * step_s);
    }
}

static double by_coefficients(const JointRow *row, const Linkage *linkage, const Motion *motions)
{
    double sum = 0.0;
    for (int side = 0; side < 2; side++) {
        const int body = linkage_end(&linkage->joints[0], side).body;
        if (body != LINKAGE_GROUND) {
            const Motion *motion = &motions[body];
            sum += row->x[side] * motion->velocity.x + row->y[side] * motion->velocity.y +
                   row->turn[side] * motion->omega;
        }
    }
    return sum;
}

// Of any joint on any two bodies, moving in any way.
static void rates_of_rows_are_those_of_their_positions(void **state)
{
    (void)state;
    static const JointKind KINDS[] = {JOINT_REVOLUTE, JOINT_PRISMATIC, JOINT_GUIDE};
    uint64_t seed = lcg_stirred(7);
    int without_term = 0;
    for (int draw = 0; draw < 300; draw++) {
        Linkage linkage = kept_linkage();
        linkage.body_count = 2;
        linkage.joint_count = 1;
        Joint *joint = &linkage.joints[0];
        joint->kind = KINDS[draw % 3];
        joint->body_a = draw % 5 == 0 ? LINKAGE_GROUND : 0;
        joint->body_b = draw % 7 == 0 && draw % 5 != 0 ? LINKAGE_GROUND : 1;
        joint->anchor_a = draw_vector(0.2, &seed);
        joint->anchor_b = draw_vector(0.2, &seed);
        joint->direction = 3.0 * lcg_draw(&seed);
        joint->held_angle = lcg_draw(&seed);
        const Motion motions[2] = {draw_motion(&seed), draw_motion(&seed)};
        JointRows rows;
        double rates[JOINT_ROWS];
        double biases[JOINT_ROWS];
        joint_rows_find(&linkage, motions, 0, &rows);
        difference(&linkage, motions, rates, biases);
        for (int i = 0; i < JOINT_ROWS; i++) {
            // the second order of the difference: omega^3 step^2 / 6 of a length
            assert_near(rows.rate[i], rates[i], 1e-6);
            assert_near(rows.bias[i], biases[i], 2e-5);
            assert_near(by_coefficients(&rows.rows[i], &linkage, motions), rows.rate[i], 1e-13);
        }
        // without Coriolis' term, 2 omega times the sliding speed, it is another number
        if (joint->kind != JOINT_REVOLUTE && joint->body_a == 0) {
            const JointGap gap = linkage_joint_gap(&linkage, motions, 0);
            const Vec2 along = joint_rows_along(&linkage, motions, 0);
            const double term = 2.0 * motions[0].omega * vec2_dot(along, gap.velocity);
            without_term += fabs(rows.bias[0] + term - biases[0]) > 2e-5 ? 1 : 0;
        }
    }
    assert_true(without_term > 100);
}

static void a_guide_leaves_two_freedoms_more_and_a_stop_takes_none(void **state)
{
    (void)state;
    Scenario scenario = slider_driven(&SLIDER_USUAL, 100.0);
    Linkage *linkage = &scenario.linkage;
    Motion motions[KINEMATICS_BODY_MAX];
    Motion with_stop[KINEMATICS_BODY_MAX];
    Err err = {0};
    linkage_start(linkage, motions);
    memcpy(with_stop, motions, sizeof motions);
    assert_int_equal(kinematics_mobility(linkage, motions, true), 1);
    assert_true(kinematics_solve(linkage, 1.0, motions, &err));
    linkage->joints[linkage->joint_count++] =
        (Joint){.name = "stop", .kind = JOINT_STOP, .body_a = LINKAGE_GROUND, .body_b = 2};
    assert_int_equal(kinematics_mobility(linkage, motions, true), 1);
    assert_true(kinematics_solve(linkage, 1.0, with_stop, &err));
    assert_memory_equal(motions, with_stop, 3 * sizeof *motions);
    // the stop's points are far apart, and no joint is open
    assert_near(kinematics_closure_error(linkage, motions), 0.0, 1e-15);
    slider_loosen_guide(&scenario, 0.0502, 0.05, 0.1);
    assert_int_equal(kinematics_mobility(linkage, motions, true), 3);
    assert_int_equal(kinematics_mobility(linkage, motions, false), 1);
}

static void the_opening_of_a_guide_counts_its_tilt_at_the_bodys_reach(void **state)
{
    (void)state;
    Scenario scenario = slider_driven(&SLIDER_USUAL, 100.0);
    Motion motions[KINEMATICS_BODY_MAX];
    linkage_start(&scenario.linkage, motions);
    motions[2].angle = 1e-3;
    const double reach = linkage_reach(&scenario.linkage, 2);
    assert_near(kinematics_closure_error(&scenario.linkage, motions), 1e-3 * reach, 1e-16);
    motions[2].position.y += 1e-5;
    // the wrist is open by the same
    assert_near(kinematics_closure_error(&scenario.linkage, motions), hypot(1e-3 * reach, 1e-5),
                1e-16);
}

static void speeds_across_the_line_are_seen_and_taken_away(void **state)
{
    (void)state;
    Scenario scenario = slider_crank(&SLIDER_USUAL, 100.0);
    Motion motions[KINEMATICS_BODY_MAX];
    int joint;
    double distance;
    linkage_start(&scenario.linkage, motions);
    assert_true(nearest_check(&scenario.linkage, motions, &joint, &distance));
    motions[2].omega = 1.0;
    assert_false(nearest_check(&scenario.linkage, motions, &joint, &distance));
    assert_int_equal(joint, SLIDER_GUIDE);
    assert_near(distance, linkage_reach(&scenario.linkage, 2), 1e-15);
    motions[2].velocity.y = 0.3;
    nearest_speeds(&scenario.linkage, false, motions);
    nearest_speeds(&scenario.linkage, false, motions);
    assert_true(nearest_check(&scenario.linkage, motions, &joint, &distance));
    assert_near(motions[2].omega, 0.0, 1e-12);
    assert_near(motions[2].velocity.y, 0.0, 1e-12);
}

// r sin t - e = -l: there the rod stands across the line.
static void a_crank_that_is_too_long_for_its_rod_locks(void **state)
{
    (void)state;
    const double offset = 0.05;
    const SliderSizes sizes = {0.1, 0.12, {0.3, 0.2, 0.1}, {1e-4, 1e-4, 1e-4}};
    Scenario scenario = slider_driven(&sizes, 100.0);
    scenario.linkage.joints[SLIDER_GUIDE].anchor_a.y = offset;
    Motion motions[KINEMATICS_BODY_MAX];
    Err err = {0};
    linkage_start(&scenario.linkage, motions);
    assert_true(kinematics_solve(&scenario.linkage, 0.0, motions, &err));
    for (int i = 0; i < 3; i++) {
        scenario.linkage.bodies[i].start = motions[i];
    }
    const double angle = M_PI + asin((sizes.rod - offset) / sizes.crank);
    const Lock lock = lock_find(&scenario.linkage, LOCK_IDEAL_ONLY, 2.0 * M_PI);
    assert_int_equal(lock.state, LOCK_FOUND);
    assert_near(lock.crank_angle, angle, 1e-8);
    assert_false(kinematics_solve(&scenario.linkage, angle + 0.01, motions, &err));
    // with play in the guide the ideal joints alone lock nothing, and all as ideal lock as before
    slider_loosen_guide(&scenario, 0.0502, 0.05, 0.1);
    assert_int_equal(lock_find(&scenario.linkage, LOCK_IDEAL_ONLY, 2.0 * M_PI).state, LOCK_UNKNOWN);
    const Lock loose = lock_find(&scenario.linkage, LOCK_ALL_AS_IDEAL, 2.0 * M_PI);
    assert_near(loose.crank_angle, angle, 1e-8);
    // a rod that is long enough never does
    const SliderSizes longer = {0.1, 0.16, {0.3, 0.2, 0.1}, {1e-4, 1e-4, 1e-4}};
    Scenario free = slider_driven(&longer, 100.0);
    assert_int_equal(lock_find(&free.linkage, LOCK_IDEAL_ONLY, 4.0 * M_PI).state, LOCK_NONE);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_slider_on_a_line_off_the_pivot_follows_the_closed_form),
        cmocka_unit_test(a_block_on_a_turning_lever_follows_the_closed_form),
        cmocka_unit_test(a_scotch_yoke_moves_as_the_cosine),
        cmocka_unit_test(rates_of_rows_are_those_of_their_positions),
        cmocka_unit_test(a_guide_leaves_two_freedoms_more_and_a_stop_takes_none),
        cmocka_unit_test(the_opening_of_a_guide_counts_its_tilt_at_the_bodys_reach),
        cmocka_unit_test(speeds_across_the_line_are_seen_and_taken_away),
        cmocka_unit_test(a_crank_that_is_too_long_for_its_rod_locks),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
