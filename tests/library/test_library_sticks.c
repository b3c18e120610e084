// Does a pin of the library hold what friction holds?
//
// A lever has its pin, with play, in a fixed hole, and its centre of mass beside the pin. With c
// that offset, b the arm of friction about the pin's axis, |e| off the hole's centre, of a hole of
// the radius R, statics has the contact at an angle of phi from below, and a bristle bent by z:
//     b = R - |e|,   sin phi = c / b,   tan phi = mu s,   s = r z / D,   r the breakaway ratio
// as long as s is below r. The controls: regularized friction creeps, by its law at a speed of
// v_s atanh s, and a lever beyond what friction holds turns.
#include "close.h"

#include "ode_group.h"

#include <jointplay/jointplay.h>

#include <math.h>
#include <ode/ode.h>
#include <string.h>

#define must(call)      assert_int_equal((call), JP_OK)
#define must_step(call) assert_true((call) <= JP_OK)

static const double PIN_RADIUS = 10e-3; // m
static const double PLAY = 50e-6;       // m
static const double FRICTION = 0.1;
static const double STEP_S = 500e-6;
static const double GRAVITY = 9.81; // m/s^2

typedef struct Lever {
    dWorldID world;
    dBodyID body;
    JpWorld *play;
    JpJoint *pin;
} Lever;

// A lever of 1 kg whose centre of mass is so far to the right of its pin, m, which lies on the wall
// below.
static Lever lever_make(double beside, const JpPinInHole *friction)
{
    Lever lever = {.world = dWorldCreate()};
    dMass mass;
    dMassSetParameters(&mass, 1.0, 0, 0, 0, 500e-6, 500e-6, 500e-6, 0, 0, 0);
    lever.body = dBodyCreate(lever.world);
    dBodySetMass(lever.body, &mass);
    dBodySetPosition(lever.body, beside, -PLAY, 0);
    JpWorldOptions options = jp_world_options_default();
    options.stepping = JP_STEPPING_IMPULSE;
    must(jp_world_create(lever.world, &options, &lever.play, NULL));
    JpPinInHole pin = *friction;
    pin.hole_radius = PIN_RADIUS + PLAY;
    pin.pin_radius = PIN_RADIUS;
    pin.pin[0] = -beside;
    pin.contact.stiffness = 1e7;
    pin.contact.damping = JP_DAMPING_VISCOUS;
    must(jp_damper_of(pin.contact.stiffness, 0.3, 1.0, &pin.contact.damper, NULL));
    must(jp_pin_create(lever.play, NULL, lever.body, &pin, &lever.pin, NULL));
    return lever;
}

static void lever_finish(Lever *lever)
{
    jp_world_destroy(lever->play);
    dWorldDestroy(lever->world);
}

// Makes steps from a time to another; the weight comes within the first tenth of a second.
static void run(Lever *lever, double from_s, double to_s)
{
    static const double COMES_S = 0.1;
    for (int i = (int)round(from_s / STEP_S); i < (int)round(to_s / STEP_S); i++) {
        dWorldSetGravity(lever->world, 0, -GRAVITY * fmin(1.0, (i + 1) * STEP_S / COMES_S), 0);
        must_step(jp_world_step(lever->play, STEP_S, NULL));
    }
}

static double turn_of(const Lever *lever)
{
    const dReal *turn = dBodyGetQuaternion(lever->body);
    return 2.0 * atan2(turn[3], turn[0]);
}

static JpPinInHole stick(double ratio)
{
    JpPinInHole pin = jp_pin_default();
    pin.friction = FRICTION;
    pin.friction_law = JP_FRICTION_STICK;
    pin.breakaway_ratio = ratio;
    return pin;
}

static void a_lever_holds_with_the_bend_that_statics_gives(void **state)
{
    (void)state;
    static const struct {
        double beside; // m
        double ratio;
        double presliding; // m
    } CASES[] = {{0.5e-3, 1.0, 5e-6}, {-0.8e-3, 1.0, 2e-6}, {1.2e-3, 1.5, 5e-6}};
    for (size_t i = 0; i < sizeof CASES / sizeof *CASES; i++) {
        JpPinInHole pin = stick(CASES[i].ratio);
        pin.presliding = CASES[i].presliding;
        Lever lever = lever_make(CASES[i].beside, &pin);
        run(&lever, 0.0, 3.0); // its swinging on the bristle has come to rest by then
        const double before = turn_of(&lever);
        run(&lever, 3.0, 10.0);
        JpPinState now;
        must(jp_pin_state(lever.pin, &now, NULL));
        const double c = CASES[i].beside * cos(turn_of(&lever));
        const double b = PIN_RADIUS + PLAY - hypot(now.eccentricity[0], now.eccentricity[1]);
        const double wanted = -tan(asin(c / b)) / FRICTION * pin.presliding / CASES[i].ratio;
        const double crept = fabs(turn_of(&lever) - before) * PIN_RADIUS / pin.presliding;
        print_message("# %g mm: in 7 s it turns by %.1e of the presliding; bend %.4g um, off by "
                      "%.1e\n",
                      1e3 * CASES[i].beside, crept, 1e6 * now.bend, fabs(now.bend / wanted - 1.0));
        // rounding, some 1e-15 rad a step
        assert_true(crept < 1e-6);
        assert_near(now.bend, wanted, 1e-9 * pin.presliding);
        assert_true(now.is_touching);
        lever_finish(&lever);
    }
}

static void a_lever_that_friction_does_not_hold_turns(void **state)
{
    (void)state;
    JpPinInHole pin = stick(1.0);
    pin.friction_law = JP_FRICTION_REGULARIZED;
    Lever creeping = lever_make(0.5e-3, &pin);
    run(&creeping, 0.0, 1.0);
    const double before = turn_of(&creeping);
    run(&creeping, 1.0, 1.1);
    const double rate = -pin.friction_speed * atanh(0.5) / PIN_RADIUS;
    print_message("# regularized: %.3f rad in the first second\n", before);
    // c and tan phi change by some parts in a thousand as it turns
    assert_near(turn_of(&creeping) - before, 0.1 * rate, 0.01 * fabs(0.1 * rate));
    JpPinState now;
    must(jp_pin_state(creeping.pin, &now, NULL));
    assert_true(now.bend == 0.0);
    lever_finish(&creeping);
    // beyond what sliding friction holds
    pin = stick(1.0);
    Lever sliding = lever_make(1.2e-3, &pin);
    run(&sliding, 0.0, 1.0);
    print_message("# beyond its circle: %.3f rad in the first second\n", turn_of(&sliding));
    assert_true(turn_of(&sliding) < -0.5);
    must(jp_pin_state(sliding.pin, &now, NULL));
    assert_true(now.slid > 0.0);
    lever_finish(&sliding);
}

static void assert_says(const JpPinInHole *pin, JpStepping stepping, const char *says)
{
    JpWorldOptions options = jp_world_options_default();
    options.stepping = stepping;
    JpWorld *play;
    JpJoint *joint = NULL;
    JpError error;
    const dWorldID world = dWorldCreate();
    must(jp_world_create(world, &options, &play, NULL));
    assert_int_equal(jp_pin_create(play, NULL, dBodyCreate(world), pin, &joint, &error),
                     JP_ERROR_ARGUMENT);
    if (strstr(error.text, says) == NULL) {
        fail_msg("\"%s\" is not in \"%s\"", says, error.text);
    }
    assert_null(joint);
    jp_world_destroy(play);
    dWorldDestroy(world);
}

static JpPinInHole good(void)
{
    JpPinInHole pin = stick(1.0);
    pin.hole_radius = PIN_RADIUS + PLAY;
    pin.pin_radius = PIN_RADIUS;
    pin.contact.stiffness = 1e8;
    return pin;
}

static void what_cannot_stick_is_refused_by_name(void **state)
{
    (void)state;
    JpPinInHole pin = good();
    assert_says(&pin, JP_STEPPING_PLAIN, "worlds with JP_STEPPING_IMPULSE");
    assert_says(&pin, JP_STEPPING_STAGGERED, "worlds with JP_STEPPING_IMPULSE");
    pin.width = 0.01;
    assert_says(&pin, JP_STEPPING_IMPULSE, "this one has a width of 0.01");
    pin = good();
    pin.friction_law = (JpFrictionLaw)7;
    assert_says(&pin, JP_STEPPING_IMPULSE, "the law of friction is 7");
    pin = good();
    pin.presliding = 0.0;
    assert_says(&pin, JP_STEPPING_IMPULSE, "the presliding is 0");
    pin = good();
    pin.breakaway_ratio = 0.5;
    assert_says(&pin, JP_STEPPING_IMPULSE, "the breakaway ratio is 0.5");
    pin.breakaway_ratio = NAN;
    assert_says(&pin, JP_STEPPING_IMPULSE, "the breakaway ratio is nan");
    pin = good();
    pin.presliding_damping = -1.0;
    assert_says(&pin, JP_STEPPING_IMPULSE, "the presliding's damping is -1");
    pin = good();
    pin.presliding_mass = INFINITY;
    assert_says(&pin, JP_STEPPING_IMPULSE, "the presliding's mass is inf");
}

static void a_bend_is_taken_where_there_is_a_bristle(void **state)
{
    (void)state;
    JpPinInHole pin = stick(1.0);
    Lever lever = lever_make(0.0, &pin);
    dBodySetPosition(lever.body, 0, -PLAY - 1e-8, 0);
    JpBegun begun = {.impact_speed = 1e-3, .bend = 2e-6};
    must(jp_joint_begun(lever.pin, 0, &begun, NULL));
    JpPinState now;
    must(jp_pin_state(lever.pin, &now, NULL));
    assert_true(now.bend == begun.bend);
    JpError error;
    begun.bend = -5.1e-6;
    assert_int_equal(jp_joint_begun(lever.pin, 0, &begun, &error), JP_ERROR_ARGUMENT);
    assert_non_null(strstr(error.text, "bends by 5e-06 m at most"));
    begun.bend = NAN;
    assert_int_equal(jp_joint_begun(lever.pin, 0, &begun, &error), JP_ERROR_ARGUMENT);
    lever_finish(&lever);
    pin.friction_law = JP_FRICTION_REGULARIZED;
    lever = lever_make(0.0, &pin);
    dBodySetPosition(lever.body, 0, -PLAY - 1e-8, 0);
    begun.bend = 1e-6;
    assert_int_equal(jp_joint_begun(lever.pin, 0, &begun, &error), JP_ERROR_ARGUMENT);
    begun.bend = 0.0;
    must(jp_joint_begun(lever.pin, 0, &begun, NULL));
    lever_finish(&lever);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_lever_holds_with_the_bend_that_statics_gives),
        cmocka_unit_test(a_lever_that_friction_does_not_hold_turns),
        cmocka_unit_test(what_cannot_stick_is_refused_by_name),
        cmocka_unit_test(a_bend_is_taken_where_there_is_a_bristle),
    };
    return cmocka_run_group_tests(tests, ode_group_setup, ode_group_teardown);
}
