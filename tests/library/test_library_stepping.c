// Do steps have the order that is claimed, read by ODE's own getters, and do they leave all else of
// a world alone?
#include "close.h"

#include "ode_group.h"

#include <jointplay/jointplay.h>

#include <ode/ode.h>
#include <string.h>

#define must(call) assert_int_equal((call), JP_OK)

// A step that is made, coarse or not: how right it has to be is asserted of what comes of it.
#define must_step(call) assert_true((call) <= JP_OK)

static JpWorld *make_world(dWorldID world, JpStepping stepping)
{
    JpWorldOptions options = jp_world_options_default();
    options.stepping = stepping;
    JpWorld *play = NULL;
    must(jp_world_create(world, &options, &play, NULL));
    return play;
}

static dBodyID make_body(dWorldID world, double mass, double xx, double yy, double zz)
{
    dMass data;
    dMassSetParameters(&data, mass, 0, 0, 0, xx, yy, zz, 0, 0, 0);
    const dBodyID body = dBodyCreate(world);
    dBodySetMass(body, &data);
    return body;
}

// A classic Runge-Kutta step of a state of up to three numbers.
typedef void (*Rates)(const double state[3], double rates[3]);

static void truth_step(Rates rates, double step, double state[3])
{
    double k[4][3];
    double at[3];
    static const double SHARES[] = {0.0, 0.5, 0.5, 1.0};
    for (int stage = 0; stage < 4; stage++) {
        for (int i = 0; i < 3; i++) {
            at[i] = state[i] + (stage > 0 ? SHARES[stage] * step * k[stage - 1][i] : 0.0);
        }
        rates(at, k[stage]);
    }
    for (int i = 0; i < 3; i++) {
        state[i] += step / 6.0 * (k[0][i] + 2.0 * (k[1][i] + k[2][i]) + k[3][i]);
    }
}

// A rod of 1 kg and .01 kg m^2, its middle .3 m from its hinge, let go level.
static const double ARM = 0.3;
static const double ABOUT_PIVOT = 0.01 + 0.09;

static void pendulum_rates(const double state[3], double rates[3])
{
    rates[0] = state[1];
    rates[1] = -9.81 * ARM * cos(state[0]) / ABOUT_PIVOT;
    rates[2] = 0.0;
}

// A level arm on a hinge about z, under gravity.
static dJointID hang_arm(dWorldID world)
{
    dWorldSetGravity(world, 0, -9.81, 0);
    dWorldSetERP(world, 1.0); // what the hinge is open by is (h^2/2) / ERP times its arm's
    const dBodyID body = make_body(world, 1.0, 0.02, 0.02, 0.01);
    dBodySetPosition(body, ARM, 0, 0);
    const dJointID hinge = dJointCreateHinge(world, 0);
    dJointAttach(hinge, body, 0);
    dJointSetHingeAnchor(hinge, 0, 0, 0);
    dJointSetHingeAxis(hinge, 0, 0, 1);
    return hinge;
}

static double pendulum_error(JpStepping stepping, int steps)
{
    double truth[3] = {0.0};
    for (int i = 0; i < 10000; i++) {
        truth_step(pendulum_rates, 1e-4, truth);
    }
    const dWorldID world = dWorldCreate();
    const dJointID hinge = hang_arm(world);
    JpWorld *play = make_world(world, stepping);
    JpJoint *joint = NULL;
    JpStops stops = jp_stops_default();
    stops.contact.stiffness = 1.0;
    must(jp_stops_create(play, hinge, &stops, &joint, NULL));
    for (int i = 0; i < steps; i++) {
        must_step(jp_world_step(play, 1.0 / steps, NULL));
    }
    const double angle = remainder(dJointGetHingeAngle(hinge) - truth[0], 6.283185307179586);
    const double error = fabs(angle) + fabs(dJointGetHingeAngleRate(hinge) - truth[1]);
    jp_world_destroy(play);
    dWorldDestroy(world);
    return error;
}

static void a_pendulum_has_order_two_staggered_and_one_plain(void **state)
{
    (void)state;
    const double staggered =
        pendulum_error(JP_STEPPING_STAGGERED, 1000) / pendulum_error(JP_STEPPING_STAGGERED, 2000);
    const double plain =
        pendulum_error(JP_STEPPING_PLAIN, 1000) / pendulum_error(JP_STEPPING_PLAIN, 2000);
    assert_near(staggered, 4.0, 0.3);
    assert_near(plain, 2.0, 0.3);
    // 3.4e-4 beside 3.9e-3
    assert_true(pendulum_error(JP_STEPPING_STAGGERED, 1000) <
                0.1 * pendulum_error(JP_STEPPING_PLAIN, 1000));
}

// The same rod bounces on a stop of 1e6 N m/rad without loss; each contact lasts a millisecond.
static const double STOP = -0.5;
static const double STIFFNESS = 1e6;

static void bouncing_rates(const double state[3], double rates[3])
{
    pendulum_rates(state, rates);
    rates[1] += STIFFNESS * fmax(STOP - state[0], 0.0) / ABOUT_PIVOT;
}

static double bouncing_error(JpStepping stepping, int steps, JpWorldStats *stats)
{
    static double truth[3];
    if (truth[0] == 0.0) {
        for (int i = 0; i < 8000000; i++) {
            truth_step(bouncing_rates, 1.25e-7, truth);
        }
    }
    const dWorldID world = dWorldCreate();
    const dJointID hinge = hang_arm(world);
    JpWorld *play = make_world(world, stepping);
    JpJoint *joint = NULL;
    JpStops stops = jp_stops_default();
    stops.low = STOP;
    stops.contact.stiffness = STIFFNESS;
    stops.contact.damping = JP_DAMPING_NONE;
    must(jp_stops_create(play, hinge, &stops, &joint, NULL));
    for (int i = 0; i < steps; i++) {
        must_step(jp_world_step(play, 1.0 / steps, NULL));
    }
    JpJointState now;
    must(jp_joint_state(joint, &now, NULL));
    must(jp_world_stats(play, stats, NULL));
    jp_world_destroy(play);
    dWorldDestroy(world);
    assert_true(now.low.impacts >= 2);
    return fabs(now.position - truth[0]) + 0.1 * fabs(now.speed - truth[1]);
}

static void contacts_within_a_step_have_order_two(void **state)
{
    (void)state;
    JpWorldStats stats;
    const double coarse = bouncing_error(JP_STEPPING_IMPULSE, 500, &stats);
    // one step of ODE where nothing touches, five where something does; beside each of three
    // contacts three while joints are kept closed, in some 18 steps, one that opens them, and two
    // where the contact has turned the rod round
    assert_true(stats.world_steps <= 500 + 4 * stats.rows + 3 * 39 && stats.fallbacks == 0);
    // over a factor of 4 in the step: what is left are 1.5e-5 and 7.7e-7
    const double middle = bouncing_error(JP_STEPPING_IMPULSE, 1000, &stats);
    const double fine = bouncing_error(JP_STEPPING_IMPULSE, 4000, &stats);
    assert_near(log2(middle / fine) / 2.0, 2.0, 0.3);
    // 1.7e-5; rows see a contact of a millisecond in no step of two
    assert_true(bouncing_error(JP_STEPPING_STAGGERED, 500, &stats) > 20.0 * coarse);
}

// A disc of .01 kg m^2 that is .5 ms deep in a stop, in steps of 10 us, becomes one of .02; after
// .5 ms more its depth is off by a share.
static double heavier_error(bool is_known)
{
    const double step = 10e-6;
    const double speed = 2.0;
    const double stiffness = 1e4;
    const double inertias[2] = {0.01, 0.02};
    const dWorldID world = dWorldCreate();
    const dBodyID body = make_body(world, 1.0, inertias[0], inertias[0], inertias[0]);
    dBodySetAngularVel(body, 0, 0, speed);
    const dJointID hinge = dJointCreateHinge(world, 0);
    dJointAttach(hinge, body, 0);
    dJointSetHingeAxis(hinge, 0, 0, 1);
    dJointSetHingeParam(hinge, dParamFMax, 1e-9); // too weak to be seen, but a bound
    JpWorld *play = make_world(world, JP_STEPPING_IMPULSE);
    JpJoint *joint = NULL;
    JpStops stops = jp_stops_default();
    stops.high = 0.02; // reached after 10 ms
    stops.contact.stiffness = stiffness;
    stops.contact.damping = JP_DAMPING_NONE;
    must(jp_stops_create(play, hinge, &stops, &joint, NULL));
    for (int i = 0; i < 1100; i++) {
        if (i == 1050) {
            dMass heavy;
            dMassSetParameters(&heavy, 1.0, 0, 0, 0, inertias[1], inertias[1], inertias[1], 0, 0,
                               0);
            dBodySetMass(body, &heavy);
        }
        must_step(jp_world_step(play, step, NULL));
    }
    JpWorldStats stats;
    must(jp_world_stats(play, &stats, NULL));
    assert_int_equal(stats.fallbacks, 0);
    // some answers are those of steps before: of the three steps of ODE that each takes
    assert_true(stats.world_steps < 1100 + 5 * stats.rows / 2);
    const double first = sqrt(stiffness / inertias[0]);
    const double then = is_known ? sqrt(stiffness / inertias[1]) : first;
    const double depth = speed / first * sin(first * 0.5e-3);
    const double rate = speed * cos(first * 0.5e-3);
    const double truth = depth * cos(then * 0.5e-3) + rate / then * sin(then * 0.5e-3);
    JpJointState now;
    must(jp_joint_state(joint, &now, NULL));
    jp_world_destroy(play);
    dWorldDestroy(world);
    return fabs(-now.high.gap - truth) / truth;
}

static void a_world_that_changes_within_a_contact_is_answered_anew(void **state)
{
    (void)state;
    assert_true(heavier_error(true) < 1e-6);
    // the control: the disc as it was
    assert_true(heavier_error(false) > 1e-2);
}

// The rod's hinge where somebody reads its force, and where nobody does: after a step in which the
// stop pressed.
typedef struct Constants {
    double angle;
    double rate;
    double gained[2]; // N s in x and y, of the rod in the step
    double held[2];   // N s likewise, of the hinge as it is read
} Constants;

static Constants pressed_arm(bool is_read)
{
    const double step = 1e-4;
    const dWorldID world = dWorldCreate();
    const dJointID hinge = hang_arm(world);
    const dBodyID rod = dJointGetBody(hinge, 0);
    JpWorld *play = make_world(world, JP_STEPPING_IMPULSE);
    JpJoint *joint = NULL;
    JpStops stops = jp_stops_default();
    stops.low = STOP;
    stops.contact.stiffness = STIFFNESS;
    must(jp_stops_create(play, hinge, &stops, &joint, NULL));
    dJointFeedback feedback = {{0.0}, {0.0}, {0.0}, {0.0}};
    dJointSetFeedback(hinge, is_read ? &feedback : NULL);
    JpJointState now = {0};
    Constants held = {0};
    for (int i = 0; i < 4000 && now.low.force < 1000.0; i++) {
        const dReal *velocity = dBodyGetLinearVel(rod);
        const double before[2] = {velocity[0], velocity[1]};
        must_step(jp_world_step(play, step, NULL));
        must(jp_joint_state(joint, &now, NULL));
        velocity = dBodyGetLinearVel(rod);
        for (int k = 0; k < 2; k++) {
            held.gained[k] = velocity[k] - before[k]; // of 1 kg
            held.held[k] = step * feedback.f1[k];
        }
    }
    assert_true(now.low.force >= 1000.0);
    held.gained[1] += step * 9.81;
    held.angle = now.position;
    held.rate = now.speed;
    jp_world_destroy(play);
    dWorldDestroy(world);
    return held;
}

static void a_joint_that_is_read_moves_alike_and_shows_its_force(void **state)
{
    (void)state;
    const Constants alone = pressed_arm(false);
    const Constants read = pressed_arm(true);
    assert_near(read.angle, alone.angle, 1e-12);
    assert_near(read.rate, alone.rate, 1e-9);
    // a step that closes velocities holds a thousandth of that
    const double size = hypot(read.gained[0], read.gained[1]);
    assert_true(size > 0.1);
    assert_near(read.held[0], read.gained[0], 0.01 * size);
    assert_near(read.held[1], read.gained[1], 0.01 * size);
    // the control
    assert_near(hypot(alone.held[0], alone.held[1]), 0.0, 0.0);
}

// A disc that a motor at its limit brakes like dry friction, .5 N m on .01 kg m^2, hits a stop and
// comes back: the brake turns round within the step of the impact, so that the world answers to
// pushes by no straight line. After .03 s it is still turning back.
static JpJointState braked(JpStepping stepping, int steps_a_second, JpWorldStats *stats)
{
    const dWorldID world = dWorldCreate();
    const dBodyID body = make_body(world, 1.0, 0.01, 0.01, 0.01);
    dBodySetAngularVel(body, 0, 0, 2.0);
    const dJointID hinge = dJointCreateHinge(world, 0);
    dJointAttach(hinge, body, 0);
    dJointSetHingeAxis(hinge, 0, 0, 1);
    dJointSetHingeParam(hinge, dParamFMax, 0.5);
    JpWorld *play = make_world(world, stepping);
    JpJoint *joint = NULL;
    JpStops stops = jp_stops_default();
    stops.high = 0.02;
    stops.contact.stiffness = 1e4;
    stops.contact.restitution = 0.8;
    must(jp_stops_create(play, hinge, &stops, &joint, NULL));
    for (int i = 0; i < 3 * steps_a_second / 100; i++) {
        must_step(jp_world_step(play, 1.0 / steps_a_second, NULL));
    }
    JpJointState now;
    must(jp_joint_state(joint, &now, NULL));
    must(jp_world_stats(play, stats, NULL));
    jp_world_destroy(play);
    dWorldDestroy(world);
    assert_int_equal(now.high.impacts, 1);
    return now;
}

static void a_motor_at_its_limit_is_met_again_or_counted(void **state)
{
    (void)state;
    JpWorldStats stats;
    const JpJointState truth = braked(JP_STEPPING_STAGGERED, 64000, &stats);
    assert_near(truth.high.impact_speed, sqrt(2.0), 1e-5);
    const JpJointState middle = braked(JP_STEPPING_IMPULSE, 1000, &stats);
    assert_int_equal(stats.fallbacks, 0);
    assert_near(middle.position, truth.position, 3e-5);
    assert_near(middle.speed, truth.speed, 1e-3);
    // a step of 4 ms is longer than the contact, and sees the brake turn round
    const JpJointState coarse = braked(JP_STEPPING_IMPULSE, 250, &stats);
    assert_true(stats.fallbacks > 0);
    assert_true(fabs(coarse.speed - truth.speed) > 1e-2);
}

static const double INERTIAS[3] = {0.01, 0.02, 0.025};

static void top_rates(const double state[3], double rates[3])
{
    for (int i = 0; i < 3; i++) {
        const int j = (i + 1) % 3;
        const int k = (i + 2) % 3;
        rates[i] = (INERTIAS[j] - INERTIAS[k]) / INERTIAS[i] * state[j] * state[k];
    }
}

static double top_error(JpStepping stepping, int steps)
{
    double truth[3] = {0.5, 4.0, 0.3}; // about the middle axis, which tumbles
    for (int i = 0; i < 10000; i++) {
        truth_step(top_rates, 2e-4, truth);
    }
    const dWorldID world = dWorldCreate();
    const dBodyID body = make_body(world, 1.0, INERTIAS[0], INERTIAS[1], INERTIAS[2]);
    dBodySetAngularVel(body, 0.5, 4.0, 0.3);
    JpWorld *play = make_world(world, stepping);
    must(jp_world_add_body(play, body, NULL));
    for (int i = 0; i < steps; i++) {
        must_step(jp_world_step(play, 2.0 / steps, NULL));
    }
    dVector3 local;
    const dReal *omega = dBodyGetAngularVel(body);
    dBodyVectorFromWorld(body, omega[0], omega[1], omega[2], local);
    double error = 0.0;
    for (int i = 0; i < 3; i++) {
        error = fmax(error, fabs(local[i] - truth[i]));
    }
    assert_true(dBodyGetGyroscopicMode(body));
    jp_world_destroy(play);
    dWorldDestroy(world);
    return error;
}

static void a_tumbling_body_has_order_two(void **state)
{
    (void)state;
    const double coarse = top_error(JP_STEPPING_STAGGERED, 1000);
    assert_near(coarse / top_error(JP_STEPPING_STAGGERED, 2000), 4.0, 0.4);
    // ODE's own torque
    assert_true(top_error(JP_STEPPING_PLAIN, 1000) > 10.0 * coarse);
}

// A body that is not known stays untouched by a step that has to try something.
static void bodies_that_are_not_known_are_asked_for(void **state)
{
    (void)state;
    const dWorldID world = dWorldCreate();
    const dBodyID rod = make_body(world, 1.0, 0.001, 0.001, 0.001);
    dBodySetPosition(rod, 0.3, 0, 0);
    const dJointID hinge = dJointCreateHinge(world, 0);
    dJointAttach(hinge, rod, 0);
    dJointSetHingeAnchor(hinge, 0, 0, 0);
    dJointSetHingeAxis(hinge, 0, 0, 1);
    const dBodyID stranger = make_body(world, 1.0, 1.0, 1.0, 1.0);
    dBodySetPosition(stranger, 5, 0, 0);
    dBodySetLinearVel(stranger, 0, 1, 0);
    JpWorld *play = make_world(world, JP_STEPPING_STAGGERED);
    JpJoint *joint = NULL;
    JpStops stops = jp_stops_default();
    stops.high = -1e-3; // inside it
    stops.contact.stiffness = 1e4;
    must(jp_stops_create(play, hinge, &stops, &joint, NULL));
    const double step = 1e-3; // omega h of the rod alone is 3.2
    JpError error;
    assert_int_equal(jp_world_step(play, step, &error), JP_ERROR_WORLD);
    assert_non_null(strstr(error.text, "1 bodies of the world"));
    assert_near(dBodyGetPosition(stranger)[1], 0.0, 0.0);
    assert_near(dBodyGetPosition(rod)[0], 0.3, 1e-15);
    must(jp_world_add_body(play, stranger, NULL));
    must_step(jp_world_step(play, step, NULL));
    assert_near(dBodyGetPosition(stranger)[1], step, 1e-15);
    must(jp_world_remove_body(play, stranger, NULL));
    jp_world_destroy(play);
    dWorldDestroy(world);
}

// Where contacts are asked for.
typedef struct Asked {
    dBodyID body;
    double height;
    int times;
} Asked;

static void ask(dWorldID world, void *data)
{
    (void)world;
    Asked *asked = data;
    asked->height = dBodyGetPosition(asked->body)[2];
    asked->times++;
}

static void contacts_are_asked_for_at_mid_step(void **state)
{
    (void)state;
    const dWorldID world = dWorldCreate();
    Asked asked = {.body = make_body(world, 1.0, 1.0, 1.0, 1.0)};
    dBodySetLinearVel(asked.body, 0, 0, 2.0);
    JpWorldOptions options = jp_world_options_default();
    options.collide = ask;
    options.collide_data = &asked;
    JpWorld *play = NULL;
    must(jp_world_create(world, &options, &play, NULL));
    must(jp_world_add_body(play, asked.body, NULL));
    must_step(jp_world_step(play, 0.1, NULL));
    assert_int_equal(asked.times, 1);
    assert_near(asked.height, 0.1, 1e-15);
    assert_near(dBodyGetPosition(asked.body)[2], 0.2, 1e-15);
    jp_world_destroy(play);
    dWorldDestroy(world);
}

// A contact that was under way when its joint was made.

typedef struct Lift {
    double rest_rate; // m/s^2, with which the body is pulled off its stop
    double stiffness; // N/m^1.5
    double damping;   // s/m, of F = K d^1.5 (1 + damping d')
} Lift;

static double lift_acceleration(const Lift *lift, double position, double speed)
{
    const double depth = fmax(-position, 0.0);
    const double force = lift->stiffness * pow(depth, 1.5) * (1.0 - lift->damping * speed);
    return lift->rest_rate + (position < 0.0 ? fmax(force, 0.0) : 0.0);
}

// Of a mass of 1 kg, by the classical rule in many steps.
static double lift_truth(const Lift *lift, double position, double duration)
{
    enum { STEPS = 200000 };
    const double h = duration / STEPS;
    double speed = 0.0;
    for (int i = 0; i < STEPS; i++) {
        const double a = lift_acceleration(lift, position, speed);
        const double b = lift_acceleration(lift, position + 0.5 * h * speed, speed + 0.5 * h * a);
        const double c = lift_acceleration(lift, position + 0.5 * h * (speed + 0.5 * h * a),
                                           speed + 0.5 * h * b);
        const double d =
            lift_acceleration(lift, position + h * (speed + 0.5 * h * b), speed + h * c);
        position += h * (speed + h * (a + b + c) / 6.0);
        speed += h * (a + 2.0 * b + 2.0 * c + d) / 6.0;
    }
    return speed;
}

// Pulled off its stop so fast that the damping takes all of the force while the spring is still
// compressed. Such a force that ends is of no size by which an error could be measured: the speed
// with which the contact began is.
static void a_contact_under_way_is_followed_to_its_end(void **state)
{
    (void)state;
    const Lift lift = {.rest_rate = 31.0, .stiffness = 1e10, .damping = 200.0};
    const double depth = 2e-6;
    const double step = 2.5e-4;
    const dWorldID world = dWorldCreate();
    dWorldSetGravity(world, lift.rest_rate, 0, 0);
    const dBodyID body = dBodyCreate(world);
    dMass mass;
    dMassSetParameters(&mass, 1.0, 0, 0, 0, 1.0, 1.0, 1.0, 0, 0, 0);
    dBodySetMass(body, &mass);
    const dJointID slider = dJointCreateSlider(world, 0);
    dJointAttach(slider, body, 0);
    dJointSetSliderAxis(slider, 1, 0, 0);
    JpWorld *play;
    JpWorldOptions options = jp_world_options_default();
    options.stepping = JP_STEPPING_IMPULSE;
    must(jp_world_create(world, &options, &play, NULL));
    JpStops stops = jp_stops_default();
    stops.low = depth;
    stops.contact.stiffness = lift.stiffness;
    stops.contact.exponent = 1.5;
    stops.contact.damping = JP_DAMPING_DISSIPATION;
    stops.contact.dissipation = lift.damping;
    JpJoint *joint;
    must(jp_stops_create(play, slider, &stops, &joint, NULL));
    must(jp_joint_begun(joint, 0, &(JpBegun){.impact_speed = 0.01, .age = 1e-3}, NULL));
    must(jp_world_step(play, step, NULL)); // neither coarse nor without end
    // where the damping has taken all of the force, the force has a corner within the step
    assert_close(dBodyGetLinearVel(body)[0], lift_truth(&lift, -depth, step), 1e-3);
    // the control: without the stop
    assert_true(fabs(lift_truth(&lift, -depth, step) / (lift.rest_rate * step) - 1.0) > 1e-2);
    jp_world_destroy(play);
    dWorldDestroy(world);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_pendulum_has_order_two_staggered_and_one_plain),
        cmocka_unit_test(contacts_within_a_step_have_order_two),
        cmocka_unit_test(a_world_that_changes_within_a_contact_is_answered_anew),
        cmocka_unit_test(a_joint_that_is_read_moves_alike_and_shows_its_force),
        cmocka_unit_test(a_motor_at_its_limit_is_met_again_or_counted),
        cmocka_unit_test(a_tumbling_body_has_order_two),
        cmocka_unit_test(bodies_that_are_not_known_are_asked_for),
        cmocka_unit_test(contacts_are_asked_for_at_mid_step),
        cmocka_unit_test(a_contact_under_way_is_followed_to_its_end),
    };
    return cmocka_run_group_tests(tests, ode_group_setup, ode_group_teardown);
}
