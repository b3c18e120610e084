// Does a world that is saved in the middle of a contact go on in another as it would have itself?
//
// A pin rattles in its hole, in the plane and with tilt, and an arm hits a stop. A run of so many
// steps is the truth for one that is saved half way, put into a new world of ODE and continued: the
// same numbers bit for bit where the library makes the forces of one place, and to rounding where
// ODE's rows do or several places share them. The control is given the bodies alone: its contacts
// begin anew.
#include "close.h"

#include "ode_group.h"

#include <jointplay/jointplay.h>

#include <ode/ode.h>
#include <stdlib.h>
#include <string.h>

#define must(call)      assert_int_equal((call), JP_OK)
#define must_step(call) assert_true((call) <= JP_OK)

// 1: what ODE's own rows add to a state that is the same to the last bit, grown over 200 steps
static const double ROUNDING = 1e-12;

typedef enum SceneKind {
    SCENE_PIN,
    SCENE_WIDE_PIN,
    SCENE_STOP,
    SCENE_STICKING_PIN, // where contacts are integrated within the step
    SCENE_COUNT
} SceneKind;

typedef struct Scene {
    dWorldID world;
    dBodyID body;
    JpWorld *play;
    JpJoint *joint;
} Scene;

static dBodyID make_body(dWorldID world, double x)
{
    dMass mass;
    dMassSetParameters(&mass, 1.0, 0, 0, 0, 0.02, 0.02, 0.01, 0, 0, 0);
    const dBodyID body = dBodyCreate(world);
    dBodySetMass(body, &mass);
    dBodySetPosition(body, x, 0, 0);
    return body;
}

static void make_pin(Scene *scene, double width, JpFrictionLaw friction)
{
    JpPinInHole pin = jp_pin_default();
    pin.hole_radius = 5.1e-3;
    pin.pin_radius = 5e-3;
    pin.width = width;
    pin.axial_play = INFINITY;
    pin.pin[0] = -0.1;
    pin.contact.stiffness = 1e7;
    pin.contact.damping = JP_DAMPING_EXACT;
    pin.contact.restitution = 0.5;
    pin.contact.resting_speed = 0.1;
    if (friction == JP_FRICTION_STICK) {
        pin.friction = 0.3;
        pin.friction_law = friction;
        pin.presliding = 50e-6;
    }
    must(jp_pin_create(scene->play, NULL, scene->body, &pin, &scene->joint, NULL));
}

static void make_stop(Scene *scene)
{
    const dJointID hinge = dJointCreateHinge(scene->world, 0);
    dJointAttach(hinge, scene->body, 0);
    dJointSetHingeAnchor(hinge, 0, 0, 0);
    dJointSetHingeAxis(hinge, 0, 0, 1);
    JpStops stops = jp_stops_default();
    stops.low = -0.5;
    stops.contact.stiffness = 1e4;
    stops.contact.restitution = 0.4;
    must(jp_stops_create(scene->play, hinge, &stops, &scene->joint, NULL));
}

static Scene make(SceneKind kind, JpStepping stepping)
{
    Scene scene = {.world = dWorldCreate()};
    dWorldSetGravity(scene.world, 0, -9.81, 0);
    scene.body = make_body(scene.world, 0.1);
    JpWorldOptions options = jp_world_options_default();
    options.stepping = stepping;
    must(jp_world_create(scene.world, &options, &scene.play, NULL));
    if (kind == SCENE_STOP) {
        make_stop(&scene);
    } else {
        make_pin(&scene, kind == SCENE_WIDE_PIN ? 0.01 : 0.0,
                 kind == SCENE_STICKING_PIN ? JP_FRICTION_STICK : JP_FRICTION_REGULARIZED);
    }
    return scene;
}

static void destroy(Scene *scene)
{
    jp_world_destroy(scene->play);
    dWorldDestroy(scene->world);
}

// How the body moves, and the force on it.
typedef struct Seen {
    double numbers[16];
} Seen;

static Seen look(SceneKind kind, const Scene *scene)
{
    Seen seen = {{0.0}};
    memcpy(seen.numbers, dBodyGetPosition(scene->body), 3 * sizeof(double));
    memcpy(seen.numbers + 3, dBodyGetQuaternion(scene->body), 4 * sizeof(double));
    memcpy(seen.numbers + 7, dBodyGetLinearVel(scene->body), 3 * sizeof(double));
    memcpy(seen.numbers + 10, dBodyGetAngularVel(scene->body), 3 * sizeof(double));
    if (kind == SCENE_STOP) {
        JpJointState state;
        must(jp_joint_state(scene->joint, &state, NULL));
        seen.numbers[13] = state.force;
    } else {
        JpPinState state;
        must(jp_pin_state(scene->joint, &state, NULL));
        memcpy(seen.numbers + 13, state.force, 3 * sizeof(double));
    }
    return seen;
}

static bool is_touching(SceneKind kind, const Scene *scene)
{
    const Seen seen = look(kind, scene);
    return seen.numbers[13] != 0.0 || seen.numbers[14] != 0.0;
}

static void run(Scene *scene, double step, int steps)
{
    for (int i = 0; i < steps; i++) {
        must_step(jp_world_step(scene->play, step, NULL));
    }
}

// The bodies of one scene as those of another.
static void copy_bodies(const Scene *from, const Scene *to)
{
    const dReal *at = dBodyGetPosition(from->body);
    const dReal *velocity = dBodyGetLinearVel(from->body);
    const dReal *omega = dBodyGetAngularVel(from->body);
    dBodySetPosition(to->body, at[0], at[1], at[2]);
    dBodySetQuaternion(to->body, dBodyGetQuaternion(from->body));
    dBodySetLinearVel(to->body, velocity[0], velocity[1], velocity[2]);
    dBodySetAngularVel(to->body, omega[0], omega[1], omega[2]);
}

// The largest difference of positions, turns, velocities, rates and forces, each over the largest.
static double apart(const Seen *one, const Seen *other)
{
    static const size_t PARTS[] = {0, 3, 7, 10, 13, 16};
    double most = 0.0;
    for (size_t part = 0; part + 1 < sizeof PARTS / sizeof *PARTS; part++) {
        double size = 0.0;
        double by = 0.0;
        for (size_t i = PARTS[part]; i < PARTS[part + 1]; i++) {
            size = fmax(size, fabs(one->numbers[i]));
            by = fmax(by, fabs(one->numbers[i] - other->numbers[i]));
        }
        most = size > 0.0 ? fmax(most, by / size) : most;
    }
    return most;
}

// Tells a joint how the contacts of another began, in their first two steps.
static void tell_how_they_began(SceneKind kind, const Scene *from, const Scene *to)
{
    JpSide sides[2] = {{.gap = INFINITY}, {.gap = INFINITY}};
    double bend = 0.0;
    if (kind == SCENE_STOP) {
        JpJointState state;
        must(jp_joint_state(from->joint, &state, NULL));
        sides[0] = state.low;
    } else {
        JpPinState state;
        must(jp_pin_state(from->joint, &state, NULL));
        memcpy(sides, state.ends, state.end_count * sizeof *sides);
        bend = state.bend;
    }
    for (size_t i = 0; i < 2; i++) {
        if (sides[i].gap < 0.0) {
            const JpBegun begun = {.impact_speed = sides[i].impact_speed, .bend = bend};
            must(jp_joint_begun(to->joint, i, &begun, NULL));
        }
    }
}

static void check_scene(SceneKind kind, JpStepping stepping)
{
    const double step = stepping == JP_STEPPING_PLAIN ? 2e-6 : 2e-5;
    const int most = (int)(1.0 / step);
    const int more = 200;
    Scene scene = make(kind, stepping);
    int taken = 0;
    // into the second step of a contact
    for (int touched = 0; touched < 2 && taken < most; taken++) {
        run(&scene, step, 1);
        touched = is_touching(kind, &scene) ? touched + 1 : 0;
    }
    assert_true(taken < most);
    size_t size = 0;
    must(jp_world_save(scene.play, NULL, 0, &size, NULL));
    void *state = malloc(size);
    assert_non_null(state);
    must(jp_world_save(scene.play, state, size, &size, NULL));

    if (kind == SCENE_STICKING_PIN) {
        JpPinState now;
        must(jp_pin_state(scene.joint, &now, NULL));
        assert_true(now.bend != 0.0);
    }
    Scene other = make(kind, stepping);
    copy_bodies(&scene, &other);
    must(jp_world_resume(other.play, state, size, NULL));
    Scene bodies_alone = make(kind, stepping);
    copy_bodies(&scene, &bodies_alone);
    Scene begun = make(kind, stepping);
    copy_bodies(&scene, &begun);
    tell_how_they_began(kind, &scene, &begun);

    run(&scene, step, more);
    run(&other, step, more);
    run(&bodies_alone, step, more);
    run(&begun, step, more);
    const Seen truth = look(kind, &scene);
    const Seen resumed = look(kind, &other);
    const Seen control = look(kind, &bodies_alone);
    const bool is_exact = kind != SCENE_WIDE_PIN && stepping != JP_STEPPING_PLAIN;
    if (is_exact) {
        assert_memory_equal(&truth, &resumed, sizeof truth);
    }
    assert_true(apart(&truth, &resumed) < ROUNDING);
    assert_true(apart(&truth, &control) > 1e3 * ROUNDING);
    const Seen told = look(kind, &begun);
    print_message("# scene %d, stepping %d: told how they began %.1e, not told %.1e\n", kind,
                  stepping, apart(&truth, &told), apart(&truth, &control));
    assert_true(apart(&truth, &told) < 0.05 * apart(&truth, &control));
    free(state);
    destroy(&begun);
    destroy(&bodies_alone);
    destroy(&other);
    destroy(&scene);
}

static void a_world_goes_on_as_it_would_have(void **state)
{
    (void)state;
    static const JpStepping STEPPINGS[] = {JP_STEPPING_PLAIN, JP_STEPPING_STAGGERED,
                                           JP_STEPPING_IMPULSE};
    for (int kind = 0; kind < SCENE_COUNT; kind++) {
        for (size_t i = 0; i < sizeof STEPPINGS / sizeof *STEPPINGS; i++) {
            if (kind != SCENE_STICKING_PIN || STEPPINGS[i] == JP_STEPPING_IMPULSE) {
                check_scene((SceneKind)kind, STEPPINGS[i]);
            }
        }
    }
}

// The state belongs to a world of the same making, and is refused otherwise.
static void what_is_no_such_state_is_refused(void **state)
{
    (void)state;
    Scene scene = make(SCENE_PIN, JP_STEPPING_IMPULSE);
    Scene other = make(SCENE_STOP, JP_STEPPING_IMPULSE);
    Scene plain = make(SCENE_PIN, JP_STEPPING_PLAIN);
    run(&scene, 1e-4, 3);
    size_t size = 0;
    must(jp_world_save(scene.play, NULL, 0, &size, NULL));
    char *saved = malloc(size);
    assert_non_null(saved);
    JpError error;
    assert_int_equal(jp_world_save(scene.play, saved, size - 1, &size, &error), JP_ERROR_ARGUMENT);
    assert_non_null(strstr(error.text, "there is room for"));
    must(jp_world_save(scene.play, saved, size, &size, NULL));
    const Seen before = look(SCENE_PIN, &plain);
    assert_int_equal(jp_world_resume(other.play, saved, size, &error), JP_ERROR_ARGUMENT);
    assert_non_null(strstr(error.text, "made in another way"));
    assert_int_equal(jp_world_resume(plain.play, saved, size, &error), JP_ERROR_ARGUMENT);
    assert_int_equal(jp_world_resume(scene.play, saved, size - 1, &error), JP_ERROR_ARGUMENT);
    JpBegun begun = {.impact_speed = 1.0};
    assert_int_equal(jp_joint_begun(NULL, 0, &begun, &error), JP_ERROR_ARGUMENT);
    assert_int_equal(jp_joint_begun(plain.joint, 0, NULL, &error), JP_ERROR_ARGUMENT);
    assert_int_equal(jp_joint_begun(plain.joint, 1, &begun, &error), JP_ERROR_ARGUMENT);
    assert_int_equal(jp_joint_begun(other.joint, 2, &begun, &error), JP_ERROR_ARGUMENT);
    assert_int_equal(jp_joint_begun(other.joint, 1, &begun, &error), JP_ERROR_NONE);
    assert_non_null(strstr(error.text, "does not touch"));
    begun.age = -1.0;
    assert_int_equal(jp_joint_begun(plain.joint, 0, &begun, &error), JP_ERROR_ARGUMENT);
    assert_int_equal(jp_world_save(NULL, saved, size, &size, &error), JP_ERROR_ARGUMENT);
    assert_int_equal(jp_world_save(scene.play, saved, size, NULL, &error), JP_ERROR_ARGUMENT);
    assert_int_equal(jp_world_resume(NULL, saved, size, &error), JP_ERROR_ARGUMENT);
    assert_int_equal(jp_world_resume(scene.play, NULL, size, &error), JP_ERROR_ARGUMENT);
    saved[0] = 'x';
    assert_int_equal(jp_world_resume(scene.play, saved, size, &error), JP_ERROR_ARGUMENT);
    assert_non_null(strstr(error.text, "not a state that was saved"));
    const Seen after = look(SCENE_PIN, &plain);
    assert_memory_equal(&before, &after, sizeof before);
    free(saved);
    destroy(&plain);
    destroy(&other);
    destroy(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_world_goes_on_as_it_would_have),
        cmocka_unit_test(what_is_no_such_state_is_refused),
    };
    return cmocka_run_group_tests(tests, ode_group_setup, ode_group_teardown);
}
