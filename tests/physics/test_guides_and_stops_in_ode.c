// Do blocks between guides, and stops, press in ODE as in the reference: motion with the orders of
// the schemes, forces, energy?
#include "kept.h"
#include "mechanism.h"
#include "ode_error.h"
#include "slider.h"

#include <stdio.h>
#include <string.h>

typedef struct Scheme {
    OdeStepping stepping;
    OdeMap map;
    double order;
} Scheme;

static const Scheme SCHEMES[] = {
    {ODE_PLAIN, ODE_MAP_TEXTBOOK, 1.0},
    {ODE_STAGGERED, ODE_MAP_MIDPOINT, 2.0},
    {ODE_STAGGERED, ODE_MAP_EXACT, 1.0}, // its secant stiffness is not the law's slope
    {ODE_STAGGERED, ODE_MAP_IMPULSE, 2.0},
};

enum { SCHEME_COUNT = 4 };

static Scenario free_run(double duration, size_t samples)
{
    Scenario scenario = mechanism_default();
    scenario.contact.stiffness = 1e6;
    scenario.contact.exponent = 1.5;
    scenario.contact.damping = DAMPING_FLORES;
    scenario.contact.restitution = 0.6;
    scenario.run.duration = duration;
    scenario.run.samples = samples;
    return scenario;
}

static void set_body(Scenario *scenario, const char *name, double mass, double inertia,
                     Motion start)
{
    Body *body = &scenario->linkage.bodies[scenario->linkage.body_count++];
    snprintf(body->name, sizeof body->name, "%s", name);
    body->mass = mass;
    body->inertia = inertia;
    body->start = start;
}

static Joint *set_joint(Scenario *scenario, JointKind kind, int a, Vec2 anchor_a, int b,
                        Vec2 anchor_b)
{
    Joint *joint = &scenario->linkage.joints[scenario->linkage.joint_count++];
    *joint =
        (Joint){.kind = kind, .body_a = a, .body_b = b, .anchor_a = anchor_a, .anchor_b = anchor_b};
    snprintf(joint->name, sizeof joint->name, "joint %zu", scenario->linkage.joint_count);
    return joint;
}

// The slider of Flores, Leine and Glocker's slider-crank in its guides, tilting from the start.
static Scenario flores(bool is_sleeve)
{
    Scenario scenario = slider_crank(&SLIDER_FLORES, 150.0);
    slider_loosen_guide(&scenario, 0.052, 0.05, 0.1);
    const Scenario defaults = free_run(0.004, 200);
    scenario.contact = defaults.contact;
    scenario.contact.stiffness = 1e7;
    scenario.contact.restitution = 0.4;
    scenario.run.duration = 0.004;
    scenario.run.samples = 200;
    scenario.linkage.bodies[2].start.omega = -10.0;
    if (is_sleeve) {
        // the guide is the slider's, a rod of the ground's goes through it
        Joint *guide = &scenario.linkage.joints[SLIDER_GUIDE];
        const Joint was = *guide;
        guide->body_a = was.body_b;
        guide->body_b = was.body_a;
        guide->anchor_a = was.anchor_b;
        guide->anchor_b = was.anchor_a;
        guide->direction = was.direction + M_PI - was.held_angle;
        guide->held_angle = -was.held_angle;
        guide->guide.opening = 0.05;
        guide->guide.height = 0.052;
    }
    return scenario;
}

// A block in a slot of a driven arm, from rest against it; no closed form.
static Scenario arm(double friction)
{
    Scenario scenario = free_run(0.0, 200);
    scenario.linkage.driver = (Driver){.is_present = true, .joint = 0, .speed = 10.0, .start = 0.3};
    scenario.run.revolutions = 0.2;
    scenario.run.samples = 1000;
    scenario.contact.friction = friction;
    scenario.contact.stiffness = 1e5;
    const Vec2 along = {cos(0.3), sin(0.3)};
    const Vec2 at = vec2_scale(0.1, along);
    set_body(&scenario, "arm", 1.0, 1e-2, (Motion){.angle = 0.3, .omega = 10.0});
    set_body(&scenario, "block", 0.2, 1e-5,
             (Motion){.position = at,
                      .velocity = vec2_scale(10.0, vec2_perp(at)),
                      .angle = 0.3,
                      .omega = 10.5});
    set_joint(&scenario, JOINT_REVOLUTE, LINKAGE_GROUND, (Vec2){0.0, 0.0}, 0, (Vec2){0.0, 0.0});
    Joint *slot = set_joint(&scenario, JOINT_GUIDE, 0, (Vec2){0.05, 0.0}, 1, (Vec2){0.0, 0.0});
    slot->guide = (Guide){.opening = 0.0201, .height = 0.02, .length = 0.03};
    return scenario;
}

// A ball that falls on the ground from 50 mm.
static Scenario ball(void)
{
    Scenario scenario = free_run(0.4, 400);
    scenario.contact.damping = DAMPING_EXACT;
    set_body(&scenario, "ball", 0.1, 1.6e-5, (Motion){.position = {0.0, 0.07}, .omega = 5.0});
    Joint *stop =
        set_joint(&scenario, JOINT_STOP, LINKAGE_GROUND, (Vec2){0.3, 0.0}, 0, (Vec2){0.0, 0.0});
    stop->direction = 0.5 * M_PI;
    stop->stop.radius_b = 0.02;
    return scenario;
}

enum { CRADLE = 5 };

// Newton's cradle: spheres on threads, with gaps of 2 % of their diameter. The first is let go.
static Scenario cradle(double friction)
{
    const double radius = 0.02;
    const double length = 0.25;
    const double mass = 7800.0 * 4.0 / 3.0 * M_PI * radius * radius * radius;
    Scenario scenario = free_run(0.2, 200);
    scenario.contact.restitution = 0.95;
    scenario.contact.friction = friction;
    for (int i = 0; i < CRADLE; i++) {
        const double angle = i == 0 ? -0.5 : 0.0;
        const Vec2 top = {2.04 * radius * i, length};
        const Vec2 thread = vec2_rotate(angle, (Vec2){0.0, -length});
        char name[] = "ball 0";
        name[5] = (char)('0' + i);
        set_body(&scenario, name, mass, 0.4 * mass * radius * radius,
                 (Motion){.position = vec2_add(top, thread), .angle = angle});
        set_joint(&scenario, JOINT_REVOLUTE, LINKAGE_GROUND, top, i, (Vec2){0.0, length});
    }
    for (int i = 0; i + 1 < CRADLE; i++) {
        Joint *stop =
            set_joint(&scenario, JOINT_STOP, i, (Vec2){0.0, 0.0}, i + 1, (Vec2){0.0, 0.0});
        stop->stop = (Stop){.is_disc = true, .radius_a = radius, .radius_b = radius};
    }
    return scenario;
}

// The largest difference of speeds over the largest speed, angles at 0.05 m.
static double speed_error(const Trajectory *run, const Trajectory *truth)
{
    static const double ARM = 0.05; // m
    double error = 0.0;
    double largest = 0.0;
    for (size_t k = 0; k < run->sample_count; k++) {
        for (size_t i = 0; i < run->body_count; i++) {
            const Motion *is = trajectory_motion(run, k, i);
            const Motion *was = trajectory_motion(truth, k, i);
            error = fmax(error, vec2_length(vec2_sub(is->velocity, was->velocity)));
            error = fmax(error, ARM * fabs(is->omega - was->omega));
            largest = fmax(largest, fmax(vec2_length(was->velocity), ARM * fabs(was->omega)));
        }
    }
    return error / largest;
}

static Trajectory *ode_run(Scenario scenario, const Scheme *scheme, double step_s)
{
    scenario.ode.stepping = scheme->stepping;
    scenario.ode.map = scheme->map;
    scenario.run.step = step_s;
    return complete_run(&scenario, BACKEND_ODE);
}

// The errors at a step and at an eighth of it, and the energy residuals.
typedef struct Fall {
    double coarse;
    double fine;
    double coarse_residual; // J
    double fine_residual;
} Fall;

static Fall fall_of(const Scenario *scenario, const Scheme *scheme, double step_s)
{
    Trajectory *truth = complete_run(scenario, BACKEND_REFERENCE);
    Trajectory *coarse = ode_run(*scenario, scheme, step_s);
    Trajectory *fine = ode_run(*scenario, scheme, step_s / 8.0);
    const Fall fall = {
        .coarse = speed_error(coarse, truth),
        .fine = speed_error(fine, truth),
        .coarse_residual = fabs(coarse->energy.residual),
        .fine_residual = fabs(fine->energy.residual),
    };
    trajectory_destroy(truth);
    trajectory_destroy(coarse);
    trajectory_destroy(fine);
    return fall;
}

// Plain stepping must also have come down to where its order shows: 2 % in the shortest contacts.
static void check_orders(const Scenario *scenario, double step_s, bool with_energy)
{
    static const double FINE[] = {3e-2, 2e-4, 2e-2, 1e-6};
    for (size_t i = 0; i < SCHEME_COUNT; i++) {
        const Fall fall = fall_of(scenario, &SCHEMES[i], step_s);
        assert_true(ode_order(fall.coarse, fall.fine, 8.0) > SCHEMES[i].order - 0.25);
        assert_true(fall.fine < FINE[i]);
        if (with_energy && SCHEMES[i].map != ODE_MAP_IMPULSE) {
            assert_true(fall.fine_residual < 0.2 * fall.coarse_residual);
        }
    }
}

static void a_block_between_guides_follows_the_reference(void **state)
{
    (void)state;
    const Scenario scenario = flores(false);
    check_orders(&scenario, 1e-5, true);
}

static void a_sleeve_on_a_moving_body_follows_the_reference(void **state)
{
    (void)state;
    const Scenario scenario = flores(true);
    // in its short contacts plain stepping is far from its order at these steps
    const Fall fall = fall_of(&scenario, &SCHEMES[1], 1e-5);
    assert_true(ode_order(fall.coarse, fall.fine, 8.0) > 2.0);
    assert_true(fall.fine < 2e-4);
}

static void guides_on_the_driven_body_follow_the_reference(void **state)
{
    (void)state;
    const Scenario smooth = arm(0.0);
    check_orders(&smooth, 8e-5, false);
    const Scenario rough = arm(0.2);
    check_orders(&rough, 8e-5, false);
}

static void the_drive_works_as_in_the_reference(void **state)
{
    (void)state;
    const Scenario scenario = arm(0.2);
    Trajectory *truth = complete_run(&scenario, BACKEND_REFERENCE);
    Trajectory *run = ode_run(scenario, &SCHEMES[1], 1e-5);
    // the last step goes a little beyond the run
    assert_close(run->energy.drive_work, truth->energy.drive_work, 1e-4);
    assert_close(run->energy.friction, truth->energy.friction, 1e-3);
    assert_close(run->energy.dissipated, truth->energy.dissipated, 1e-3);
    trajectory_destroy(truth);
    trajectory_destroy(run);
}

static void a_cradle_follows_the_reference(void **state)
{
    (void)state;
    const Scenario smooth = cradle(0.0);
    check_orders(&smooth, 4e-5, true);
    const Scenario rough = cradle(0.1);
    check_orders(&rough, 4e-5, false);
}

// The control of all of these: guides that are a micron further apart.
static void guides_a_micron_wider_are_seen(void **state)
{
    (void)state;
    const Scenario scenario = flores(false);
    Scenario wider = kept_copy(&scenario);
    wider.linkage.joints[SLIDER_GUIDE].guide.opening += 1e-6;
    Trajectory *truth = complete_run(&scenario, BACKEND_REFERENCE);
    Trajectory *run = ode_run(wider, &SCHEMES[1], 1.25e-6);
    assert_true(speed_error(run, truth) > 5e-4);
    trajectory_destroy(truth);
    trajectory_destroy(run);
}

// Between two steps the onset is found to the second order: the published case's first contact,
// whose slider does not tilt.
static void the_first_contact_has_the_published_approach_speed(void **state)
{
    (void)state;
    Scenario scenario = flores(false);
    scenario.linkage.bodies[2].start.omega = 0.0;
    for (size_t i = 1; i < SCHEME_COUNT; i++) {
        Trajectory *run = ode_run(scenario, &SCHEMES[i], 2e-6);
        const Spike *first = &run->joints[SLIDER_GUIDE].spikes[0];
        assert_int_equal(run->joints[SLIDER_GUIDE].impacts, 1);
        assert_near(first->onset_s, 2.69250275202e-3, 2e-6);
        assert_close(first->approach_speed, 0.841612322033, 1e-6);
        trajectory_destroy(run);
    }
    // plain stepping finds it up to a step late
    Trajectory *run = ode_run(scenario, &SCHEMES[0], 2e-6);
    assert_close(run->joints[SLIDER_GUIDE].spikes[0].approach_speed, 0.841612322033, 2e-3);
    trajectory_destroy(run);
}

static void force_and_couple_are_sums_over_the_corners(void **state)
{
    (void)state;
    const Scenario scenario = flores(false);
    Trajectory *truth = complete_run(&scenario, BACKEND_REFERENCE);
    Trajectory *run = ode_run(scenario, &SCHEMES[1], 1e-6);
    const JointExtremes *joint = &run->joints[SLIDER_GUIDE];
    const JointExtremes *true_joint = &truth->joints[SLIDER_GUIDE];
    assert_int_equal(joint->impacts, true_joint->impacts);
    assert_close(joint->force_max.value, true_joint->force_max.value, 1e-4);
    assert_close(joint->penetration_max.value, true_joint->penetration_max.value, 1e-4);
    assert_close(joint->impulse, true_joint->impulse, 1e-4);
    double most = 0.0;
    for (size_t k = 0; k < run->sample_count; k++) {
        const JointState *is = trajectory_state(run, k, SLIDER_GUIDE);
        const JointState *was = trajectory_state(truth, k, SLIDER_GUIDE);
        // means of a step, half a step aside
        assert_near(is->force_on_b.y, was->force_on_b.y, 1.5);
        assert_near(is->moment_on_b, was->moment_on_b, 0.1);
        assert_near(is->tilt, was->tilt, 1e-7);
        assert_near(is->gap, was->gap, 1e-8);
        assert_near(is->eccentricity.y, was->eccentricity.y, 1e-8);
        most = fmax(most, fabs(was->moment_on_b));
    }
    assert_true(most > 1.0);
    trajectory_destroy(truth);
    trajectory_destroy(run);
}

// Each time the ball comes back with the restitution's share of its speed.
static void a_bouncing_ball_keeps_the_share_of_its_speed_that_is_asked_for(void **state)
{
    (void)state;
    Scenario scenario = ball();
    // hard, so that its weight has no part in a contact
    scenario.contact.stiffness = 1e9;
    const double first = sqrt(-2.0 * scenario.gravity.y * 0.05);
    for (size_t i = 0; i < SCHEME_COUNT; i++) {
        Trajectory *run = ode_run(scenario, &SCHEMES[i], 5e-6);
        const JointExtremes *stop = &run->joints[0];
        // plain stepping lets a contact lose more or less, by how the steps fall, and that adds up
        const double tolerance = i == 0 ? 0.2 : 1e-2;
        double expected = first;
        assert_true(stop->spike_count >= 4);
        for (size_t k = 0; k < 4; k++) {
            assert_close(stop->spikes[k].approach_speed, expected, tolerance);
            expected *= scenario.contact.restitution;
        }
        trajectory_destroy(run);
    }
}

// A block that falls on a guide with two corners at once, the law linear.
static Scenario flat_block(double inertia, double restitution)
{
    Scenario scenario = free_run(8e-3, 100);
    scenario.gravity = scenario_downward(0.0);
    scenario.contact.stiffness = 1e6;
    scenario.contact.exponent = 1.0;
    scenario.contact.damping = DAMPING_EXACT;
    scenario.contact.restitution = restitution;
    set_body(&scenario, "block", 0.2, inertia,
             (Motion){.position = {0.0, -0.9e-3}, .velocity = {0.0, -0.1}});
    Joint *guide =
        set_joint(&scenario, JOINT_GUIDE, LINKAGE_GROUND, (Vec2){0.0, 0.0}, 0, (Vec2){0.0, 0.0});
    guide->guide = (Guide){.opening = 0.022, .height = 0.02, .length = 0.06};
    return scenario;
}

static double rebound(const Scenario *scenario, const Scheme *scheme, double step_s)
{
    Trajectory *run = ode_run(*scenario, scheme, step_s);
    const double speed = trajectory_motion(run, run->sample_count - 1, 0)->velocity.y;
    trajectory_destroy(run);
    return speed;
}

// The map exact needs the mass that a corner meets, and two that press together share the block:
// with it a rebound is the same at any step. The mass that one corner alone would meet makes these
// two differ by 8e-5 m/s.
static void corners_that_press_together_share_the_mass(void **state)
{
    (void)state;
    const Scenario scenario = flat_block(2e-3, 0.999999);
    const Scheme exact = {ODE_STAGGERED, ODE_MAP_EXACT, 1.0};
    const double fine = rebound(&scenario, &exact, 5e-5);
    assert_close(fine, 0.1, 5e-4);
    assert_near(rebound(&scenario, &exact, 2e-4), fine, 1e-6);
}

// A thin block rocks on its two corners faster than one of them alone would let it: that motion is
// the limit of stability, beyond which the map's rows would return 1.2 times the speed.
static void the_stiffest_motion_of_a_block_limits_the_map(void **state)
{
    (void)state;
    Scenario scenario = flat_block(1.5e-5, 0.999999);
    scenario.linkage.bodies[0].start.angle = 1e-6;
    const double of_one = sqrt(1e6 * (1.0 / 0.2 + 0.03 * 0.03 / 1.5e-5)); // rad/s, at one corner
    Trajectory *below = ode_run(scenario, &SCHEMES[1], 1.4 / of_one);
    Trajectory *above = ode_run(scenario, &SCHEMES[1], 1.8 / of_one);
    assert_int_equal(below->fallback_rows, 0);
    assert_true(above->fallback_rows > 0);
    assert_true(above->energy.residual > -1e-6);
    assert_true(trajectory_motion(above, above->sample_count - 1, 0)->velocity.y < 0.1);
    trajectory_destroy(below);
    trajectory_destroy(above);
}

static void colliders_of_pins_refuse_guides_and_stops(void **state)
{
    (void)state;
    Scenario scenarios[] = {flores(false), ball()};
    const char *const words[] = {"is a block between guides; use collider pin-hole",
                                 "is a stop; use collider pin-hole"};
    for (size_t i = 0; i < 2; i++) {
        scenarios[i].ode.stepping = ODE_STAGGERED;
        scenarios[i].ode.map = ODE_MAP_MIDPOINT;
        scenarios[i].ode.collider = ODE_COLLIDER_STAVES;
        scenarios[i].run.step = 1e-5;
        Trajectory *run = run_scenario(&scenarios[i], registry_solver(BACKEND_ODE), (RunWatch){0});
        assert_false(run->is_complete);
        assert_non_null(strstr(run->message, words[i]));
        trajectory_destroy(run);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_block_between_guides_follows_the_reference),
        cmocka_unit_test(a_sleeve_on_a_moving_body_follows_the_reference),
        cmocka_unit_test(guides_on_the_driven_body_follow_the_reference),
        cmocka_unit_test(the_drive_works_as_in_the_reference),
        cmocka_unit_test(a_cradle_follows_the_reference),
        cmocka_unit_test(guides_a_micron_wider_are_seen),
        cmocka_unit_test(the_first_contact_has_the_published_approach_speed),
        cmocka_unit_test(force_and_couple_are_sums_over_the_corners),
        cmocka_unit_test(a_bouncing_ball_keeps_the_share_of_its_speed_that_is_asked_for),
        cmocka_unit_test(corners_that_press_together_share_the_mass),
        cmocka_unit_test(the_stiffest_motion_of_a_block_limits_the_map),
        cmocka_unit_test(colliders_of_pins_refuse_guides_and_stops),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
