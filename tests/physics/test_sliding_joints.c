// Do bodies that slide on one another move and press as the closed forms say, however the joints
// are listed?
#include "complete_run.h"

#include "kept.h"
#include "slider.h"

#include <stdio.h>

// The ways of listing the joints of one mechanism, which make other trees of it, with the frame of
// body 2 turned by some angle, rad.
static Scenario relisted(const Scenario *scenario, const int *order, bool is_turned_round)
{
    const double turned = 0.7;
    Scenario other = kept_copy(scenario);
    other.linkage.bodies[2].start.angle += turned;
    for (size_t i = 0; i < scenario->linkage.joint_count; i++) {
        Joint *joint = &other.linkage.joints[i];
        *joint = scenario->linkage.joints[order[i]];
        // body 2 is body b of all of its joints
        if (joint->body_b == 2) {
            joint->anchor_b = vec2_rotate(-turned, joint->anchor_b);
            joint->held_angle = turned;
        }
        if (is_turned_round && joint->kind == JOINT_PRISMATIC) {
            const JointEnd a = linkage_end(joint, 0);
            const JointEnd b = linkage_end(joint, 1);
            joint->body_a = b.body;
            joint->anchor_a = b.anchor;
            joint->body_b = a.body;
            joint->anchor_b = a.anchor;
            joint->direction -= turned;
            joint->held_angle = -turned;
        }
    }
    return other;
}

static const int ORDERS[][4] = {{0, 1, 2, 3}, {0, 3, 1, 2}, {0, 1, 3, 2}};
enum { ORDER_COUNT = 3 };

// Position, speed and acceleration along x of the slider at an angle of the crank.
static void slider_motion(const SliderSizes *sizes, double omega, double angle, double x[3])
{
    const double r = sizes->crank;
    const double s = r / sizes->rod * sin(angle);
    const double c = sqrt(1.0 - s * s);
    const double rod_omega = -r * cos(angle) * omega / (sizes->rod * c);
    const double rod_alpha =
        (r * sin(angle) * omega * omega - sizes->rod * s * rod_omega * rod_omega) /
        (sizes->rod * c);
    x[0] = r * cos(angle) + sizes->rod * c;
    x[1] = -r * sin(angle) * omega + sizes->rod * s * rod_omega;
    x[2] = -r * cos(angle) * omega * omega - sizes->rod * c * rod_omega * rod_omega +
           sizes->rod * s * rod_alpha;
}

static void a_driven_slider_follows_the_closed_form(void **state)
{
    (void)state;
    const double omega = 5000.0 * 2.0 * M_PI / 60.0;
    Scenario scenario = slider_driven(&SLIDER_USUAL, omega);
    scenario.run.revolutions = 1.0;
    scenario.run.samples = 360;
    for (int way = 0; way < 2 * ORDER_COUNT; way++) {
        const Scenario listed = relisted(&scenario, ORDERS[way / 2], way % 2 == 1);
        Trajectory *trajectory = complete_run(&listed, BACKEND_REFERENCE);
        double worst = 0.0;
        for (size_t k = 0; k < trajectory->sample_count; k++) {
            double x[3];
            slider_motion(&SLIDER_USUAL, omega, trajectory->crank_angles[k], x);
            const Motion *slider = trajectory_motion(trajectory, k, 2);
            assert_near(slider->position.x, x[0], 1e-12 * x[0]);
            assert_near(slider->velocity.x, x[1], 1e-10 * 28.4);
            assert_near(slider->acceleration.x, x[2], 1e-10 * 19419.0);
            assert_near(slider->position.y, 0.0, 1e-14);
            assert_near(slider->angle, 0.7, 1e-14);
            worst = fmax(worst, slider_unbalanced(&listed, trajectory_motion(trajectory, k, 0),
                                                  trajectory_state(trajectory, k, 0)));
        }
        // forces of some 2700 N
        assert_true(worst < 1e-8);
        trajectory_destroy(trajectory);
    }
}

// The published figures of the same mechanism.
static void the_largest_accelerations_are_those_published(void **state)
{
    (void)state;
    const double omega = 5000.0 * 2.0 * M_PI / 60.0;
    Scenario scenario = slider_driven(&SLIDER_USUAL, omega);
    scenario.run.revolutions = 1.0;
    scenario.run.samples = 36000;
    Trajectory *trajectory = complete_run(&scenario, BACKEND_REFERENCE);
    double largest = -INFINITY;
    double smallest = INFINITY;
    double fastest = 0.0;
    size_t when = 0;
    for (size_t k = 0; k < trajectory->sample_count; k++) {
        const Motion *slider = trajectory_motion(trajectory, k, 2);
        // the way back mirrors the way there, with the same maximum but for rounding
        const bool is_there = trajectory->crank_angles[k] < M_PI;
        when = is_there && slider->acceleration.x > largest ? k : when;
        largest = fmax(largest, slider->acceleration.x);
        smallest = fmin(smallest, slider->acceleration.x);
        fastest = fmax(fastest, fabs(slider->velocity.x));
    }
    assert_close(smallest, -19419.3605, 1e-9);
    // samples of a hundredth of a degree miss a maximum by some 1e-9 of it
    assert_close(largest, 9695.85572, 1e-8);
    assert_close(fastest, 28.4113304, 1e-8);
    assert_near(trajectory->crank_angles[when] * 180.0 / M_PI, 121.9976, 6e-3);
    trajectory_destroy(trajectory);
}

// A block on a lever that turns: the lever's angle is that of the crank's pin from its pivot.
static void a_block_on_a_turning_lever_follows_the_closed_form(void **state)
{
    (void)state;
    const double speed = 40.0;
    Scenario scenario = slider_lever(speed);
    scenario.run.revolutions = 1.0;
    scenario.run.samples = 360;
    for (int way = 0; way < 2 * ORDER_COUNT; way++) {
        const Scenario listed = relisted(&scenario, ORDERS[way / 2], way % 2 == 1);
        Trajectory *trajectory = complete_run(&listed, BACKEND_REFERENCE);
        double worst = 0.0;
        for (size_t k = 0; k < trajectory->sample_count; k++) {
            const double angle = trajectory->crank_angles[k];
            const Vec2 pin = {0.25 + 0.1 * cos(angle), 0.1 * sin(angle)};
            const Vec2 v = {-0.1 * speed * sin(angle), 0.1 * speed * cos(angle)};
            const Vec2 a = {-0.1 * speed * speed * cos(angle), -0.1 * speed * speed * sin(angle)};
            const double square = vec2_dot(pin, pin);
            const double omega = vec2_cross(pin, v) / square;
            const double alpha = (vec2_cross(pin, a) - 2.0 * omega * vec2_dot(pin, v)) / square;
            for (size_t body = 1; body <= 2; body++) {
                const Motion *motion = trajectory_motion(trajectory, k, body);
                assert_near(motion->angle, atan2(pin.y, pin.x) + (body == 2 ? 0.7 : 0.0), 1e-13);
                assert_near(motion->omega, omega, 1e-10 * speed);
                assert_near(motion->alpha, alpha, 1e-10 * speed * speed);
            }
            const JointState *states = trajectory_state(trajectory, k, 0);
            worst = fmax(worst,
                         slider_unbalanced(&listed, trajectory_motion(trajectory, k, 0), states));
            // no force along the line
            for (size_t j = 0; j < 4; j++) {
                if (listed.linkage.joints[j].kind == JOINT_PRISMATIC) {
                    const Vec2 along = {cos(atan2(pin.y, pin.x)), sin(atan2(pin.y, pin.x))};
                    assert_near(vec2_dot(along, states[j].force_on_b), 0.0, 1e-9);
                    assert_near(states[j].tilt, 0.0, 1e-13);
                    assert_near(states[j].eccentricity.y, 0.0, 1e-13);
                }
            }
        }
        assert_true(worst < 1e-10);
        trajectory_destroy(trajectory);
    }
}

// Without a drive the energy stays, and all trees of the mechanism move as one.
static void a_free_mechanism_keeps_its_energy_however_it_is_listed(void **state)
{
    (void)state;
    Scenario scenario = slider_crank(&SLIDER_FLORES, 150.0);
    scenario.run.duration = 0.1;
    scenario.run.samples = 50;
    scenario.reference.tolerance = 1e-12;
    const double start = 0.5 * 0.038 * 0.0765 * 0.0765 * 150.0 * 150.0 * 2.0 +
                         0.5 * 7.4e-5 * 150.0 * 150.0 + 0.5 * 5.9e-4 * 75.0 * 75.0;
    double omega[2 * ORDER_COUNT];
    for (int way = 0; way < 2 * ORDER_COUNT; way++) {
        const Scenario listed = relisted(&scenario, ORDERS[way / 2], way % 2 == 1);
        Trajectory *trajectory = complete_run(&listed, BACKEND_REFERENCE);
        assert_true(fabs(trajectory->energy.residual) < 1e-11 * start);
        const Motion *motions = trajectory_motion(trajectory, 50, 0);
        const double energy =
            linkage_kinetic_energy(&listed.linkage, motions) +
            linkage_potential_energy(&listed.linkage, motions, scenario_gravity(&scenario));
        assert_close(energy, start, 1e-10);
        omega[way] = motions[0].omega;
        assert_close(omega[way], omega[0], 1e-9);
        assert_true(slider_unbalanced(&listed, motions, trajectory_state(trajectory, 50, 0)) <
                    1e-9);
        trajectory_destroy(trajectory);
    }
    // the control: a slider heavier by a millionth is elsewhere by then
    scenario.linkage.bodies[2].mass *= 1.0 + 1e-6;
    Trajectory *trajectory = complete_run(&scenario, BACKEND_REFERENCE);
    assert_true(fabs(trajectory_motion(trajectory, 50, 0)->omega / omega[0] - 1.0) > 1e-9);
    trajectory_destroy(trajectory);
}

// A train in free flight: a spinning body, one that slides on it, one that hangs on that, and one
// that slides on that one in turn, off its centre and at an angle.
static Scenario train(bool is_turned_round)
{
    Scenario scenario = kept_default();
    scenario.gravity = scenario_downward(0.0);
    scenario.run.duration = 1.0;
    scenario.run.samples = 100;
    scenario.reference.tolerance = 1e-12;
    Linkage *linkage = &scenario.linkage;
    const Motion starts[] = {
        {.position = {0.1, 0.2}, .angle = 0.3, .velocity = {0.2, -0.1}, .omega = 3.0},
        {.angle = 1.0, .omega = 3.0},
        {.angle = -0.4, .omega = -5.0},
        {.angle = 0.6, .omega = -5.0},
    };
    const double slides[] = {0.25, 0.0, -0.15}; // m, and their speeds, m/s
    const double speeds[] = {-0.7, 0.0, 0.9};
    linkage->body_count = 4;
    linkage->joint_count = 3;
    for (int i = 0; i < 4; i++) {
        linkage->bodies[i] = (Body){.mass = 0.2 + 0.1 * i, .inertia = 1e-3, .start = starts[i]};
        snprintf(linkage->bodies[i].name, LINKAGE_NAME_SIZE, "body-%d", i);
    }
    for (int i = 0; i < 3; i++) {
        Joint *joint = &linkage->joints[i];
        *joint = (Joint){
            .kind = i == 1 ? JOINT_REVOLUTE : JOINT_PRISMATIC,
            .body_a = i,
            .body_b = i + 1,
            .anchor_a = {0.03, 0.02},
            .anchor_b = {-0.01, 0.04},
            .direction = 0.8,
            .held_angle = starts[i + 1].angle - starts[i].angle,
        };
        snprintf(joint->name, LINKAGE_NAME_SIZE, "joint-%d", i);
        // the second body where the joint has it, and as fast
        const Motion *a = &linkage->bodies[i].start;
        Motion *b = &linkage->bodies[i + 1].start;
        const Vec2 along = vec2_rotate(a->angle + joint->direction, (Vec2){1.0, 0.0});
        const Vec2 to =
            vec2_add(vec2_rotate(a->angle, joint->anchor_a), vec2_scale(slides[i], along));
        const Vec2 back = vec2_rotate(b->angle, joint->anchor_b);
        b->position = vec2_add(a->position, vec2_sub(to, back));
        b->velocity =
            vec2_add(vec2_add(a->velocity, vec2_scale(a->omega, vec2_perp(to))),
                     vec2_sub(vec2_scale(speeds[i], along), vec2_scale(b->omega, vec2_perp(back))));
        if (is_turned_round) {
            joint->direction += a->angle - b->angle;
            joint->held_angle = -joint->held_angle;
            const Vec2 anchor = joint->anchor_a;
            joint->anchor_a = joint->anchor_b;
            joint->anchor_b = anchor;
            joint->body_a = i + 1;
            joint->body_b = i;
        }
    }
    return scenario;
}

// Energy, momentum along x and y, and momentum about the origin.
static void find_kept(const Linkage *linkage, const Motion *motions, double kept[4])
{
    kept[0] = linkage_kinetic_energy(linkage, motions);
    kept[1] = kept[2] = kept[3] = 0.0;
    for (size_t i = 0; i < linkage->body_count; i++) {
        const Body *body = &linkage->bodies[i];
        kept[1] += body->mass * motions[i].velocity.x;
        kept[2] += body->mass * motions[i].velocity.y;
        kept[3] += body->mass * vec2_cross(motions[i].position, motions[i].velocity) +
                   body->inertia * motions[i].omega;
    }
}

static void bodies_that_slide_on_one_another_in_flight_keep_their_momentum(void **state)
{
    (void)state;
    double omega[2];
    for (int way = 0; way < 2; way++) {
        const Scenario scenario = train(way == 1);
        Trajectory *trajectory = complete_run(&scenario, BACKEND_REFERENCE);
        double first[4];
        find_kept(&scenario.linkage, trajectory_motion(trajectory, 0, 0), first);
        for (size_t k = 0; k < trajectory->sample_count; k++) {
            const Motion *motions = trajectory_motion(trajectory, k, 0);
            const JointState *states = trajectory_state(trajectory, k, 0);
            double kept[4];
            find_kept(&scenario.linkage, motions, kept);
            for (int i = 0; i < 4; i++) {
                assert_near(kept[i], first[i], 1e-10);
            }
            assert_true(slider_unbalanced(&scenario, motions, states) < 1e-9);
            for (size_t j = 0; j < 3; j += 2) {
                assert_near(states[j].eccentricity.y, 0.0, 1e-13);
                assert_near(states[j].tilt, 0.0, 1e-13);
                assert_near(motions[j + 1].omega, motions[j].omega, 1e-12);
            }
        }
        omega[way] = trajectory_motion(trajectory, 100, 0)->omega;
        // it has not just flown on
        assert_true(fabs(omega[way] - 3.0) > 0.1);
        trajectory_destroy(trajectory);
    }
    assert_near(omega[1], omega[0], 1e-9);
}

// Control of the balance: without the couple it does not hold.
static void without_the_couple_the_forces_do_not_balance(void **state)
{
    (void)state;
    Scenario scenario = slider_lever(40.0);
    scenario.run.revolutions = 0.1;
    scenario.run.samples = 36;
    Trajectory *trajectory = complete_run(&scenario, BACKEND_REFERENCE);
    JointState states[4];
    for (size_t j = 0; j < 4; j++) {
        states[j] = *trajectory_state(trajectory, 3, j);
        states[j].moment_on_b = 0.0;
    }
    assert_true(slider_unbalanced(&scenario, trajectory_motion(trajectory, 3, 0), states) > 1e-3);
    trajectory_destroy(trajectory);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_driven_slider_follows_the_closed_form),
        cmocka_unit_test(the_largest_accelerations_are_those_published),
        cmocka_unit_test(a_block_on_a_turning_lever_follows_the_closed_form),
        cmocka_unit_test(a_free_mechanism_keeps_its_energy_however_it_is_listed),
        cmocka_unit_test(bodies_that_slide_on_one_another_in_flight_keep_their_momentum),
        cmocka_unit_test(without_the_couple_the_forces_do_not_balance),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
