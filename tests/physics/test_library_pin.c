// Does a pin in its hole, made by the library in a world that it did not build, do what the law and
// the reference say?
//
// Outside truths: the law of an impact of two masses, the reference of the paper's four-bar, and
// the momentum and energy of a free body.
#include "close.h"

#include "hand_four_bar.h"

#include "complete_run.h"
#include "load_case.h"

#include <string.h>

#define must(call) assert_int_equal((call), JP_OK)

// A step that is made, coarse or not: how right it has to be is asserted of what comes of it.
#define must_step(call) assert_true((call) <= JP_OK)

// A rod that flies in the hole of the world.
typedef struct Bench {
    dWorldID world;
    dBodyID body;
    JpWorld *play;
    JpJoint *pin;
} Bench;

static const double MASS = 0.5;
static const double CLEARANCE = 5e-3;

static JpPinInHole loose_pin(void)
{
    JpPinInHole pin = jp_pin_default();
    pin.hole_radius = 0.01;
    pin.pin_radius = pin.hole_radius - CLEARANCE;
    pin.contact.stiffness = 1e10;
    pin.contact.exponent = 1.5;
    pin.contact.restitution = 0.7;
    return pin;
}

static Bench bench_make(JpStepping stepping, const JpPinInHole *pin)
{
    Bench bench = {.world = dWorldCreate()};
    bench.body = dBodyCreate(bench.world);
    dMass mass;
    dMassSetParameters(&mass, MASS, 0, 0, 0, 1e-4, 2e-4, 2e-4, 0, 0, 0);
    dBodySetMass(bench.body, &mass);
    JpWorldOptions options = jp_world_options_default();
    options.stepping = stepping;
    must(jp_world_create(bench.world, &options, &bench.play, NULL));
    must(jp_pin_create(bench.play, NULL, bench.body, pin, &bench.pin, NULL));
    return bench;
}

static void bench_finish(Bench *bench)
{
    jp_world_destroy(bench->play);
    dWorldDestroy(bench->world);
}

// How far one straight impact at a wall is off.
typedef struct Off {
    double restitution;
    double peak;
} Off;

static Off straight_impact(JpStepping stepping, double steps_a_contact, double phase)
{
    const JpPinInHole pin = loose_pin();
    Bench bench = bench_make(stepping, &pin);
    const double speed = 0.8;
    JpImpact law;
    must(jp_impact_of_law(&pin.contact, MASS, speed, &law, NULL));
    const double step = law.duration / steps_a_contact;
    dBodySetPosition(bench.body, (CLEARANCE - (3.0 + phase) * step * speed) * 0.6,
                     (CLEARANCE - (3.0 + phase) * step * speed) * 0.8, 0);
    dBodySetLinearVel(bench.body, 0.6 * speed, 0.8 * speed, 0);
    JpPinState state;
    do {
        must_step(jp_world_step(bench.play, step, NULL));
        must(jp_pin_state(bench.pin, &state, NULL));
    } while (state.ends[0].impacts == 0 || state.is_touching || state.ends[0].force > 0.0);
    const dReal *velocity = dBodyGetLinearVel(bench.body);
    const double back = -0.6 * velocity[0] - 0.8 * velocity[1];
    assert_int_equal(state.end_count, 1);
    assert_int_equal(state.ends[0].impacts, 1);
    assert_near(state.ends[0].impact_speed, speed, 1e-3 * speed);
    // what the contact took is what the body has lost
    assert_near(state.ends[0].work, 0.5 * MASS * (back * back - speed * speed),
                1e-5 * MASS * speed * speed);
    assert_near(state.ends[0].impulse, MASS * (back + speed), 1e-5 * MASS * speed);
    bench_finish(&bench);
    return (Off){
        .restitution = fabs(back / speed / law.restitution - 1.0),
        .peak = fabs(state.ends[0].force_max / law.peak - 1.0),
    };
}

static void a_pin_rebounds_as_asked(void **state)
{
    (void)state;
    for (int i = 0; i < 8; i++) {
        const double phase = (i + 0.5) / 8.0;
        const Off rows = straight_impact(JP_STEPPING_STAGGERED, 10.0, phase);
        assert_near(rows.restitution, 0.0, 0.01);
        assert_near(rows.peak, 0.0, 0.01);
        // at any step
        const Off inside = straight_impact(JP_STEPPING_IMPULSE, 0.3 + 2.0 * i, phase);
        assert_near(inside.restitution, 0.0, 1e-4);
        assert_near(inside.peak, 0.0, 1e-3);
    }
    // the control: so few steps that rows know nothing of the law
    assert_true(straight_impact(JP_STEPPING_STAGGERED, 1.5, 0.5).restitution > 0.1);
}

// The program's words for a stepping, and the library's, with the ERP of the hinges made by hand.
typedef struct Way {
    const char *stepping;
    const char *map;
    JpStepping library;
    double erp;
} Way;

static const Way PLAIN = {"ode.stepping=plain", "ode.map=corrected", JP_STEPPING_PLAIN, 1.5};
static const Way STAGGERED = {"ode.stepping=staggered", "ode.map=midpoint", JP_STEPPING_STAGGERED,
                              1.5};
static const Way IMPULSE = {"ode.stepping=staggered", "ode.map=impulse", JP_STEPPING_IMPULSE, 1.5};
static const Way ERP_1 = {"ode.stepping=staggered", "ode.map=impulse", JP_STEPPING_IMPULSE, 1.0};

// The first twentieth of a turn of the paper's four-bar, with three impacts.
static const double SAMPLE_S = 20e-6;

static Scenario paper(const Way *way, double step_s, bool is_frozen)
{
    char step[64];
    snprintf(step, sizeof step, "run.step=%.17g s", step_s);
    const char *const overrides[] = {"run.revolutions=0.05", "run.samples=3000", step,
                                     way->stepping, way->map};
    Scenario scenario = load("cases/paper/impact-k66.yaml", overrides, 5);
    scenario.ode.is_frozen = is_frozen;
    return scenario;
}

static double program_error(const Scenario *scenario, const Trajectory *truth)
{
    Trajectory *run = complete_run(scenario, BACKEND_ODE);
    const double error = hand_four_bar_run_error(run, truth);
    trajectory_destroy(run);
    return error;
}

static double library_error(const Scenario *scenario, const Way *way, const Trajectory *truth)
{
    const HandOptions options = hand_four_bar_options(scenario, way->library, way->erp);
    HandMotion start[HAND_BODIES];
    hand_four_bar_start(truth, start);
    HandFourBar bar;
    assert_true(hand_four_bar_make(&options, start, &bar, NULL));
    double error = 0.0;
    for (size_t k = 1; k < truth->sample_count; k++) {
        for (long i = lround(SAMPLE_S / scenario->run.step); i > 0; i--) {
            must_step(jp_world_step(bar.play, scenario->run.step, NULL));
        }
        error = fmax(error, hand_four_bar_error(&bar, truth, k));
    }
    JpWorldStats stats;
    must(jp_world_stats(bar.play, &stats, NULL));
    assert_int_equal(stats.fallbacks, 0);
    hand_four_bar_destroy(&bar);
    return error;
}

// The library's error by that of the program at the same step, whose response to contacts does not
// change within it.
static double error_ratio(const Way *way, double step_s, double *error)
{
    const Scenario scenario = paper(way, step_s, true);
    Trajectory *truth = complete_run(&scenario, BACKEND_REFERENCE);
    *error = library_error(&scenario, way, truth);
    const double ratio = *error / program_error(&scenario, truth);
    trajectory_destroy(truth);
    return ratio;
}

static void coarse_steps_are_as_right_as_the_programs(void **state)
{
    (void)state;
    static const double STEPS_S[] = {20e-6, 10e-6};
    for (size_t i = 0; i < sizeof STEPS_S / sizeof *STEPS_S; i++) {
        const Scenario scenario = paper(&IMPULSE, STEPS_S[i], false);
        const Scenario frozen = paper(&IMPULSE, STEPS_S[i], true);
        Trajectory *truth = complete_run(&scenario, BACKEND_REFERENCE);
        const double error = library_error(&scenario, &IMPULSE, truth);
        // 1.3e-6 and some less beside 5.1e-7
        assert_true(error < 3.0 * program_error(&scenario, truth));
        // the control: without that change
        assert_true(program_error(&frozen, truth) > 4.0 * error);
        trajectory_destroy(truth);
    }
}

static void a_four_bar_made_by_hand_is_as_right_as_the_programs(void **state)
{
    (void)state;
    double coarse;
    double fine;
    double finest;
    double rows;
    double plain;
    assert_true(error_ratio(&IMPULSE, 20e-6, &coarse) < 2.0);
    assert_true(error_ratio(&IMPULSE, 5e-6, &fine) < 1.5);
    assert_true(error_ratio(&IMPULSE, 2e-6, &finest) < 1.5);
    // 5.9e-7 and 9.6e-8 in a whole turn
    assert_near(log(fine / finest) / log(2.5), 2.0, 0.3);
    // which velocities that are not closed miss: 2.0 and 2.2 times the program's error
    assert_true(error_ratio(&ERP_1, 5e-6, &finest) < 1.7);
    assert_true(error_ratio(&ERP_1, 2e-6, &finest) < 1.7);
    assert_near(error_ratio(&STAGGERED, 5e-6, &rows), 1.0, 0.1);
    // the controls: rows, whose step does not resolve the contact as well, and ODE's own step
    assert_true(rows > 100.0 * fine);
    assert_true(error_ratio(&PLAIN, 5e-6, &plain) < 2.0);
    assert_true(plain > 3.0 * rows);
}

// A pin askew in a wide hole, which a torque turns until both ends of the hole stop it.
static void a_pin_tilts_until_both_ends_touch(void **state)
{
    (void)state;
    JpPinInHole given = loose_pin();
    given.pin_radius = given.hole_radius - 1e-4;
    given.width = 0.03;
    given.contact.restitution = 0.3;
    Bench bench = bench_make(JP_STEPPING_IMPULSE, &given);
    const double torque = 2.0;
    for (int i = 0; i < 3000; i++) {
        dBodyAddTorque(bench.body, torque, 0, 0);
        must_step(jp_world_step(bench.play, 20e-6, NULL));
    }
    JpPinState now;
    must(jp_pin_state(bench.pin, &now, NULL));
    // a couple of two forces, each with half of the law: F w cos(phi) = T
    const double depth = pow(torque / given.width / (0.5 * given.contact.stiffness), 1.0 / 1.5);
    const double sine = 2.0 * (1e-4 + depth) / given.width;
    assert_int_equal(now.end_count, 2);
    assert_near(sin(now.tilt), sine, 1e-4 * sine);
    assert_near(now.ends[0].force, torque / given.width, 1e-3 * torque / given.width);
    assert_near(now.ends[1].force, now.ends[0].force, 1e-3 * now.ends[0].force);
    // the control: with the play alone
    assert_true(fabs(sin(now.tilt) / (2.0 * 1e-4 / given.width) - 1.0) > 0.05);
    bench_finish(&bench);
}

// Two bodies that fly with a wide, rubbing pin and collars between them.
typedef struct Tumble {
    dWorldID world;
    dBodyID bodies[2];
    JpWorld *play;
    JpJoint *pin;
} Tumble;

static Tumble tumble_make(double friction)
{
    Tumble tumble = {.world = dWorldCreate()};
    dMass mass;
    for (int i = 0; i < 2; i++) {
        tumble.bodies[i] = dBodyCreate(tumble.world);
        dMassSetParameters(&mass, 0.4 + i, 0, 0, 0, 1e-3, 2e-3, 1.5e-3, 0, 0, 0);
        dBodySetMass(tumble.bodies[i], &mass);
    }
    dBodySetLinearVel(tumble.bodies[1], 0.3, -0.2, 0.1);
    dBodySetAngularVel(tumble.bodies[1], 1, 2, 6);
    JpPinInHole pin = loose_pin();
    pin.pin_radius = pin.hole_radius - 1e-4;
    pin.width = 0.03;
    pin.axial_play = 2e-4;
    pin.friction = friction;
    JpWorldOptions options = jp_world_options_default();
    options.stepping = JP_STEPPING_IMPULSE;
    must(jp_world_create(tumble.world, &options, &tumble.play, NULL));
    must(jp_pin_create(tumble.play, tumble.bodies[0], tumble.bodies[1], &pin, &tumble.pin, NULL));
    return tumble;
}

static double kinetic(const Tumble *tumble)
{
    double sum = 0.0;
    for (int i = 0; i < 2; i++) {
        dMass mass;
        dVector3 local;
        dBodyGetMass(tumble->bodies[i], &mass);
        const dReal *velocity = dBodyGetLinearVel(tumble->bodies[i]);
        const dReal *omega = dBodyGetAngularVel(tumble->bodies[i]);
        dBodyVectorFromWorld(tumble->bodies[i], omega[0], omega[1], omega[2], local);
        sum += 0.5 * mass.mass * dCalcVectorDot3(velocity, velocity);
        for (int k = 0; k < 3; k++) {
            sum += 0.5 * mass.I[5 * k] * local[k] * local[k];
        }
    }
    return sum;
}

static double momentum(const Tumble *tumble, int axis)
{
    double sum = 0.0;
    for (int i = 0; i < 2; i++) {
        dMass mass;
        dBodyGetMass(tumble->bodies[i], &mass);
        sum += mass.mass * dBodyGetLinearVel(tumble->bodies[i])[axis];
    }
    return sum;
}

// What of the energy is missing after all that the pin says it took, relative to the start's.
static double missing_energy(double friction, int steps, double *slid)
{
    Tumble tumble = tumble_make(friction);
    const double before = kinetic(&tumble);
    const double moving[] = {momentum(&tumble, 0), momentum(&tumble, 1), momentum(&tumble, 2)};
    for (int i = 0; i < steps; i++) {
        must_step(jp_world_step(tumble.play, 0.02 / steps, NULL));
    }
    JpPinState now;
    must(jp_pin_state(tumble.pin, &now, NULL));
    double work = -now.slid;
    for (int i = 0; i < 2; i++) {
        work += now.ends[i].work + now.collars[i].work;
    }
    assert_true(now.ends[0].impacts + now.ends[1].impacts > 2);
    // friction holds the pin off its collars
    assert_true((now.collars[0].impacts + now.collars[1].impacts > 0) == (friction == 0.0));
    for (int i = 0; i < 3; i++) {
        assert_near(momentum(&tumble, i), moving[i], 1e-10);
    }
    *slid = now.slid / before;
    const double missing = (kinetic(&tumble) - before - work) / before;
    jp_world_destroy(tumble.play);
    dWorldDestroy(tumble.world);
    return missing;
}

static void a_tumbling_pin_keeps_momentum_and_accounts_for_its_energy(void **state)
{
    (void)state;
    double slid;
    assert_near(missing_energy(0.0, 1000, &slid), 0.0, 1e-4);
    assert_true(slid == 0.0);
    const double coarse = missing_energy(0.2, 500, &slid);
    const double fine = missing_energy(0.2, 2000, &slid);
    // 6e-7 and 4e-8
    assert_near(log2(coarse / fine) / 2.0, 2.0, 0.3);
    assert_near(fine, 0.0, 1e-4);
    // what friction takes is no rounding: without it the balance would be open
    assert_true(slid > 100.0 * fabs(fine));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_pin_rebounds_as_asked),
        cmocka_unit_test(a_pin_tilts_until_both_ends_touch),
        cmocka_unit_test(a_tumbling_pin_keeps_momentum_and_accounts_for_its_energy),
        cmocka_unit_test(a_four_bar_made_by_hand_is_as_right_as_the_programs),
        cmocka_unit_test(coarse_steps_are_as_right_as_the_programs),
    };
    dInitODE2(0);
    const int failed = cmocka_run_group_tests(tests, NULL, NULL);
    dCloseODE();
    return failed;
}
