// Do bodies that no joint with play reaches go as they would alone, and the others as if all were
// stepped?
#include "close.h"

#include "ode_group.h"

#include <jointplay/jointplay.h>

#include <string.h>

enum { FAR_LINKS = 2, STEPS = 150 };

static const double STEP = 1e-3; // s

// A rod on a pin that knocks, a ball that lies on it by ODE's contacts, and a chain far away.
typedef struct Scene {
    dWorldID world;
    dSpaceID space;
    JpWorld *play;
    JpJoint *pin;
    dBodyID rod;
    dBodyID ball;
    dBodyID links[FAR_LINKS];
} Scene;

static dBodyID add_body(dWorldID world, double x, double y)
{
    dMass mass;
    const dBodyID body = dBodyCreate(world);
    dMassSetBoxTotal(&mass, 0.5, 0.3, 0.02, 0.1);
    dBodySetMass(body, &mass);
    dBodySetPosition(body, x, y, 0);
    return body;
}

static void add_pin(Scene *scene)
{
    JpError error;
    JpPinInHole pin = jp_pin_default();
    pin.hole_radius = 5e-3;
    pin.pin_radius = 4.95e-3;
    pin.width = 0.05;
    pin.axial_play = 1e-4;
    pin.pin[0] = -0.12;
    pin.contact.stiffness = 1e8;
    pin.contact.exponent = 1.5;
    scene->rod = add_body(scene->world, 0.12, 0);
    scene->ball = add_body(scene->world, 0.08, 0.0199);
    dGeomSetBody(dCreateBox(scene->space, 0.3, 0.02, 0.1), scene->rod);
    dGeomSetBody(dCreateSphere(scene->space, 0.01), scene->ball);
    assert_int_equal(jp_pin_create(scene->play, NULL, scene->rod, &pin, &scene->pin, &error),
                     JP_OK);
}

static void add_far_chain(Scene *scene)
{
    dBodyID before = NULL;
    for (int i = 0; i < FAR_LINKS; i++) {
        scene->links[i] = add_body(scene->world, 10.15 + 0.3 * i, 0);
        const dJointID hinge = dJointCreateHinge(scene->world, 0);
        dJointAttach(hinge, scene->links[i], before);
        dJointSetHingeAnchor(hinge, 10.0 + 0.3 * i, 0, 0);
        dJointSetHingeAxis(hinge, 0, 0, 1);
        before = scene->links[i];
    }
}

static Scene make_scene(bool has_pin, bool has_chain)
{
    Scene scene = {.world = dWorldCreate(), .space = dSimpleSpaceCreate(0)};
    dWorldSetGravity(scene.world, 0, -9.81, 0);
    dWorldSetContactSurfaceLayer(scene.world, 1e-4);
    JpWorldOptions options = jp_world_options_default();
    options.stepping = JP_STEPPING_IMPULSE;
    options.space = scene.space;
    assert_int_equal(jp_world_create(scene.world, &options, &scene.play, NULL), JP_OK);
    if (has_chain) {
        add_far_chain(&scene);
    }
    if (has_pin) {
        add_pin(&scene);
    }
    return scene;
}

static JpStatus run(Scene *scene)
{
    JpStatus status = JP_OK;
    JpError error;
    for (int i = 0; i < STEPS && status <= JP_OK; i++) {
        status = jp_world_step(scene->play, STEP, &error);
    }
    return status > JP_OK ? status : JP_OK; // coarse steps are made alike
}

static void finish_scene(Scene *scene)
{
    jp_world_destroy(scene->play);
    dSpaceDestroy(scene->space);
    dWorldDestroy(scene->world);
}

static void assert_alike(dBodyID one, dBodyID other)
{
    assert_memory_equal(dBodyGetPosition(one), dBodyGetPosition(other), 3 * sizeof(dReal));
    assert_memory_equal(dBodyGetQuaternion(one), dBodyGetQuaternion(other), 4 * sizeof(dReal));
    assert_memory_equal(dBodyGetLinearVel(one), dBodyGetLinearVel(other), 3 * sizeof(dReal));
}

static void bodies_that_no_pin_reaches_go_as_they_would_alone(void **state)
{
    (void)state;
    Scene with = make_scene(true, true);
    Scene alone = make_scene(false, true);
    assert_int_equal(jp_world_add_all(with.play, NULL), JP_OK);
    assert_int_equal(jp_world_add_all(alone.play, NULL), JP_OK);
    assert_int_equal(run(&with), JP_OK);
    assert_int_equal(run(&alone), JP_OK);
    JpPinState pin;
    assert_int_equal(jp_pin_state(with.pin, &pin, NULL), JP_OK);
    assert_true(pin.ends[0].impacts > 0);
    for (int i = 0; i < FAR_LINKS; i++) {
        assert_alike(with.links[i], alone.links[i]);
        assert_true(dBodyIsEnabled(with.links[i]));
    }
    finish_scene(&with);
    finish_scene(&alone);
}

// With a body that ODE may disable, all bodies are stepped for each trial.
static void what_a_pin_reaches_by_contacts_goes_as_if_all_were_stepped(void **state)
{
    (void)state;
    Scene few = make_scene(true, true);
    Scene all = make_scene(true, true);
    Scene lone = make_scene(true, false);
    dBodySetAutoDisableFlag(all.links[0], 1);
    dBodySetAutoDisableSteps(all.links[0], 1 << 30);
    dBodySetAutoDisableTime(all.links[0], 1e30);
    dBodyDestroy(lone.ball);
    assert_int_equal(jp_world_add_all(few.play, NULL), JP_OK);
    assert_int_equal(jp_world_add_all(all.play, NULL), JP_OK);
    assert_int_equal(run(&few), JP_OK);
    assert_int_equal(run(&all), JP_OK);
    assert_int_equal(run(&lone), JP_OK);
    JpWorldStats stats[2];
    jp_world_stats(few.play, &stats[0], NULL);
    jp_world_stats(all.play, &stats[1], NULL);
    assert_true(stats[0].world_steps > 2 * STEPS);
    assert_near(dBodyGetPosition(few.rod)[1], dBodyGetPosition(all.rod)[1], 1e-6);
    assert_near(dBodyGetPosition(few.ball)[1], dBodyGetPosition(all.ball)[1], 1e-6);
    // the control: the ball is felt
    assert_true(fabs(dBodyGetPosition(few.rod)[1] - dBodyGetPosition(lone.rod)[1]) > 1e-5);
    finish_scene(&few);
    finish_scene(&all);
    finish_scene(&lone);
}

static void all_bodies_of_a_world_are_added(void **state)
{
    (void)state;
    JpError error;
    Scene scene = make_scene(true, true);
    // the control: those that no joint leads to are missed
    assert_int_equal(jp_world_step(scene.play, STEP, &error), JP_ERROR_WORLD);
    assert_non_null(strstr(error.text, "2 bodies"));
    assert_int_equal(jp_world_add_all(scene.play, &error), JP_OK);
    assert_int_equal(jp_world_step(scene.play, STEP, &error), JP_OK);
    assert_int_equal(jp_world_remove_body(scene.play, scene.links[1], &error), JP_OK);
    assert_int_equal(jp_world_add_all(scene.play, &error), JP_OK);
    const dWorldID empty = dWorldCreate();
    JpWorld *none = NULL;
    assert_int_equal(jp_world_create(empty, NULL, &none, NULL), JP_OK);
    assert_int_equal(jp_world_add_all(none, &error), JP_OK);
    assert_int_equal(jp_world_step(none, STEP, &error), JP_OK);
    jp_world_destroy(none);
    dWorldDestroy(empty);
    finish_scene(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(bodies_that_no_pin_reaches_go_as_they_would_alone),
        cmocka_unit_test(what_a_pin_reaches_by_contacts_goes_as_if_all_were_stepped),
        cmocka_unit_test(all_bodies_of_a_world_are_added),
    };
    return cmocka_run_group_tests(tests, ode_group_setup, ode_group_teardown);
}
