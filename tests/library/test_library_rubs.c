// Does the friction of hinges and sliders hold, and slide as its law says?
//
// The truths are closed forms. The controls: the same joint with regularized friction, which
// creeps, and what is beyond what friction holds.
#include "close.h"

#include "ode_group.h"

#include <jointplay/jointplay.h>

#include <math.h>
#include <ode/ode.h>
#include <string.h>

#define must(call)      assert_int_equal((call), JP_OK)
#define must_step(call) assert_true((call) <= JP_OK)

static const JpStepping STEPPINGS[] = {JP_STEPPING_PLAIN, JP_STEPPING_STAGGERED,
                                       JP_STEPPING_IMPULSE};
enum { STEPPING_COUNT = 3 };

static const double GRAVITY = 9.81; // m/s^2
static const double MASS = 2.0;     // kg
static const double INERTIA = 0.01; // kg m^2, about any axis

// A world with bodies, a joint of ODE and its friction.
typedef struct Bench {
    dWorldID world;
    dBodyID bodies[2];
    dJointID joint;
    JpWorld *play;
    JpJoint *friction;
} Bench;

static dBodyID make_body(Bench *bench, double x, double y)
{
    dMass mass;
    const dBodyID body = dBodyCreate(bench->world);
    dMassSetParameters(&mass, MASS, 0, 0, 0, INERTIA, INERTIA, INERTIA, 0, 0, 0);
    dBodySetMass(body, &mass);
    dBodySetPosition(body, x, y, 0);
    return body;
}

static Bench bench_make(JpStepping stepping)
{
    Bench bench = {.world = dWorldCreate()};
    JpWorldOptions options = jp_world_options_default();
    options.stepping = stepping;
    dWorldSetERP(bench.world, 1.0);
    must(jp_world_create(bench.world, &options, &bench.play, NULL));
    return bench;
}

static void bench_finish(Bench *bench)
{
    jp_world_destroy(bench->play);
    dWorldDestroy(bench->world);
}

// A body on a hinge about z through the origin, its centre beside it.
static Bench hinge_make(JpStepping stepping, double beside, const JpFriction *friction)
{
    Bench bench = bench_make(stepping);
    bench.bodies[0] = make_body(&bench, beside, 0);
    bench.joint = dJointCreateHinge(bench.world, 0);
    dJointAttach(bench.joint, bench.bodies[0], 0);
    dJointSetHingeAnchor(bench.joint, 0, 0, 0);
    dJointSetHingeAxis(bench.joint, 0, 0, 1);
    must(jp_friction_create(bench.play, bench.joint, friction, &bench.friction, NULL));
    return bench;
}

// Gives a body on such a hinge a rate.
static void spin(Bench *bench, double omega)
{
    const dReal *at = dBodyGetPosition(bench->bodies[0]);
    dBodySetAngularVel(bench->bodies[0], 0, 0, omega);
    dBodySetLinearVel(bench->bodies[0], -omega * at[1], omega * at[0], 0);
}

static void run(Bench *bench, double step, double duration)
{
    for (int i = 0; i < (int)round(duration / step); i++) {
        must_step(jp_world_step(bench->play, step, NULL));
    }
}

static JpFrictionState state_of(const Bench *bench)
{
    JpFrictionState state;
    must(jp_friction_state(bench->friction, &state, NULL));
    return state;
}

static JpFriction steady(double force)
{
    JpFriction friction = jp_friction_default();
    friction.steady = force;
    return friction;
}

static JpFriction rubbing(double coefficient, double radius)
{
    JpFriction friction = jp_friction_default();
    friction.coefficient = coefficient;
    friction.radius = radius;
    return friction;
}

// An arm that weighs on its hinge by a torque, under a friction of 1.1 of that, for 10 s.
static void an_arm_holds_under_what_friction_holds(void **state)
{
    (void)state;
    const double step = 1e-3;
    const double arm = 0.05;
    const double torque = MASS * GRAVITY * arm;
    for (int i = 0; i < STEPPING_COUNT; i++) {
        JpFriction friction = steady(1.1 * torque);
        Bench held = hinge_make(STEPPINGS[i], arm, &friction);
        dWorldSetGravity(held.world, 0, -GRAVITY, 0);
        run(&held, step, 10.0);
        const JpFrictionState at = state_of(&held);
        print_message("# stepping %d: turned by %.1e rad in 10 s\n", (int)STEPPINGS[i],
                      at.position);
        // the slip: 1e-8 of the speed that the torque alone would change in a step
        const double slip = -1e-8 * torque / INERTIA * step;
        assert_near(at.position, 10.0 * slip, 0.01 * fabs(10.0 * slip));
        assert_near(at.force, torque, 1e-9 * torque);
        assert_true(at.is_sticking);
        bench_finish(&held);
        // the controls; in such a step the regularized law is a straight line to its bound
        friction.law = JP_FRICTION_REGULARIZED;
        Bench creeping = hinge_make(STEPPINGS[i], arm, &friction);
        dWorldSetGravity(creeping.world, 0, -GRAVITY, 0);
        run(&creeping, step, 10.0);
        const double rate = -friction.speed / 1.1;
        assert_near(state_of(&creeping).position, 10.0 * rate, 0.01 * fabs(10.0 * rate));
        assert_false(state_of(&creeping).is_sticking);
        bench_finish(&creeping);
        friction = steady(0.9 * torque);
        Bench falling = hinge_make(STEPPINGS[i], arm, &friction);
        dWorldSetGravity(falling.world, 0, -GRAVITY, 0);
        run(&falling, step, 0.5);
        assert_true(state_of(&falling).position < -0.1);
        assert_false(state_of(&falling).is_sticking);
        bench_finish(&falling);
        // more holds than slides
        friction.breakaway_ratio = 1.3;
        Bench broken = hinge_make(STEPPINGS[i], arm, &friction);
        dWorldSetGravity(broken.world, 0, -GRAVITY, 0);
        run(&broken, step, 0.5);
        assert_true(state_of(&broken).is_sticking);
        spin(&broken, -1.0);
        run(&broken, step, 0.2);
        assert_true(state_of(&broken).position < -0.1);
        bench_finish(&broken);
    }
}

// How far a flywheel that a steady friction stops has turned, over what it should have, less 1.
static double stopping_error(JpStepping stepping, double step)
{
    const double omega = 3.1;
    const double torque = 0.05;
    const JpFriction friction = steady(torque);
    Bench wheel = hinge_make(stepping, 0.0, &friction);
    spin(&wheel, omega);
    run(&wheel, step, 1.0);
    const JpFrictionState at = state_of(&wheel);
    const double energy = 0.5 * INERTIA * omega * omega;
    if (stepping != JP_STEPPING_PLAIN) {
        assert_near(at.slid, energy, 1e-9 * energy);
    }
    assert_true(fabs(at.speed) < 1e-12);
    bench_finish(&wheel);
    return at.position * torque / energy - 1.0;
}

static void a_flywheel_stops_where_its_energy_is_used_up(void **state)
{
    (void)state;
    for (int i = 0; i < STEPPING_COUNT; i++) {
        // it stops after .62 s, within a step; at most a quarter of (h w / 2) of that is wrong
        const bool is_plain = STEPPINGS[i] == JP_STEPPING_PLAIN;
        const double coarse = stopping_error(STEPPINGS[i], 9e-3);
        const double fine = stopping_error(STEPPINGS[i], 0.9e-3);
        print_message("# stepping %d: turned too far by %.1e and %.1e\n", (int)STEPPINGS[i], coarse,
                      fine);
        assert_true(fabs(fine) < (is_plain ? 2e-3 : 1e-6));
        assert_true(fabs(coarse) < (is_plain ? 2e-2 : 1e-4));
    }
}

// A bob on a hinge without gravity presses by what keeps it on its circle and by what slows it:
//     J w' = -c |(w^2, w')|,  c = mu R m r,   so   w' = -k w^2,  k = c / sqrt(J^2 - c^2)
// Returns what its rate is off by after half a second, over what it should be.
static double bob_error(JpStepping stepping, double step)
{
    const double r = 0.3; // m, of the circle
    const double omega = 8.0;
    const double duration = 0.5;
    const JpFriction friction = rubbing(0.3, 0.04);
    Bench bob = hinge_make(stepping, r, &friction);
    spin(&bob, omega);
    run(&bob, step, duration);
    const double whole = INERTIA + MASS * r * r;
    const double c = friction.coefficient * friction.radius * MASS * r;
    const double k = c / sqrt(whole * whole - c * c);
    const JpFrictionState at = state_of(&bob);
    bench_finish(&bob);
    return at.speed / (omega / (1.0 + k * omega * duration)) - 1.0;
}

static void a_bob_is_slowed_by_what_keeps_it_on_its_circle(void **state)
{
    (void)state;
    for (int i = 0; i < STEPPING_COUNT; i++) {
        const double coarse = bob_error(STEPPINGS[i], 1e-3);
        const double fine = bob_error(STEPPINGS[i], 0.125e-3);
        const double order = log2(fabs(coarse / fine)) / 3.0;
        print_message("# stepping %d: off by %.1e and %.1e, order %.2f\n", (int)STEPPINGS[i],
                      coarse, fine, order);
        assert_near(order, STEPPINGS[i] == JP_STEPPING_PLAIN ? 0.95 : 2.0, 0.1);
    }
    // what friction does is no small thing
    assert_true(bob_error(JP_STEPPING_STAGGERED, 1e-3) > -1e-4);
}

// A block on a slope, on a slider to the world or of the world on it; of two slopes friction holds
// it on one.
static void a_block_on_a_slope_holds_or_slides(void **state)
{
    (void)state;
    static const double MU = 0.4;
    for (int i = 0; i < 4 * STEPPING_COUNT; i++) {
        const JpStepping stepping = STEPPINGS[i / 4];
        const bool holds = i % 2 == 0;
        const bool is_first = i % 4 < 2;
        const double slope = atan(MU) + (holds ? -0.02 : 0.1);
        Bench bench = bench_make(stepping);
        dWorldSetGravity(bench.world, 0, 0, -GRAVITY);
        const dBodyID body = bench.bodies[0] = make_body(&bench, 0, 0);
        bench.joint = dJointCreateSlider(bench.world, 0);
        dJointAttach(bench.joint, is_first ? body : 0, is_first ? 0 : body);
        dJointSetSliderAxis(bench.joint, cos(slope), 0, -sin(slope));
        const JpFriction friction = rubbing(MU, 0.0);
        must(jp_friction_create(bench.play, bench.joint, &friction, &bench.friction, NULL));
        const double duration = holds ? 10.0 : 0.5;
        const double step = 1e-3;
        run(&bench, step, duration);
        const dReal *at = dBodyGetPosition(body);
        const double moved = at[0] * cos(slope) - at[2] * sin(slope);
        const double pulls = MASS * GRAVITY * sin(slope);
        const JpFrictionState now = state_of(&bench);
        if (holds) {
            const double slip = 1e-8 * pulls / MASS * step;
            assert_near(moved, duration * slip, 0.01 * duration * slip);
            assert_near(fabs(now.force), pulls, 1e-9 * pulls);
            assert_true(now.is_sticking);
        } else {
            const double a = GRAVITY * (sin(slope) - MU * cos(slope));
            const double way = 0.5 * a * duration * duration;
            assert_near(dBodyGetLinearVel(body)[0] / cos(slope), a * duration, 1e-9 * a);
            // a plain step moves by the speed of its end
            assert_near(moved, way, (stepping == JP_STEPPING_PLAIN ? 3e-3 : 1e-9) * way);
            assert_false(now.is_sticking);
        }
        bench_finish(&bench);
    }
}

// Two bodies that slide on each other, far from each other's centres, come to rest against each
// other and go on turning together. Returns how far they slide then in the second second, m.
static double slide_on(JpStepping stepping, double step)
{
    Bench bench = bench_make(stepping);
    bench.bodies[0] = make_body(&bench, 0, 0);
    bench.bodies[1] = make_body(&bench, 0.1, 0.5);
    bench.joint = dJointCreateSlider(bench.world, 0);
    dJointAttach(bench.joint, bench.bodies[0], bench.bodies[1]);
    dJointSetSliderAxis(bench.joint, 1, 0, 0);
    const JpFriction friction = steady(4.0);
    must(jp_friction_create(bench.play, bench.joint, &friction, &bench.friction, NULL));
    dBodySetLinearVel(bench.bodies[0], 1.0, 0, 0);
    run(&bench, step, 1.0);
    const JpFrictionState first = state_of(&bench);
    run(&bench, step, 1.0);
    double momenta[3] = {0.0, 0.0, 0.0};
    double energy = 0.0;
    for (int k = 0; k < 2; k++) {
        const dReal *at = dBodyGetPosition(bench.bodies[k]);
        const dReal *v = dBodyGetLinearVel(bench.bodies[k]);
        const double omega = dBodyGetAngularVel(bench.bodies[k])[2];
        momenta[0] += MASS * v[0];
        momenta[1] += MASS * v[1];
        momenta[2] += MASS * (at[0] * v[1] - at[1] * v[0]) + INERTIA * omega;
        energy += 0.5 * MASS * (v[0] * v[0] + v[1] * v[1]) + 0.5 * INERTIA * omega * omega;
    }
    const double whole = 0.5 * MASS;
    assert_near(momenta[0], MASS, 1e-12);
    assert_near(momenta[1], 0.0, 1e-12);
    assert_near(momenta[2], 0.0, 1e-12);
    assert_near(energy + first.slid, whole, (stepping == JP_STEPPING_PLAIN ? 1e-3 : 1e-5) * whole);
    assert_true(first.slid > 0.01 * whole && first.is_sticking);
    const double slid = state_of(&bench).position - first.position;
    bench_finish(&bench);
    return slid;
}

static void sliding_bodies_keep_their_momenta_and_hold(void **state)
{
    (void)state;
    for (int i = 0; i < STEPPING_COUNT; i++) {
        const double coarse = slide_on(STEPPINGS[i], 1e-3);
        const double fine = slide_on(STEPPINGS[i], 0.25e-3);
        print_message("# stepping %d: %.1e and %.1e m in a second\n", (int)STEPPINGS[i], coarse,
                      fine);
        // of second order; what moves 0.25 m to the side in that time
        assert_true(fabs(coarse) < 1e-5 && fabs(fine) < 0.1 * fabs(coarse));
    }
}

// A door with friction hits its stop and comes back: it is at rest where both have taken its
// energy.
//     w1^2 = w0^2 - 2 T a / J,   back by J (e w1)^2 / 2 T
// Returns what the way back is off by at a step, over what it should be and over what the friction
// of a step may do: it has the way of after the impact all through that.
static double door_error(double step)
{
    const double torque = 0.05;
    const double omega = 3.0;
    const double angle = 0.4;
    const JpFriction friction = steady(torque);
    Bench door = hinge_make(JP_STEPPING_IMPULSE, 0.0, &friction);
    JpStops stops = jp_stops_default();
    stops.high = angle;
    stops.contact.stiffness = 1e8;
    stops.contact.restitution = 0.8;
    JpJoint *stop;
    must(jp_stops_create(door.play, door.joint, &stops, &stop, NULL));
    spin(&door, omega);
    run(&door, step, 1.5);
    const double square = 0.64 * (omega * omega - 2.0 * torque * angle / INERTIA);
    const double back = INERTIA * square / (2.0 * torque);
    const double off = (angle - state_of(&door).position) / back - 1.0;
    JpWorldStats stats;
    must(jp_world_stats(door.play, &stats, NULL));
    assert_int_equal(stats.coarse + stats.fallbacks, 0);
    JpJointState at;
    must(jp_joint_state(stop, &at, NULL));
    assert_int_equal(at.high.impacts, 1);
    bench_finish(&door);
    print_message("# steps of %g s: off by %.1e of the way back\n", step, off);
    return fabs(off) / (2.0 * torque * step / INERTIA / sqrt(square));
}

static void a_door_with_friction_comes_back_from_its_stop(void **state)
{
    (void)state;
    // the speed of the impact and that behind it, each squared
    assert_true(door_error(1e-3) < 4.0);
    assert_true(door_error(1e-4) < 4.0);
}

// What the world's state has of the joint.
static void a_world_with_friction_goes_on_as_it_would_have(void **state)
{
    (void)state;
    const JpFriction friction = rubbing(0.3, 0.04);
    Bench one = hinge_make(JP_STEPPING_STAGGERED, 0.3, &friction);
    Bench other = hinge_make(JP_STEPPING_STAGGERED, 0.3, &friction);
    Bench control = hinge_make(JP_STEPPING_STAGGERED, 0.3, &friction);
    dWorldSetGravity(one.world, 0, -GRAVITY, 0);
    dWorldSetGravity(other.world, 0, -GRAVITY, 0);
    dWorldSetGravity(control.world, 0, -GRAVITY, 0);
    run(&one, 1e-3, 0.2);
    char bytes[8192];
    size_t size;
    must(jp_world_save(one.play, bytes, sizeof bytes, &size, NULL));
    must(jp_world_resume(other.play, bytes, size, NULL));
    dBodySetPosition(control.bodies[0], dBodyGetPosition(one.bodies[0])[0],
                     dBodyGetPosition(one.bodies[0])[1], 0);
    dBodySetQuaternion(control.bodies[0], dBodyGetQuaternion(one.bodies[0]));
    spin(&control, dBodyGetAngularVel(one.bodies[0])[2]);
    run(&one, 1e-3, 0.5);
    run(&other, 1e-3, 0.5);
    run(&control, 1e-3, 0.5);
    const JpFrictionState truth = state_of(&one);
    const JpFrictionState resumed = state_of(&other);
    assert_true(truth.position == resumed.position && truth.speed == resumed.speed &&
                truth.force == resumed.force && truth.slid == resumed.slid);
    assert_true(state_of(&control).position != truth.position);
    // a step that is taken back is made again to the same end
    must(jp_world_undo(other.play, NULL));
    run(&other, 1e-3, 1e-3);
    assert_true(state_of(&other).position == truth.position);
    assert_true(state_of(&other).slid == truth.slid);
    bench_finish(&control);
    bench_finish(&other);
    bench_finish(&one);
}

static void assert_says(const Bench *bench, const JpFriction *friction, const char *says)
{
    JpJoint *joint = NULL;
    JpError error;
    assert_int_equal(jp_friction_create(bench->play, bench->joint, friction, &joint, &error),
                     JP_ERROR_ARGUMENT);
    if (strstr(error.text, says) == NULL) {
        fail_msg("\"%s\" is not in \"%s\"", says, error.text);
    }
    assert_null(joint);
}

static void what_is_no_friction_is_refused(void **state)
{
    (void)state;
    JpFriction friction = steady(1.0);
    Bench bench = hinge_make(JP_STEPPING_STAGGERED, 0.1, &friction);
    friction.coefficient = 0.1;
    assert_says(&bench, &friction, "one of the two must be above 0");
    friction.steady = 0.0;
    assert_says(&bench, &friction, "the radius of the hinge's pin is 0");
    friction.coefficient = 0.0;
    assert_says(&bench, &friction, "one of the two must be above 0");
    friction.steady = NAN;
    assert_says(&bench, &friction, "the steady friction is nan");
    friction = steady(1.0);
    friction.law = (JpFrictionLaw)9;
    assert_says(&bench, &friction, "the law of friction is 9");
    friction = steady(1.0);
    friction.speed = 0.0;
    assert_says(&bench, &friction, "the friction speed is 0");
    friction = steady(1.0);
    friction.breakaway_ratio = 0.9;
    assert_says(&bench, &friction, "the breakaway ratio is 0.9");
    JpError error;
    JpFrictionState at;
    JpJointState of_play;
    JpJoint *joint = NULL;
    friction = steady(1.0);
    const dJointID ball = dJointCreateBall(bench.world, 0);
    dJointAttach(ball, bench.bodies[0], 0);
    assert_int_equal(jp_friction_create(bench.play, ball, &friction, &joint, &error),
                     JP_ERROR_ARGUMENT);
    assert_non_null(strstr(error.text, "a hinge or a slider"));
    dJointDestroy(ball);
    assert_int_equal(jp_friction_create(NULL, bench.joint, &friction, &joint, &error),
                     JP_ERROR_ARGUMENT);
    assert_int_equal(jp_friction_create(bench.play, bench.joint, NULL, &joint, &error),
                     JP_ERROR_ARGUMENT);
    assert_int_equal(jp_friction_create(bench.play, bench.joint, &friction, NULL, &error),
                     JP_ERROR_ARGUMENT);
    assert_int_equal(jp_joint_state(bench.friction, &of_play, &error), JP_ERROR_ARGUMENT);
    assert_non_null(strstr(error.text, "jp_friction_state"));
    assert_int_equal(jp_friction_state(NULL, &at, &error), JP_ERROR_ARGUMENT);
    assert_int_equal(jp_friction_state(bench.friction, NULL, &error), JP_ERROR_ARGUMENT);
    JpStops stops = jp_stops_default();
    stops.contact.stiffness = 1.0;
    must(jp_stops_create(bench.play, bench.joint, &stops, &joint, NULL));
    assert_int_equal(jp_friction_state(joint, &at, &error), JP_ERROR_ARGUMENT);
    assert_non_null(strstr(error.text, "joint 2 (stops) is no friction"));
    bench_finish(&bench);
}

// Of a slider the row lives for a step, of a hinge it rests between steps.
static void a_step_that_fails_leaves_no_row(void **state)
{
    (void)state;
    for (int i = 0; i < 2; i++) {
        Bench bench = bench_make(JP_STEPPING_STAGGERED);
        bench.bodies[0] = make_body(&bench, 0, 0);
        bench.joint =
            i == 0 ? dJointCreateSlider(bench.world, 0) : dJointCreateHinge(bench.world, 0);
        dJointAttach(bench.joint, bench.bodies[0], 0);
        const JpFriction friction = steady(1.0);
        must(jp_friction_create(bench.play, bench.joint, &friction, &bench.friction, NULL));
        // along the slider, or about the hinge
        dBodyAddForce(bench.bodies[0], 1e49, 0, 0);
        dBodyAddTorque(bench.bodies[0], 1e49, 0, 0);
        assert_int_equal(jp_world_step(bench.play, 1e3, NULL), JP_ERROR_WORLD);
        dBodySetForce(bench.bodies[0], 0, 0, 0);
        dBodySetTorque(bench.bodies[0], 0, 0, 0);
        // a step of ODE alone slides on, and one of the library does not
        dBodySetLinearVel(bench.bodies[0], i == 0 ? 1.0 : 0.0, 0, 0);
        dBodySetAngularVel(bench.bodies[0], i == 0 ? 0.0 : 1.0, 0, 0);
        dWorldStep(bench.world, 0.1);
        assert_near(state_of(&bench).speed, 1.0, 1e-9);
        run(&bench, 0.1, 0.1);
        assert_true(state_of(&bench).speed < 0.96);
        jp_joint_destroy(bench.friction);
        bench_finish(&bench);
    }
}

// A caller's own feedback stays, and one of the library goes with the joint.
static void feedback_is_the_callers_where_there_is_one(void **state)
{
    (void)state;
    const JpFriction friction = rubbing(0.3, 0.04);
    Bench bench = hinge_make(JP_STEPPING_STAGGERED, 0.3, &friction);
    run(&bench, 1e-3, 1e-3);
    assert_non_null(dJointGetFeedback(bench.joint));
    jp_joint_destroy(bench.friction);
    assert_null(dJointGetFeedback(bench.joint));
    dJointFeedback own;
    dJointSetFeedback(bench.joint, &own);
    must(jp_friction_create(bench.play, bench.joint, &friction, &bench.friction, NULL));
    run(&bench, 1e-3, 1e-3);
    assert_ptr_equal(dJointGetFeedback(bench.joint), &own);
    jp_joint_destroy(bench.friction);
    assert_ptr_equal(dJointGetFeedback(bench.joint), &own);
    bench_finish(&bench);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(an_arm_holds_under_what_friction_holds),
        cmocka_unit_test(a_flywheel_stops_where_its_energy_is_used_up),
        cmocka_unit_test(a_bob_is_slowed_by_what_keeps_it_on_its_circle),
        cmocka_unit_test(a_block_on_a_slope_holds_or_slides),
        cmocka_unit_test(sliding_bodies_keep_their_momenta_and_hold),
        cmocka_unit_test(a_door_with_friction_comes_back_from_its_stop),
        cmocka_unit_test(a_world_with_friction_goes_on_as_it_would_have),
        cmocka_unit_test(what_is_no_friction_is_refused),
        cmocka_unit_test(a_step_that_fails_leaves_no_row),
        cmocka_unit_test(feedback_is_the_callers_where_there_is_one),
    };
    return cmocka_run_group_tests(tests, ode_group_setup, ode_group_teardown);
}
