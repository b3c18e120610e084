// Does a step say that it is too long for what happens in it, and is one without that status right?
#include "close.h"

#include "ode_group.h"

#include <jointplay/jointplay.h>

#include <string.h>

enum { CHAIN = 3, PINS_MOST = 3000 };

static const double PLAY = 15e-6; // m
static const double PIN_RADIUS = 4.985e-3;

// Rods of .3 m that hang level on steel pins, one on the next, and are let go.
typedef struct Chain {
    dWorldID world;
    JpWorld *play;
    dBodyID rods[CHAIN];
    JpJoint *pins[CHAIN];
} Chain;

static JpPinInHole steel_pin(void)
{
    const JpPin sizes = {.hole_radius = PIN_RADIUS + PLAY,
                         .pin_radius = PIN_RADIUS,
                         .width = 0.02,
                         .youngs_modulus = 207e9,
                         .poisson_ratio = 0.3};
    JpPinInHole pin = jp_pin_default();
    pin.hole_radius = sizes.hole_radius;
    pin.pin_radius = sizes.pin_radius;
    assert_int_equal(jp_contact_of_pin(JP_PIN_HERTZ, &sizes, &pin.contact, NULL), JP_OK);
    return pin;
}

static dBodyID add_rod(dWorldID world, double x)
{
    dMass mass;
    dMassSetBoxTotal(&mass, 0.5, 0.3, 0.02, 0.02);
    const dBodyID rod = dBodyCreate(world);
    dBodySetMass(rod, &mass);
    dBodySetPosition(rod, x, 0, 0);
    return rod;
}

static Chain make_chain(int rods, JpStepping stepping)
{
    Chain chain = {.world = dWorldCreate()};
    dWorldSetGravity(chain.world, 0, -9.81, 0);
    JpWorldOptions options = jp_world_options_default();
    options.stepping = stepping;
    assert_int_equal(jp_world_create(chain.world, &options, &chain.play, NULL), JP_OK);
    JpPinInHole pin = steel_pin();
    pin.pin[0] = -0.15;
    for (int i = 0; i < rods; i++) {
        chain.rods[i] = add_rod(chain.world, 0.15 + 0.3 * i);
        pin.hole[0] = i == 0 ? 0.0 : 0.15;
        assert_int_equal(jp_pin_create(chain.play, i == 0 ? NULL : chain.rods[i - 1], chain.rods[i],
                                       &pin, &chain.pins[i], NULL),
                         JP_OK);
    }
    return chain;
}

static void finish_chain(Chain *chain)
{
    jp_world_destroy(chain->play);
    dWorldDestroy(chain->world);
}

// The largest force of the last pin after a time, s, and the steps that were coarse.
static double largest_force(int rods, JpStepping stepping, double step, double time, size_t *coarse)
{
    Chain chain = make_chain(rods, stepping);
    JpPinState state;
    JpWorldStats stats;
    const long count = lround(time / step);
    for (long i = 0; i < count; i++) {
        JpError error;
        const JpStatus status = jp_world_step(chain.play, step, &error);
        assert_true(status <= JP_OK);
        assert_int_equal(error.status, status);
        assert_true((status == JP_COARSE) == (strlen(error.text) > 10));
    }
    assert_int_equal(jp_pin_state(chain.pins[rods - 1], &state, NULL), JP_OK);
    assert_int_equal(jp_world_stats(chain.play, &stats, NULL), JP_OK);
    *coarse = stats.coarse;
    finish_chain(&chain);
    return state.ends[0].force_max;
}

// The truth is rows that resolve each contact, another method.
static void a_chain_whose_steps_are_not_coarse_has_the_right_largest_force(void **state)
{
    (void)state;
    size_t coarse;
    const double truth = largest_force(CHAIN, JP_STEPPING_STAGGERED, 4e-6, 0.5, &coarse);
    assert_int_equal(coarse, 0);
    const double found = largest_force(CHAIN, JP_STEPPING_IMPULSE, 2e-4, 0.5, &coarse);
    assert_int_equal(coarse, 0);
    assert_near(found / truth, 1.0, 0.05);
    // the control: a step that is too long
    const double rough = largest_force(CHAIN, JP_STEPPING_IMPULSE, 2e-3, 0.5, &coarse);
    assert_true(coarse > 0);
    assert_true(fabs(rough / truth - 1.0) > 0.2);
}

static void contacts_of_few_steps_are_coarse_with_rows(void **state)
{
    (void)state;
    size_t coarse;
    for (int stepping = JP_STEPPING_PLAIN; stepping <= JP_STEPPING_STAGGERED; stepping++) {
        const double truth = largest_force(1, JP_STEPPING_IMPULSE, 1e-4, 0.02, &coarse);
        assert_int_equal(coarse, 0);
        const double found = largest_force(1, (JpStepping)stepping, 5e-6, 0.02, &coarse);
        assert_int_equal(coarse, 0);
        assert_near(found / truth, 1.0, 0.05);
        const double rough = largest_force(1, (JpStepping)stepping, 2e-4, 0.02, &coarse);
        assert_true(coarse > 0);
        assert_true(fabs(rough / truth - 1.0) > 0.2);
    }
}

// ---- pins outside their holes -----------------------------------------------------------------

static void a_pin_is_made_in_its_hole(void **state)
{
    (void)state;
    Chain chain = make_chain(0, JP_STEPPING_IMPULSE);
    const dBodyID rod = add_rod(chain.world, 0);
    JpPinInHole pin = steel_pin();
    JpJoint *joint = NULL;
    JpError error;
    // the pin's diameter is more than ten times the play
    pin.hole[1] = PLAY + 1.01 * 2.0 * PIN_RADIUS;
    assert_int_equal(jp_pin_create(chain.play, NULL, rod, &pin, &joint, &error), JP_ERROR_OUTSIDE);
    assert_null(joint);
    assert_non_null(strstr(error.text, "0.010"));
    assert_non_null(strstr(error.text, "at most"));
    // the control
    pin.hole[1] = PLAY + 0.99 * 2.0 * PIN_RADIUS;
    assert_int_equal(jp_pin_create(chain.play, NULL, rod, &pin, &joint, &error), JP_OK);
    // likewise at a collar
    pin.axial_play = 1e-4;
    pin.hole[2] = 1.1e-2;
    assert_int_equal(jp_pin_create(chain.play, NULL, rod, &pin, &joint, &error), JP_ERROR_OUTSIDE);
    assert_non_null(strstr(error.text, "collar"));
    finish_chain(&chain);
}

static void a_body_that_is_moved_out_of_its_hole_is_an_error(void **state)
{
    (void)state;
    for (int stepping = JP_STEPPING_PLAIN; stepping <= JP_STEPPING_IMPULSE; stepping++) {
        Chain chain = make_chain(1, (JpStepping)stepping);
        JpError error;
        JpPinState pin;
        assert_int_equal(jp_world_step(chain.play, 1e-6, &error), JP_OK);
        dBodySetPosition(chain.rods[0], 100.15, 0, 0);
        assert_int_equal(jp_world_step(chain.play, 1e-6, &error), JP_ERROR_OUTSIDE);
        assert_near(dBodyGetPosition(chain.rods[0])[0], 100.15, 0.0);
        assert_int_equal(jp_pin_state(chain.pins[0], &pin, NULL), JP_OK);
        assert_near(pin.ends[0].force_max, 0.0, 0.0);
        // a step that would throw it out; a contact within the step holds it
        dBodySetPosition(chain.rods[0], 0.15, 0, 0);
        dBodySetLinearVel(chain.rods[0], 50, 0, 0);
        assert_int_equal(jp_world_step(chain.play, 1e-3, &error),
                         stepping == JP_STEPPING_IMPULSE ? JP_OK : JP_ERROR_OUTSIDE);
        dBodySetPosition(chain.rods[0], 0.15, 0, 0);
        assert_near(dBodyGetPosition(chain.rods[0])[0], 0.15, 0.0);
        // the control
        dBodySetLinearVel(chain.rods[0], 0, 0, 0);
        assert_int_equal(jp_world_step(chain.play, 1e-6, &error), JP_OK);
        finish_chain(&chain);
    }
}

// ---- work -------------------------------------------------------------------------------------

// A step in which so many pins of one rod touch at once.
static JpStatus step_many(int pins, double work, JpError *error)
{
    Chain chain = make_chain(0, JP_STEPPING_IMPULSE);
    const dBodyID rod = add_rod(chain.world, 0);
    JpPinInHole pin = jp_pin_default();
    pin.hole_radius = 5e-3;
    pin.pin_radius = 4.95e-3;
    pin.contact.stiffness = 1e6;
    for (int i = 0; i < pins; i++) {
        JpJoint *joint;
        pin.hole[0] = pin.pin[0] = -0.15 + 0.3 * i / pins;
        assert_int_equal(jp_pin_create(chain.play, NULL, rod, &pin, &joint, error), JP_OK);
    }
    assert_int_equal(jp_world_set_work_limit(chain.play, work, error), JP_OK);
    dBodySetLinearVel(rod, 0, -0.1, 0);
    const JpStatus status = jp_world_step(chain.play, 1e-3, error);
    finish_chain(&chain);
    return status;
}

static void a_step_ends_at_the_limit_of_work(void **state)
{
    (void)state;
    JpError error;
    assert_int_equal(step_many(3, JP_WORK_DEFAULT, &error), JP_OK);
    // rows take less
    assert_int_equal(step_many(3, 5e3, &error), JP_COARSE);
    assert_non_null(strstr(error.text, "limit of work"));
    // and at most the cube of their number
    assert_int_equal(step_many(3, 20.0, &error), JP_ERROR_WORK);
    assert_int_equal(step_many(PINS_MOST, JP_WORK_DEFAULT, &error), JP_ERROR_WORK);
    assert_non_null(strstr(error.text, "jp_world_set_work_limit"));
    Chain chain = make_chain(0, JP_STEPPING_IMPULSE);
    assert_int_equal(jp_world_set_work_limit(chain.play, 0.0, &error), JP_ERROR_ARGUMENT);
    assert_int_equal(jp_world_set_work_limit(chain.play, NAN, &error), JP_ERROR_ARGUMENT);
    finish_chain(&chain);
}

// ---- taking a step back -----------------------------------------------------------------------

typedef struct Snapshot {
    dReal numbers[13];
    JpPinState pin;
    JpWorldStats stats;
} Snapshot;

static Snapshot look(const Chain *chain)
{
    Snapshot seen;
    memset(&seen, 0, sizeof seen);
    const dBodyID rod = chain->rods[0];
    memcpy(seen.numbers, dBodyGetPosition(rod), 3 * sizeof(dReal));
    memcpy(seen.numbers + 3, dBodyGetQuaternion(rod), 4 * sizeof(dReal));
    memcpy(seen.numbers + 7, dBodyGetLinearVel(rod), 3 * sizeof(dReal));
    memcpy(seen.numbers + 10, dBodyGetForce(rod), 3 * sizeof(dReal));
    assert_int_equal(jp_pin_state(chain->pins[0], &seen.pin, NULL), JP_OK);
    assert_int_equal(jp_world_stats(chain->play, &seen.stats, NULL), JP_OK);
    return seen;
}

static void assert_seen_alike(const Snapshot *one, const Snapshot *other)
{
    for (size_t i = 0; i < sizeof one->numbers / sizeof *one->numbers; i++) {
        // ODE makes quaternions anew of length 1
        assert_near(one->numbers[i], other->numbers[i], 1e-15);
    }
    for (int i = 0; i < 3; i++) {
        assert_near(one->pin.eccentricity[i], other->pin.eccentricity[i], 1e-15);
    }
    assert_true(one->pin.ends[0].force_max == other->pin.ends[0].force_max);
    assert_true(one->pin.ends[0].work == other->pin.ends[0].work);
    assert_int_equal(one->pin.ends[0].impacts, other->pin.ends[0].impacts);
    assert_int_equal(one->stats.steps, other->stats.steps);
    assert_int_equal(one->stats.coarse, other->stats.coarse);
}

static void a_step_is_taken_back_once(void **state)
{
    (void)state;
    for (int stepping = JP_STEPPING_PLAIN; stepping <= JP_STEPPING_IMPULSE; stepping++) {
        Chain chain = make_chain(1, (JpStepping)stepping);
        JpError error;
        assert_int_equal(jp_world_undo(chain.play, &error), JP_ERROR_NONE);
        for (int i = 0; i < 4; i++) {
            assert_true(jp_world_step(chain.play, 1e-3, &error) <= JP_OK);
        }
        dBodyAddForce(chain.rods[0], 1, 2, 3);
        const Snapshot before = look(&chain);
        assert_true(jp_world_step(chain.play, 1e-3, &error) <= JP_OK);
        const Snapshot after = look(&chain);
        assert_true(memcmp(before.numbers, after.numbers, sizeof before.numbers) != 0);
        assert_int_equal(jp_world_undo(chain.play, &error), JP_OK);
        const Snapshot back = look(&chain);
        assert_seen_alike(&before, &back);
        assert_int_equal(jp_world_undo(chain.play, &error), JP_ERROR_NONE);
        assert_true(strlen(error.text) > 10);
        // not where a joint has come
        assert_true(jp_world_step(chain.play, 1e-6, &error) <= JP_OK);
        JpJoint *joint;
        JpPinInHole pin = steel_pin();
        assert_int_equal(
            jp_pin_create(chain.play, NULL, add_rod(chain.world, 0), &pin, &joint, &error), JP_OK);
        assert_int_equal(jp_world_undo(chain.play, &error), JP_ERROR_NONE);
        assert_int_equal(jp_world_undo(NULL, &error), JP_ERROR_ARGUMENT);
        finish_chain(&chain);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_chain_whose_steps_are_not_coarse_has_the_right_largest_force),
        cmocka_unit_test(contacts_of_few_steps_are_coarse_with_rows),
        cmocka_unit_test(a_pin_is_made_in_its_hole),
        cmocka_unit_test(a_body_that_is_moved_out_of_its_hole_is_an_error),
        cmocka_unit_test(a_step_ends_at_the_limit_of_work),
        cmocka_unit_test(a_step_is_taken_back_once),
    };
    return cmocka_run_group_tests(tests, ode_group_setup, ode_group_teardown);
}
