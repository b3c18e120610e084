// Is a world still whole after a call without memory?
//
// The library is linked in with its allocations led through here, and so are ODE's, by its
// handlers. One at a time fails in a scene with stops, backlash and a pin, made, stepped with every
// stepping, taken back, saved and resumed; each time the call says JP_ERROR_MEMORY, and the same
// call once more goes well.
#include "close.h"

#include "ode_group.h"

#include <jointplay/jointplay.h>

#include <stdlib.h>
#include <string.h>

// After the first EACH allocations of a scene the distance between those that fail grows by as
// many.
enum { EACH = 32, STEPS = 30 };

// with it the arms meet their stops on the way
static const double STEP_S = 2e-3;

// Allocations until the one that fails; below 0 none does.
static long until_failure = -1;
static bool has_failed;

static bool fails(void)
{
    const bool is_due = until_failure == 0;
    has_failed = has_failed || is_due;
    until_failure -= until_failure >= 0 ? 1 : 0;
    return is_due;
}

void *__real_malloc(size_t size);
void *__real_calloc(size_t count, size_t size);
void *__real_realloc(void *old, size_t size);
void *__wrap_malloc(size_t size);
void *__wrap_calloc(size_t count, size_t size);
void *__wrap_realloc(void *old, size_t size);

void *__wrap_malloc(size_t size)
{
    return fails() ? NULL : __real_malloc(size);
}

void *__wrap_calloc(size_t count, size_t size)
{
    return fails() ? NULL : __real_calloc(count, size);
}

void *__wrap_realloc(void *old, size_t size)
{
    return fails() ? NULL : __real_realloc(old, size);
}

static void *allocate_for_ode(size_t size)
{
    return fails() ? NULL : __real_malloc(size);
}

static void *reallocate_for_ode(void *old, size_t old_size, size_t size)
{
    (void)old_size;
    return fails() ? NULL : __real_realloc(old, size);
}

typedef struct Scene {
    dWorldID world;
    dBodyID arms[2];
    dBodyID rod;
    dBodyID ball;
    dJointID hinges[2];
    JpWorld *play;
    JpJoint *joints[3];
    size_t refusals; // calls that said that there is no memory
} Scene;

// Calls until it goes well: a call without memory says so, and is worth a second one.
#define try_again(scene, call)                                                                     \
    do {                                                                                           \
        JpError error;                                                                             \
        has_failed = false;                                                                        \
        JpStatus status = (call);                                                                  \
        if (has_failed) {                                                                          \
            assert_int_equal(status, JP_ERROR_MEMORY);                                             \
            assert_true(strlen(error.text) > 10);                                                  \
            (scene)->refusals++;                                                                   \
            status = (call);                                                                       \
        }                                                                                          \
        assert_true(status <= JP_OK); /* steps may be coarse */                                    \
    } while (0)

static void make_bodies(Scene *scene)
{
    dMass mass;
    scene->world = dWorldCreate();
    dWorldSetGravity(scene->world, 0, -9.81, 0);
    dMassSetBoxTotal(&mass, 1.0, 0.3, 0.02, 0.02);
    for (int i = 0; i < 2; i++) {
        scene->arms[i] = dBodyCreate(scene->world);
        dBodySetMass(scene->arms[i], &mass);
        dBodySetPosition(scene->arms[i], 0.15 + 0.3 * i, 0, 0);
    }
    for (int i = 0; i < 2; i++) {
        scene->hinges[i] = dJointCreateHinge(scene->world, 0);
        dJointAttach(scene->hinges[i], scene->arms[i], i == 0 ? 0 : scene->arms[0]);
        dJointSetHingeAnchor(scene->hinges[i], 0.3 * i, 0, 0);
        dJointSetHingeAxis(scene->hinges[i], 0, 0, 1);
    }
    scene->rod = dBodyCreate(scene->world);
    dBodySetMass(scene->rod, &mass);
    dBodySetPosition(scene->rod, 0.15, 1, 0);
    scene->ball = dBodyCreate(scene->world);
    dBodySetMass(scene->ball, &mass);
}

static JpContact contact_of(double stiffness)
{
    JpContact contact = jp_contact_default();
    contact.stiffness = stiffness;
    return contact;
}

static void make_play(Scene *scene, JpStepping stepping)
{
    JpWorldOptions options = jp_world_options_default();
    options.stepping = stepping;
    JpStops stops = jp_stops_default();
    stops.low = -0.02;
    stops.high = 0.01;
    stops.contact = contact_of(1e5);
    JpBacklash backlash = jp_backlash_default();
    backlash.gap = 0.01;
    backlash.rotor_inertia = 0.01;
    backlash.tooth = contact_of(1e4);
    JpPinInHole pin = jp_pin_default();
    pin.hole_radius = 5e-3;
    pin.pin_radius = 4.9e-3;
    pin.width = 0.02;
    pin.axial_play = 1e-4;
    pin.pin[0] = -0.15;
    pin.hole[1] = 1.0;
    pin.friction = 0.1;
    pin.contact = contact_of(1e7);
    try_again(scene, jp_world_create(scene->world, &options, &scene->play, &error));
    try_again(scene, jp_world_add_body(scene->play, scene->ball, &error));
    try_again(scene, jp_world_add_all(scene->play, &error));
    try_again(scene,
              jp_stops_create(scene->play, scene->hinges[0], &stops, &scene->joints[0], &error));
    try_again(scene, jp_backlash_create(scene->play, scene->hinges[1], &backlash, &scene->joints[1],
                                        &error));
    try_again(scene, jp_pin_create(scene->play, 0, scene->rod, &pin, &scene->joints[2], &error));
    JpFriction friction = jp_friction_default();
    friction.coefficient = 0.1;
    friction.radius = 0.01;
    JpJoint *rubbing;
    try_again(scene,
              jp_friction_create(scene->play, scene->hinges[1], &friction, &rubbing, &error));
}

static void take_back_and_resume(Scene *scene)
{
    static char state[32768];
    size_t size;
    try_again(scene, jp_world_undo(scene->play, &error));
    try_again(scene, jp_world_step(scene->play, STEP_S, &error));
    try_again(scene, jp_world_save(scene->play, state, sizeof state, &size, &error));
    try_again(scene, jp_world_step(scene->play, STEP_S, &error));
    try_again(scene, jp_world_resume(scene->play, state, size, &error));
}

// The whole scene, with one allocation that fails, from 0; -1 for none. Returns where the rod was.
static double play_scene(JpStepping stepping, long failing, size_t *refusals)
{
    Scene scene = {0};
    make_bodies(&scene);
    until_failure = failing;
    make_play(&scene, stepping);
    for (int i = 0; i < STEPS; i++) {
        try_again(&scene, jp_world_step(scene.play, STEP_S, &error));
    }
    take_back_and_resume(&scene);
    until_failure = -1;
    const double at = dBodyGetPosition(scene.rod)[1] + dBodyGetPosition(scene.arms[1])[1];
    jp_world_destroy(scene.play);
    dWorldDestroy(scene.world);
    *refusals += scene.refusals;
    return at;
}

static void every_allocation_may_fail(void **state)
{
    (void)state;
    dSetAllocHandler(allocate_for_ode);
    dSetReallocHandler(reallocate_for_ode);
    for (int stepping = JP_STEPPING_PLAIN; stepping <= JP_STEPPING_IMPULSE; stepping++) {
        size_t none = 0;
        size_t refusals = 0;
        const double at = play_scene((JpStepping)stepping, -1, &none);
        assert_int_equal(none, 0);
        // until the scene makes fewer
        size_t tries = 0;
        for (long i = 0; refusals == tries; i += 1 + i / EACH, tries++) {
            // one try more changes rounding at most
            assert_near(play_scene((JpStepping)stepping, i, &refusals), at, 1e-9);
        }
        // the control: allocations did fail, in every call
        assert_true(refusals > STEPS);
    }
    dSetAllocHandler(NULL);
    dSetReallocHandler(NULL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_allocation_may_fail),
    };
    return cmocka_run_group_tests(tests, ode_group_setup, ode_group_teardown);
}
