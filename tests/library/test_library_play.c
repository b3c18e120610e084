// Do joints with play rebound as asked, show the gap asked for, and keep momentum and energy?
#include "close.h"

#include "ode_group.h"

#include "base/lcg.h"

#include <jointplay/jointplay.h>

#include <ode/ode.h>
#include <string.h>

static const double PI = 3.14159265358979323846;

#define must(call) assert_int_equal((call), JP_OK)

// A step that is made, coarse or not: how right it has to be is asserted of what comes of it.
#define must_step(call) assert_true((call) <= JP_OK)

// A disc on a hinge, or a block on a slider, with the world on one side.
typedef struct Bench {
    dWorldID world;
    dBodyID body;
    dJointID joint;
    JpWorld *play;
} Bench;

static dBodyID make_body(dWorldID world, double mass, double inertia)
{
    dMass data;
    dMassSetParameters(&data, mass, 0, 0, 0, inertia, inertia, inertia, 0, 0, 0);
    const dBodyID body = dBodyCreate(world);
    dBodySetMass(body, &data);
    return body;
}

static dJointID make_joint(dWorldID world, bool is_hinge, dBodyID first, dBodyID second)
{
    const dJointID joint = is_hinge ? dJointCreateHinge(world, 0) : dJointCreateSlider(world, 0);
    dJointAttach(joint, first, second);
    if (is_hinge) {
        dJointSetHingeAnchor(joint, 0, 0, 0);
        dJointSetHingeAxis(joint, 0, 0, 1);
    } else {
        dJointSetSliderAxis(joint, 0, 0, 1);
    }
    return joint;
}

static Bench bench_make(bool is_hinge, double inertia, JpStepping stepping)
{
    Bench bench = {.world = dWorldCreate()};
    bench.body = make_body(bench.world, inertia, inertia);
    bench.joint = make_joint(bench.world, is_hinge, bench.body, 0);
    JpWorldOptions options = jp_world_options_default();
    options.stepping = stepping;
    must(jp_world_create(bench.world, &options, &bench.play, NULL));
    return bench;
}

static void bench_finish(Bench *bench)
{
    jp_world_destroy(bench->play);
    dWorldDestroy(bench->world);
}

static void set_speed(const Bench *bench, bool is_hinge, double speed)
{
    if (is_hinge) {
        dBodySetAngularVel(bench->body, 0, 0, speed);
    } else {
        dBodySetLinearVel(bench->body, 0, 0, speed);
    }
}

// An impact of random numbers on a stop, at a number of steps to its contact.
typedef struct Impact {
    double inertia;
    double speed;
    double step;
    double flight; // to the stop
    JpContact contact;
} Impact;

// In [0, 1).
static double share(uint64_t *random)
{
    return 0.5 + 0.5 * lcg_draw(random);
}

static Impact random_impact(uint64_t *random, double fewest)
{
    Impact impact = {
        .inertia = pow(10.0, -5.0 + 6.0 * share(random)),
        .speed = 0.1 + 5.0 * share(random),
        .contact = jp_contact_default(),
    };
    impact.contact.stiffness = pow(10.0, 2.0 + 6.0 * share(random));
    impact.contact.restitution = 0.2 + 0.8 * share(random);
    const double contact_s = PI * sqrt(impact.inertia / impact.contact.stiffness);
    impact.step = contact_s / (fewest * pow(10.0, share(random)));
    impact.flight = (3.0 + share(random)) * impact.step * impact.speed;
    return impact;
}

// How far restitution and peak are off, of what the law gives.
typedef struct Off {
    double restitution;
    double peak;
} Off;

static Off rebound(const Impact *impact, bool is_hinge, JpStepping stepping, double most_speed)
{
    Bench bench = bench_make(is_hinge, impact->inertia, stepping);
    dWorldSetContactMaxCorrectingVel(bench.world, most_speed);
    JpStops stops = jp_stops_default();
    stops.high = impact->flight;
    stops.contact = impact->contact;
    JpJoint *joint = NULL;
    must(jp_stops_create(bench.play, bench.joint, &stops, &joint, NULL));
    set_speed(&bench, is_hinge, impact->speed);
    JpJointState state;
    do {
        must_step(jp_world_step(bench.play, impact->step, NULL));
        must(jp_joint_state(joint, &state, NULL));
    } while (state.high.impacts == 0 || state.high.is_touching || state.high.force > 0.0);
    assert_int_equal(state.high.impacts, 1);
    JpImpact law;
    must(jp_impact_of_law(&impact->contact, impact->inertia, impact->speed, &law, NULL));
    // what the contact took is what the body has lost
    const double gained =
        0.5 * impact->inertia * (state.speed * state.speed - impact->speed * impact->speed);
    // within a step it is integrated by itself
    const double off = stepping == JP_STEPPING_IMPULSE ? 1e-5 : 1e-9;
    assert_near(state.high.work, gained, off * impact->inertia * impact->speed * impact->speed);
    assert_near(state.high.impulse, impact->inertia * (impact->speed - state.speed),
                1e-9 * impact->inertia * impact->speed);
    bench_finish(&bench);
    return (Off){
        .restitution = fabs(-state.speed / impact->speed / law.restitution - 1.0),
        .peak = fabs(state.high.force_max / law.peak - 1.0),
    };
}

static void stops_rebound_as_asked_down_to_ten_steps_a_contact(void **state)
{
    (void)state;
    uint64_t random = lcg_stirred(7);
    for (int i = 0; i < 100; i++) {
        const Impact impact = random_impact(&random, 10.0);
        const Off off = rebound(&impact, i % 2 == 0, JP_STEPPING_STAGGERED, dInfinity);
        assert_near(off.restitution, 0.0, 0.01);
        assert_near(off.peak, 0.0, 0.01);
    }
}

static void plain_rows_rebound_as_asked_too(void **state)
{
    (void)state;
    uint64_t random = lcg_stirred(7);
    for (int i = 0; i < 100; i++) {
        const Impact impact = random_impact(&random, 10.0);
        const Off off = rebound(&impact, i % 2 == 0, JP_STEPPING_PLAIN, dInfinity);
        assert_near(off.restitution, 0.0, 0.01);
        assert_near(off.peak, 0.0, 0.01);
    }
}

// A disc on a stop whose damper stops it within a hundredth of a step.
static void a_heavy_damper_throws_nothing_back(void **state)
{
    (void)state;
    for (int stepping = JP_STEPPING_PLAIN; stepping <= JP_STEPPING_IMPULSE; stepping++) {
        Bench bench = bench_make(true, 1.0, (JpStepping)stepping);
        JpStops stops = jp_stops_default();
        stops.high = 0.0123;
        stops.contact.stiffness = 1e4;
        stops.contact.damping = JP_DAMPING_VISCOUS;
        stops.contact.damper = 1e5;
        JpJoint *joint = NULL;
        must(jp_stops_create(bench.play, bench.joint, &stops, &joint, NULL));
        set_speed(&bench, true, 1.0);
        JpJointState now;
        for (int i = 0; i < 100; i++) {
            must_step(jp_world_step(bench.play, 1e-3, NULL));
            must(jp_joint_state(joint, &now, NULL));
            assert_true(now.speed > -1e-2);
        }
        // the control: it did get there
        assert_true(now.high.impacts > 0);
        bench_finish(&bench);
    }
}

// A contact lasts from twenty steps to a twentieth of one.
static void impulses_rebound_as_asked_at_any_step(void **state)
{
    (void)state;
    uint64_t random = lcg_stirred(7);
    for (int i = 0; i < 100; i++) {
        Impact impact = random_impact(&random, 2.0);
        impact.step *= pow(10.0, 1.6 * share(&random));
        // an angle is followed by less than half a turn a step
        impact.speed = fmin(impact.speed, 1.0 / impact.step);
        impact.flight = (3.0 + share(&random)) * impact.step * impact.speed;
        const Off off = rebound(&impact, i % 2 == 0, JP_STEPPING_IMPULSE, dInfinity);
        assert_near(off.restitution, 0.0, 1e-4);
        assert_near(off.peak, 0.0, 1e-3);
    }
}

// The control: ODE's own stop, which reads stiffness and damping by the textbook.
static void a_stop_of_ode_does_not(void **state)
{
    (void)state;
    uint64_t random = lcg_stirred(7);
    double most = 0.0;
    for (int i = 0; i < 100; i++) {
        const Impact impact = random_impact(&random, 10.0);
        Bench bench = bench_make(true, impact.inertia, JP_STEPPING_PLAIN);
        double damper = 0.0;
        must(jp_damper_of(impact.contact.stiffness, impact.contact.restitution, impact.inertia,
                          &damper, NULL));
        const double sum = impact.step * impact.contact.stiffness + damper;
        dJointSetHingeParam(bench.joint, dParamHiStop, impact.flight);
        dJointSetHingeParam(bench.joint, dParamStopERP, 1.0 - damper / sum);
        dJointSetHingeParam(bench.joint, dParamStopCFM, 1.0 / sum);
        set_speed(&bench, true, impact.speed);
        for (int step = 0; step < 400; step++) {
            dWorldStep(bench.world, impact.step);
        }
        const double back = -dJointGetHingeAngleRate(bench.joint) / impact.speed;
        most = fmax(most, fabs(back / impact.contact.restitution - 1.0));
        bench_finish(&bench);
    }
    assert_true(most > 0.2);
}

static void a_limit_of_contacts_speeds_changes_nothing(void **state)
{
    (void)state;
    uint64_t random = lcg_stirred(11);
    for (int i = 0; i < 20; i++) {
        const Impact impact = random_impact(&random, 10.0);
        const Off off = rebound(&impact, false, JP_STEPPING_STAGGERED, 10.0 * impact.speed);
        assert_near(off.restitution, 0.0, 0.01);
        assert_near(off.peak, 0.0, 0.01);
    }
}

// Where a joint with backlash comes to rest under a steady load.
static double rest_under(Bench *bench, const JpJoint *joint, bool is_hinge, double load,
                         double step)
{
    JpJointState state;
    for (int i = 0; i < 10000; i++) {
        if (is_hinge) {
            dJointAddHingeTorque(bench->joint, load);
        } else {
            dJointAddSliderForce(bench->joint, load);
        }
        must_step(jp_world_step(bench->play, step, NULL));
    }
    must(jp_joint_state(joint, &state, NULL));
    assert_near(state.speed, 0.0, 1e-8);
    assert_near(state.force, -load, 1e-6 * fabs(load));
    return state.position;
}

static void a_slow_reversal_shows_the_gap_asked_for(void **state)
{
    (void)state;
    for (int i = 0; i < 4; i++) {
        const bool is_hinge = i % 2 == 0;
        Bench bench =
            bench_make(is_hinge, 0.01, i < 2 ? JP_STEPPING_STAGGERED : JP_STEPPING_IMPULSE);
        JpBacklash backlash = jp_backlash_default();
        backlash.gap = 0.0105; // .6 degrees
        backlash.offset = 0.002;
        backlash.tooth.stiffness = 1e4;
        backlash.tooth.damping = JP_DAMPING_VISCOUS;
        backlash.tooth.damper = 5.0;
        JpJoint *joint = NULL;
        must(jp_backlash_create(bench.play, bench.joint, &backlash, &joint, NULL));
        const double load = 0.25;
        const double high = rest_under(&bench, joint, is_hinge, load, 1e-4);
        const double low = rest_under(&bench, joint, is_hinge, -load, 1e-4);
        const double sunk = load / backlash.tooth.stiffness;
        assert_near(high - low - 2.0 * sunk, backlash.gap, 1e-9);
        assert_near(0.5 * (high + low), backlash.offset, 1e-9);
        bench_finish(&bench);
    }
}

// A rotor that is driven back and forth carries a load through the gap: what the drive puts in is
// in the two inertias, in the teeth, or lost in them.
static void the_energy_of_a_driven_rotor_closes(void **state)
{
    (void)state;
    for (int stepping = JP_STEPPING_PLAIN; stepping <= JP_STEPPING_IMPULSE; stepping++) {
        Bench bench = bench_make(true, 0.02, (JpStepping)stepping);
        JpBacklash backlash = jp_backlash_default();
        backlash.gap = 0.01;
        backlash.rotor_inertia = 0.005;
        backlash.tooth.stiffness = 2e3;
        backlash.tooth.restitution = 0.6;
        JpJoint *joint = NULL;
        must(jp_backlash_create(bench.play, bench.joint, &backlash, &joint, NULL));
        const double step = 1e-4;
        double driven = 0.0;
        double moment = 0.0;
        double before = 0.0;
        JpJointState now;
        for (int i = 0; i < 20000; i++) {
            const double drive = 0.3 * sin(20.0 * i * step);
            must(jp_backlash_drive(joint, drive, NULL));
            must_step(jp_world_step(bench.play, step, NULL));
            must(jp_joint_state(joint, &now, NULL));
            driven += drive * 0.5 * (before + now.rotor_speed) * step;
            moment += drive * step;
            before = now.rotor_speed;
        }
        const double kinetic =
            0.5 * 0.02 * now.speed * now.speed + 0.5 * 0.005 * now.rotor_speed * now.rotor_speed;
        assert_true(now.low.impacts > 10 && now.high.impacts > 10);
        const double off = stepping == JP_STEPPING_IMPULSE ? 1e-5 * kinetic : 1e-11;
        assert_near(kinetic, driven + now.low.work + now.high.work, off);
        // the rotor's own momentum and the load's are what the drive gave
        assert_near(0.02 * now.speed + 0.005 * now.rotor_speed, moment, 1e-9);
        // impacts lose energy
        assert_true(now.low.work + now.high.work + now.low.stored + now.high.stored < -1e-4);
        bench_finish(&bench);
    }
}

// The part of a body's own angular momentum about z.
static double spin_about_z(dBodyID body)
{
    dMass mass;
    dVector3 local;
    dVector3 turned;
    dVector3 world;
    dBodyGetMass(body, &mass);
    const dReal *omega = dBodyGetAngularVel(body);
    dBodyVectorFromWorld(body, omega[0], omega[1], omega[2], local);
    dMultiply0_331(turned, mass.I, local);
    dBodyVectorToWorld(body, turned[0], turned[1], turned[2], world);
    return world[2];
}

// Two bodies off the axis that nothing holds: whatever their joint does, what they have together
// stays.
static void momentum_stays_in_space(void **state)
{
    (void)state;
    for (int is_hinge = 0; is_hinge < 2; is_hinge++) {
        const dWorldID world = dWorldCreate();
        dBodyID bodies[2];
        dMass mass;
        for (int i = 0; i < 2; i++) {
            dMassSetParameters(&mass, 1.0 + i, 0, 0, 0, 0.01, 0.02, 0.015, 0, 0, 0);
            bodies[i] = dBodyCreate(world);
            dBodySetMass(bodies[i], &mass);
        }
        dBodySetPosition(bodies[0], 0.1, 0.0, 0.02);
        dBodySetPosition(bodies[1], -0.05, 0.07, -0.03);
        const dJointID hold = make_joint(world, is_hinge, bodies[0], bodies[1]);
        JpWorld *play = NULL;
        JpJoint *joint = NULL;
        JpBacklash backlash = jp_backlash_default();
        backlash.gap = 0.004;
        backlash.tooth.stiffness = 2e4;
        must(jp_world_create(world, NULL, &play, NULL));
        must(jp_backlash_create(play, hold, &backlash, &joint, NULL));
        // together along and about z, and against each other as the joint allows
        for (int i = 0; i < 2; i++) {
            dBodySetLinearVel(bodies[i], 0.3, -0.2, is_hinge ? 0.1 : (i == 0 ? 0.5 : 0.1));
        }
        if (is_hinge) {
            dVector3 velocity;
            for (int i = 0; i < 2; i++) {
                const double omega = i == 0 ? 0.8 : -0.4;
                const dReal *at = dBodyGetPosition(bodies[i]);
                memcpy(velocity, dBodyGetLinearVel(bodies[i]), sizeof velocity);
                dBodySetLinearVel(bodies[i], velocity[0] - omega * at[1],
                                  velocity[1] + omega * at[0], velocity[2]);
                dBodySetAngularVel(bodies[i], 0, 0, omega);
            }
        }
        double start[2] = {0.0};
        for (int step = 0; step <= 2000; step++) {
            double sums[2] = {0.0}; // along x, about z through the origin
            for (int i = 0; i < 2; i++) {
                const dReal *v = dBodyGetLinearVel(bodies[i]);
                const dReal *x = dBodyGetPosition(bodies[i]);
                sums[0] += (1.0 + i) * v[0];
                sums[1] += (1.0 + i) * (x[0] * v[1] - x[1] * v[0]) + spin_about_z(bodies[i]);
            }
            if (step == 0) {
                memcpy(start, sums, sizeof start);
            }
            assert_near(sums[0], start[0], 1e-11);
            assert_near(sums[1], start[1], 1e-5);
            must_step(jp_world_step(play, 1e-4, NULL));
        }
        JpJointState now;
        must(jp_joint_state(joint, &now, NULL));
        assert_true(now.low.impacts + now.high.impacts > 2);
        jp_world_destroy(play);
        dWorldDestroy(world);
    }
}

// The joint may have the world on either side, and its coordinate is ODE's.
static void the_coordinate_is_that_of_ode(void **state)
{
    (void)state;
    for (int kind = 0; kind < 4; kind++) {
        const bool is_hinge = kind % 2 == 0;
        const dWorldID world = dWorldCreate();
        const dBodyID body = make_body(world, 0.5, 0.1);
        const dJointID hold =
            kind < 2 ? make_joint(world, is_hinge, body, 0) : make_joint(world, is_hinge, 0, body);
        JpWorld *play = NULL;
        JpJoint *joint = NULL;
        JpStops stops = jp_stops_default();
        stops.low = -0.02;
        stops.high = 0.03;
        stops.contact.stiffness = 1e4;
        must(jp_world_create(world, NULL, &play, NULL));
        must(jp_stops_create(play, hold, &stops, &joint, NULL));
        const double speed = kind < 2 ? 1.0 : -1.0;
        dBodySetAngularVel(body, 0, 0, is_hinge ? speed : 0.0);
        dBodySetLinearVel(body, 0, 0, is_hinge ? 0.0 : speed);
        size_t touched = 0;
        for (int i = 0; i < 3000; i++) {
            must_step(jp_world_step(play, 1e-4, NULL));
            JpJointState now;
            must(jp_joint_state(joint, &now, NULL));
            const double position =
                is_hinge ? dJointGetHingeAngle(hold) : dJointGetSliderPosition(hold);
            const double rate =
                is_hinge ? dJointGetHingeAngleRate(hold) : dJointGetSliderPositionRate(hold);
            assert_near(now.position, position, 1e-9);
            assert_near(now.speed, rate, 1e-12);
            assert_near(now.low.gap, position + 0.02, 1e-9);
            assert_near(now.high.gap, 0.03 - position, 1e-9);
            touched = now.low.impacts + now.high.impacts;
        }
        assert_true(touched >= 2);
        jp_world_destroy(play);
        dWorldDestroy(world);
    }
}

// A rod on a hinge off its middle is heavier to turn than ODE's body alone: the limit of the map is
// that of the rod as its hinge holds it, found by trial.
static void the_limit_is_that_of_the_body_as_it_is_held(void **state)
{
    (void)state;
    for (int is_beyond = 0; is_beyond < 2; is_beyond++) {
        const dWorldID world = dWorldCreate();
        const dBodyID body = make_body(world, 1.0, 0.001);
        dBodySetPosition(body, 0.3, 0, 0); // .091 kg m^2 about the hinge
        const dJointID hold = make_joint(world, true, body, 0);
        JpWorld *play = NULL;
        JpJoint *joint = NULL;
        JpStops stops = jp_stops_default();
        stops.high = 0.01;
        stops.contact.stiffness = 1e4;
        must(jp_world_create(world, NULL, &play, NULL));
        must(jp_stops_create(play, hold, &stops, &joint, NULL));
        dBodySetAngularVel(body, 0, 0, 1.0);
        dBodySetLinearVel(body, 0, 0.3, 0);
        // omega h of the body alone, then of the rod
        const double step = is_beyond ? 2.5 / sqrt(1e4 / 0.091) : 2.5 / sqrt(1e4 / 0.001);
        for (int i = 0; i < 400; i++) {
            must_step(jp_world_step(play, step, NULL));
        }
        JpWorldStats stats;
        must(jp_world_stats(play, &stats, NULL));
        assert_true(stats.rows > 0);
        assert_true((stats.fallbacks > 0) == is_beyond);
        assert_int_equal(stats.steps, 400);
        assert_true(stats.world_steps >= 402);
        jp_world_destroy(play);
        dWorldDestroy(world);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(stops_rebound_as_asked_down_to_ten_steps_a_contact),
        cmocka_unit_test(plain_rows_rebound_as_asked_too),
        cmocka_unit_test(a_heavy_damper_throws_nothing_back),
        cmocka_unit_test(impulses_rebound_as_asked_at_any_step),
        cmocka_unit_test(a_stop_of_ode_does_not),
        cmocka_unit_test(a_limit_of_contacts_speeds_changes_nothing),
        cmocka_unit_test(a_slow_reversal_shows_the_gap_asked_for),
        cmocka_unit_test(the_energy_of_a_driven_rotor_closes),
        cmocka_unit_test(momentum_stays_in_space),
        cmocka_unit_test(the_coordinate_is_that_of_ode),
        cmocka_unit_test(the_limit_is_that_of_the_body_as_it_is_held),
    };
    return cmocka_run_group_tests(tests, ode_group_setup, ode_group_teardown);
}
