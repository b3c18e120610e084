// Does a world that ODE cannot step, or that lost a body, end in a sentence, and stay as it was?
//
// ODE's dWorldStep ends the program in each of these; that it does so is the control, in a child
// process.
#include "close.h"
#include "sample.h"

#include "base/lcg.h"
#include "ode_group.h"

#include <jointplay/jointplay.h>

#include <stdio.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

// A door on a hinge with stops.
typedef struct Door {
    dWorldID world;
    dBodyID body;
    dJointID hinge;
    JpWorld *play;
    JpJoint *stops;
} Door;

static Door door_make(JpStepping stepping)
{
    Door door = {.world = dWorldCreate()};
    dMass mass;
    dMassSetBoxTotal(&mass, 1.0, 0.3, 0.02, 0.5);
    door.body = dBodyCreate(door.world);
    dBodySetMass(door.body, &mass);
    dBodySetPosition(door.body, 0.15, 0, 0);
    door.hinge = dJointCreateHinge(door.world, 0);
    dJointAttach(door.hinge, door.body, 0);
    dJointSetHingeAnchor(door.hinge, 0, 0, 0);
    dJointSetHingeAxis(door.hinge, 0, 0, 1);
    dBodySetAngularVel(door.body, 0, 0, 1);
    dBodySetLinearVel(door.body, 0, 0.15, 0);
    JpWorldOptions options = jp_world_options_default();
    options.stepping = stepping;
    JpStops stops = jp_stops_default();
    stops.high = 0.01;
    stops.contact.stiffness = 1e4;
    assert_int_equal(jp_world_create(door.world, &options, &door.play, NULL), JP_OK);
    assert_int_equal(jp_stops_create(door.play, door.hinge, &stops, &door.stops, NULL), JP_OK);
    return door;
}

static void door_finish(Door *door)
{
    jp_world_destroy(door->play);
    dWorldDestroy(door->world);
}

// How a body is.
typedef struct BodyNumbers {
    double numbers[13];
} BodyNumbers;

static BodyNumbers numbers_of(dBodyID body)
{
    BodyNumbers now;
    memcpy(now.numbers, dBodyGetPosition(body), 3 * sizeof(double));
    memcpy(now.numbers + 3, dBodyGetQuaternion(body), 4 * sizeof(double));
    memcpy(now.numbers + 7, dBodyGetLinearVel(body), 3 * sizeof(double));
    memcpy(now.numbers + 10, dBodyGetAngularVel(body), 3 * sizeof(double));
    return now;
}

// A step that fails with a sentence, and changes nothing.
static void assert_step_fails(JpWorld *play, dBodyID body, double step, JpStatus status)
{
    JpError error = {JP_OK, ""};
    const BodyNumbers before = numbers_of(body);
    assert_int_equal(jp_world_step(play, step, &error), status);
    assert_int_equal(error.status, status);
    assert_true(strlen(error.text) > 10 && strlen(error.text) + 1 < JP_ERROR_SIZE);
    const BodyNumbers after = numbers_of(body);
    assert_memory_equal(&before, &after, sizeof before);
}

// Whether a function, in a process of its own, ends it by a signal.
static bool ends_the_process(void (*function)(void))
{
    fflush(NULL);
    const pid_t child = fork();
    if (child == 0) {
        if (freopen("/dev/null", "w", stderr) != NULL) {
            function();
        }
        _exit(0);
    }
    int status = 0;
    return waitpid(child, &status, 0) == child && WIFSIGNALED(status);
}

static void step_a_huge_force(void)
{
    Door door = door_make(JP_STEPPING_PLAIN);
    dBodyAddTorque(door.body, 0, 0, 1e200);
    for (int i = 0; i < 10; i++) {
        dWorldStep(door.world, 1e-3);
    }
}

static void numbers_out_of_range_are_refused(void **state)
{
    (void)state;
    for (int stepping = JP_STEPPING_PLAIN; stepping <= JP_STEPPING_IMPULSE; stepping++) {
        Door door = door_make((JpStepping)stepping);
        assert_step_fails(door.play, door.body, 1e-300, JP_ERROR_ARGUMENT);
        assert_step_fails(door.play, door.body, 1e300, JP_ERROR_ARGUMENT);
        dBodyAddTorque(door.body, 0, 0, 1e200);
        assert_step_fails(door.play, door.body, 1e-3, JP_ERROR_WORLD);
        dBodySetTorque(door.body, 0, 0, 0);
        dBodySetAngularVel(door.body, 0, 0, NAN);
        JpError error;
        assert_int_equal(jp_world_step(door.play, 1e-3, &error), JP_ERROR_WORLD);
        dBodySetAngularVel(door.body, 0, 0, 1);
        assert_int_equal(jp_world_step(door.play, 1e-3, &error), JP_OK);
        door_finish(&door);
    }
    assert_true(ends_the_process(step_a_huge_force));
}

// The same hinge once more: with a CFM of 0 its rows depend on each other.
static dJointID add_again(Door *door)
{
    dWorldSetCFM(door->world, 0.0);
    const dJointID again = dJointCreateHinge(door->world, 0);
    dJointAttach(again, door->body, 0);
    dJointSetHingeAnchor(again, 0, 0, 0);
    dJointSetHingeAxis(again, 0, 0, 1);
    return again;
}

static void step_hinges_that_depend_on_each_other(void)
{
    Door door = door_make(JP_STEPPING_PLAIN);
    add_again(&door);
    for (int i = 0; i < 100; i++) {
        dWorldStep(door.world, 1e-3);
    }
}

static void what_ode_asserts_is_an_error(void **state)
{
    (void)state;
    const bool ends = ends_the_process(step_hinges_that_depend_on_each_other);
    for (int stepping = JP_STEPPING_PLAIN; stepping <= JP_STEPPING_IMPULSE; stepping++) {
        Door door = door_make((JpStepping)stepping);
        JpError error = {JP_OK, ""};
        const dJointID again = add_again(&door);
        bool has_failed = false;
        for (int i = 0; i < 100 && !has_failed; i++) {
            has_failed = jp_world_step(door.play, 1e-3, &error) > JP_OK;
        }
        assert_true(has_failed);
        for (int i = 0; i < 10; i++) {
            assert_step_fails(door.play, door.body, 1e-3, JP_ERROR_WORLD);
        }
        // and goes on where the cause is taken away
        dJointDestroy(again);
        for (int i = 0; i < 100; i++) {
            assert_true(jp_world_step(door.play, 1e-3, &error) <= JP_OK);
        }
        assert_int_equal(dWorldStep(door.world, 1e-3), 1);
        door_finish(&door);
    }
    assert_true(ends);
}

// ---- speeds that joints forbid ----------------------------------------------------------------

// A door that turns about its centre, of inertia J, has J / (J + m r^2) of that speed left when the
// hinge at r has corrected it.
static void speeds_that_a_joint_forbids_are_corrected_and_coarse(void **state)
{
    (void)state;
    const double inertia = (0.3 * 0.3 + 0.02 * 0.02) / 12.0; // kg m^2, of 1 kg
    const double left = inertia / (inertia + 0.15 * 0.15);
    for (int stepping = JP_STEPPING_STAGGERED; stepping <= JP_STEPPING_IMPULSE; stepping++) {
        Door door = door_make((JpStepping)stepping);
        JpError error;
        dBodySetLinearVel(door.body, 0, 0, 0);
        assert_int_equal(jp_world_step(door.play, 1e-4, &error), JP_COARSE);
        assert_non_null(strstr(error.text, "forbid the speeds"));
        // what the hinge is open by then is closed by a fifth a step
        for (int i = 0; i < 40; i++) {
            assert_int_equal(jp_world_step(door.play, 1e-4, &error), JP_OK);
        }
        assert_close(dBodyGetAngularVel(door.body)[2], left, 1e-3);
        door_finish(&door);
        // the control: speeds that it allows
        door = door_make((JpStepping)stepping);
        assert_int_equal(jp_world_step(door.play, 1e-4, &error), JP_OK);
        assert_close(dBodyGetAngularVel(door.body)[2], 1.0, 1e-6);
        door_finish(&door);
    }
}

// ---- random worlds ----------------------------------------------------------------------------

enum { LINKS_MOST = 6, WORLDS = 193, WORLD_STEPS = 150 };

// A chain of hinges and sliders, some twice, with stops, backlash and pins, at long steps.
static size_t play_random_world(JpStepping stepping, unsigned seed)
{
    uint64_t draw = lcg_stirred(seed);
    const dWorldID world = dWorldCreate();
    dWorldSetGravity(world, 0, -9.81, 0);
    dWorldSetERP(world, lcg_draw(&draw) > 0.0 ? 1.0 : 0.2);
    dWorldSetCFM(world, lcg_draw(&draw) > 0.0 ? 0.0 : 1e-10);
    JpWorldOptions options = jp_world_options_default();
    JpWorld *play = NULL;
    options.stepping = stepping;
    assert_int_equal(jp_world_create(world, &options, &play, NULL), JP_OK);
    const int links = 1 + (int)((lcg_draw(&draw) + 1.0) / 2.0 * LINKS_MOST);
    dBodyID before = NULL;
    for (int i = 0; i < links; i++) {
        dMass mass;
        const dBodyID body = dBodyCreate(world);
        dMassSetBoxTotal(&mass, pow(10.0, 2.0 * lcg_draw(&draw)), 0.3, 0.05, 0.05);
        dBodySetMass(body, &mass);
        dBodySetPosition(body, 0.15 + 0.3 * i, 0, 0);
        dBodySetAngularVel(body, 0, 0, 20.0 * lcg_draw(&draw));
        JpJoint *joint = NULL;
        if (lcg_draw(&draw) > 0.5) {
            JpPinInHole pin = jp_pin_default();
            pin.hole_radius = 5e-3;
            pin.pin_radius = 4.9e-3;
            pin.width = lcg_draw(&draw) > 0.0 ? 0.02 : 0.0;
            pin.pin[0] = -0.15;
            pin.hole[0] = before != NULL ? 0.15 : 0.0;
            pin.contact.stiffness = pow(10.0, 6.0 + 3.0 * lcg_draw(&draw));
            assert_int_equal(jp_pin_create(play, before, body, &pin, &joint, NULL), JP_OK);
        } else {
            JpStops stops = jp_stops_default();
            stops.high = 0.1 * (lcg_draw(&draw) + 1.001);
            stops.low = -stops.high;
            stops.contact.stiffness = pow(10.0, 5.0 + 4.0 * lcg_draw(&draw));
            const int copies = lcg_draw(&draw) > 0.6 ? 2 : 1;
            for (int k = 0; k < copies; k++) {
                const dJointID hinge = dJointCreateHinge(world, 0);
                dJointAttach(hinge, body, before);
                dJointSetHingeAnchor(hinge, 0.3 * i, 0, 0);
                dJointSetHingeAxis(hinge, 0, 0, 1);
                assert_int_equal(jp_stops_create(play, hinge, &stops, &joint, NULL), JP_OK);
            }
        }
        before = body;
    }
    // integrating many contacts of a long step takes seconds
    const double longest = stepping == JP_STEPPING_IMPULSE ? -3.0 : -1.0;
    const double step = pow(10.0, longest - 1.5 + 1.5 * lcg_draw(&draw));
    size_t failed = 0;
    JpStatus status = JP_OK;
    for (int i = 0; i < WORLD_STEPS && status <= JP_OK; i++) {
        JpError error = {JP_OK, ""};
        status = jp_world_step(play, step, &error);
        // pins that would leave their holes are no failure of ODE
        failed += status > JP_OK && status != JP_ERROR_OUTSIDE ? 1 : 0;
        assert_true((status != JP_OK) == (strlen(error.text) > 10));
    }
    jp_world_destroy(play);
    dWorldDestroy(world);
    return failed;
}

static void random_worlds_at_long_steps_end_in_a_sentence(void **state)
{
    (void)state;
    for (int stepping = JP_STEPPING_PLAIN; stepping <= JP_STEPPING_IMPULSE; stepping++) {
        size_t failed = 0;
        for (unsigned seed = 0; seed < sample_size(WORLDS); seed++) {
            failed += play_random_world((JpStepping)stepping, seed);
        }
        // the control: some are beyond what ODE can step, most are not
        assert_true(failed > 0 && failed < sample_size(WORLDS) / 2);
    }
}

// ---- joints with any numbers ------------------------------------------------------------------

enum { HOSTILE_WORLDS = 400, HOSTILE_STEPS = 5 };

// Mostly an ordinary number, else one of the worst.
static double any_number(uint64_t *draw)
{
    static const double WORST[] = {0.0,   4.9e-324, 1e-310, 1e-160, 1e-30,   1e30,
                                   1e150, 1e308,    -1.0,   NAN,    INFINITY};
    const size_t count = sizeof WORST / sizeof *WORST;
    return lcg_draw(draw) > 0.4 ? WORST[(size_t)(0.5 * (lcg_draw(draw) + 1.0) * (double)count)]
                                : pow(10.0, 4.0 * lcg_draw(draw));
}

static JpContact any_contact(uint64_t *draw)
{
    JpContact contact = jp_contact_default();
    contact.stiffness = 1e4 * any_number(draw);
    contact.restitution = lcg_draw(draw) > 0.5 ? any_number(draw) : 0.5;
    contact.damping = lcg_draw(draw) > 0.0 ? JP_DAMPING_EXACT : JP_DAMPING_VISCOUS;
    contact.damper = any_number(draw);
    contact.exponent = lcg_draw(draw) > 0.5 ? any_number(draw) : 1.5;
    contact.speed_floor = lcg_draw(draw) > 0.8 ? any_number(draw) : 1e-6;
    return contact;
}

static void assert_all_finite(const double *numbers, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        assert_true(isfinite(numbers[i]));
    }
}

static void assert_finite_side(const JpSide *side)
{
    const double numbers[] = {side->force, side->force_max, side->depth_max,   side->impulse,
                              side->work,  side->stored,    side->impact_speed};
    assert_all_finite(numbers, sizeof numbers / sizeof *numbers);
}

// A joint with play of numbers that are drawn; NULL where it was refused.
static JpJoint *any_joint(JpWorld *play, dJointID hinge, dBodyID rod, uint64_t *draw)
{
    JpJoint *joint = NULL;
    if (lcg_draw(draw) > 0.3) {
        JpPinInHole pin = jp_pin_default();
        pin.hole_radius = 5e-3 * (1.0 + any_number(draw));
        pin.pin_radius = 4.9e-3;
        pin.width = lcg_draw(draw) > 0.0 ? any_number(draw) : 0.0;
        pin.axial_play = lcg_draw(draw) > 0.5 ? any_number(draw) : INFINITY;
        pin.friction = lcg_draw(draw) > 0.5 ? any_number(draw) : 0.0;
        pin.friction_speed = any_number(draw);
        pin.pin[0] = lcg_draw(draw) > 0.8 ? any_number(draw) : -0.15;
        pin.contact = any_contact(draw);
        return jp_pin_create(play, NULL, rod, &pin, &joint, NULL) == JP_OK ? joint : NULL;
    }
    JpBacklash backlash = jp_backlash_default();
    backlash.gap = 1e-3 * any_number(draw);
    backlash.rotor_inertia = any_number(draw);
    backlash.tooth = any_contact(draw);
    if (jp_backlash_create(play, hinge, &backlash, &joint, NULL) != JP_OK) {
        return NULL;
    }
    if (lcg_draw(draw) > 0.0) {
        jp_backlash_drive(joint, any_number(draw), NULL);
    } else if (lcg_draw(draw) > 0.0) {
        jp_backlash_lead(joint, any_number(draw), any_number(draw), NULL);
    } else {
        jp_backlash_hold(joint, any_number(draw), any_number(draw), any_number(draw), NULL);
    }
    return joint;
}

static void read_joint(const JpJoint *joint)
{
    JpJointState state;
    JpPinState pin;
    if (jp_joint_state(joint, &state, NULL) == JP_OK) {
        assert_all_finite(&state.position, 5);
        assert_finite_side(&state.low);
        assert_finite_side(&state.high);
    }
    if (jp_pin_state(joint, &pin, NULL) == JP_OK) {
        assert_all_finite(pin.eccentricity, 3);
        assert_all_finite(pin.force, 3);
        assert_true(isfinite(pin.axial) && isfinite(pin.tilt) && isfinite(pin.slid));
        for (int i = 0; i < 2; i++) {
            assert_finite_side(&pin.ends[i]);
            assert_finite_side(&pin.collars[i]);
        }
    }
}

static size_t play_hostile_world(JpStepping stepping, unsigned seed, size_t *messages)
{
    uint64_t draw = lcg_stirred(seed);
    Door door = door_make(stepping);
    dMass mass;
    const dBodyID rod = dBodyCreate(door.world);
    dMassSetBoxTotal(&mass, 1.0, 0.3, 0.02, 0.02);
    dBodySetMass(rod, &mass);
    dBodySetPosition(rod, 0.15, 0, 0);
    dWorldSetGravity(door.world, 0, -9.81, 0);
    jp_world_add_body(door.play, rod, NULL);
    JpJoint *joint = any_joint(door.play, door.hinge, rod, &draw);
    size_t stepped = 0;
    for (int i = 0; i < HOSTILE_STEPS && joint != NULL; i++) {
        const double step = lcg_draw(&draw) > 0.6 ? any_number(&draw) : 1e-3;
        JpError error;
        const JpStatus status = jp_world_step(door.play, step, &error);
        stepped += status == JP_OK ? 1 : 0;
        *messages += status == JP_COARSE && strstr(error.text, "LCP internal error") ? 1 : 0;
        read_joint(joint);
    }
    door_finish(&door);
    return stepped;
}

static size_t handed_on; // messages that reached the caller's handler

static void count_message(int number, const char *text, va_list arguments)
{
    (void)number;
    (void)text;
    (void)arguments;
    handed_on++;
}

static void joints_with_any_numbers_end_in_finite_numbers_or_a_sentence(void **state)
{
    (void)state;
    dMessageFunction *before = dGetMessageHandler();
    dSetMessageHandler(count_message);
    size_t messages = 0;
    handed_on = 0;
    // not with contacts within the step, of which the worst take a hundred thousand local steps
    for (int stepping = JP_STEPPING_PLAIN; stepping <= JP_STEPPING_STAGGERED; stepping++) {
        size_t stepped = 0;
        for (unsigned seed = 0; seed < sample_size(HOSTILE_WORLDS); seed++) {
            stepped += play_hostile_world((JpStepping)stepping, seed, &messages);
        }
        // the control: many were let in, and stepped
        assert_true(stepped > sample_size(HOSTILE_WORLDS) / 4);
    }
    // what ODE would have printed is in the sentences of steps; other messages are handed on
    assert_true(messages > 0);
    assert_int_equal(handed_on, 0);
    dMessage(0, "not of a step");
    assert_int_equal(handed_on, 1);
    dSetMessageHandler(before);
}

// ---- bodies that are destroyed ----------------------------------------------------------------

static void a_body_destroyed_under_its_joint_is_noticed(void **state)
{
    (void)state;
    for (int stepping = JP_STEPPING_PLAIN; stepping <= JP_STEPPING_IMPULSE; stepping++) {
        Door door = door_make((JpStepping)stepping);
        JpError error;
        JpJoint *joint = NULL;
        JpJointState hinge;
        JpPinState pinned;
        const dBodyID rod = dBodyCreate(door.world);
        JpPinInHole pin = jp_pin_default();
        pin.hole_radius = 5e-3;
        pin.pin_radius = 4.9e-3;
        pin.contact.stiffness = 1e6;
        assert_int_equal(jp_pin_create(door.play, NULL, rod, &pin, &joint, &error), JP_OK);
        assert_int_equal(jp_world_step(door.play, 1e-4, &error), JP_OK);
        dBodyDestroy(rod);
        assert_int_equal(jp_pin_state(joint, &pinned, &error), JP_ERROR_WORLD);
        assert_step_fails(door.play, door.body, 1e-4, JP_ERROR_WORLD);
        jp_joint_destroy(joint);
        assert_int_equal(jp_world_step(door.play, 1e-4, &error), JP_OK);
        dBodyDestroy(door.body);
        assert_int_equal(jp_joint_state(door.stops, &hinge, &error), JP_ERROR_WORLD);
        assert_int_equal(jp_world_step(door.play, 1e-4, &error), JP_ERROR_WORLD);
        jp_joint_destroy(door.stops);
        assert_int_equal(jp_world_step(door.play, 1e-4, &error), JP_OK);
        door_finish(&door);
    }
}

// ---- what a sentence says of a joint ------------------------------------------------------------

static void assert_says(JpWorld *play, double step, JpStatus status, const char *says)
{
    JpError error;
    const JpStatus found = jp_world_step(play, step, &error);
    if (found != status || strstr(error.text, says) == NULL) {
        fail_msg("\"%s\" is not in \"%s\"", says, error.text);
    }
}

// A second joint on the door's hinge, whose law holds to A e^(B - 1), and a pin.
static void a_depth_beyond_a_law_is_said_of_which_joint_and_in_which_unit(void **state)
{
    (void)state;
    JpStops stops = jp_stops_default();
    stops.high = 0.005;
    stops.contact.compliance = 1e-5;
    stops.contact.offset = 1.0;
    JpJoint *joint = NULL;
    Door door = door_make(JP_STEPPING_STAGGERED);
    assert_int_equal(jp_stops_create(door.play, door.hinge, &stops, &joint, NULL), JP_OK);
    assert_says(door.play, 0.016, JP_ERROR_WORLD,
                "joint 2 (stops) is 0.0110024 rad beyond its play, "
                "and its contact's law holds to 1e-05 rad");
    jp_joint_destroy(joint);
    JpPinInHole pin = jp_pin_default();
    pin.hole_radius = 5e-3;
    pin.pin_radius = 4.9e-3;
    pin.contact = stops.contact;
    const dBodyID rod = dBodyCreate(door.world);
    dBodySetLinearVel(rod, 1.0, 0, 0);
    assert_int_equal(jp_pin_create(door.play, NULL, rod, &pin, &joint, NULL), JP_OK);
    assert_says(door.play, 2.5e-4, JP_ERROR_WORLD, "joint 2 (pin) is 0.00015 m beyond its play");
    dBodySetPosition(rod, 1, 0, 0);
    assert_says(door.play, 1e-4, JP_ERROR_OUTSIDE, "the pin of 0.0049 m radius, joint 2, is");
    dBodyDestroy(rod);
    assert_says(door.play, 1e-4, JP_ERROR_WORLD, "a body of joint 2 (pin) was destroyed");
    jp_joint_destroy(joint);
    door_finish(&door);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(numbers_out_of_range_are_refused),
        cmocka_unit_test(what_ode_asserts_is_an_error),
        cmocka_unit_test(speeds_that_a_joint_forbids_are_corrected_and_coarse),
        cmocka_unit_test(random_worlds_at_long_steps_end_in_a_sentence),
        cmocka_unit_test(joints_with_any_numbers_end_in_finite_numbers_or_a_sentence),
        cmocka_unit_test(a_body_destroyed_under_its_joint_is_noticed),
        cmocka_unit_test(a_depth_beyond_a_law_is_said_of_which_joint_and_in_which_unit),
    };
    return cmocka_run_group_tests(tests, ode_group_setup, ode_group_teardown);
}
