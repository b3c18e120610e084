// Does a world refuse every state that was damaged, or stay sound with it?
//
// A scene with stops, backlash and a rotor, a hinge with friction, and a wide pin with friction and
// collars is saved in the middle of contacts. Copies of the state are damaged at random: words
// replaced by hostile numbers, bits flipped, stretches of bytes replaced, ends cut off. A damaged
// state is refused by its checksum. With a checksum made right again it is refused too, or every
// number of the bodies is finite, and stays so in steps of any status. What is refused leaves the
// world as it was.
//
//     test_library_damage [STATES [SEED]]
//
// The control looks at the bodies of a world that was given a position that is no number.
#include "close.h"

#include "base/hash.h"
#include "base/lcg.h"
#include "ode_group.h"

#include <jointplay/jointplay.h>

#include <float.h>
#include <stdlib.h>
#include <string.h>

#define must(call) assert_int_equal((call), JP_OK)

enum { BODIES = 3, WORD = 8, STEPS_BEFORE = 60, STEPS_AFTER = 3, STEPPINGS = 3, MOST_SEEN = 256 };

static const double STEP_S = 1e-3; // with it something touches at the end of the steps before

static unsigned state_count = 500;
static unsigned first_seed = 1;

// What is read of a world.
typedef struct Seen {
    double numbers[MOST_SEEN];
    size_t count;
} Seen;

typedef struct Scene {
    dWorldID world;
    dBodyID bodies[BODIES];
    JpWorld *play;
    JpJoint *joints[4];
    char *state; // as it was saved
    size_t size;
    Seen seen; // then
} Scene;

static JpContact contact_of(double stiffness)
{
    JpContact contact = jp_contact_default();
    contact.stiffness = stiffness;
    contact.restitution = 0.5;
    contact.resting_speed = 0.01;
    return contact;
}

static dBodyID make_rod(dWorldID world, double x, double y)
{
    dMass mass;
    const dBodyID body = dBodyCreate(world);
    dMassSetBoxTotal(&mass, 1.0, 0.3, 0.02, 0.02);
    dBodySetMass(body, &mass);
    dBodySetPosition(body, x, y, 0);
    return body;
}

static dJointID make_hinge(dWorldID world, dBodyID body, dBodyID base, double x)
{
    const dJointID hinge = dJointCreateHinge(world, 0);
    dJointAttach(hinge, body, base);
    dJointSetHingeAnchor(hinge, x, 0, 0);
    dJointSetHingeAxis(hinge, 0, 0, 1);
    return hinge;
}

static void make_joints(Scene *scene)
{
    const dJointID hinges[2] = {
        make_hinge(scene->world, scene->bodies[0], NULL, 0.0),
        make_hinge(scene->world, scene->bodies[1], scene->bodies[0], 0.3),
    };
    JpStops stops = jp_stops_default();
    stops.low = -0.005;
    stops.high = 0.005;
    stops.contact = contact_of(1e4);
    JpBacklash backlash = jp_backlash_default();
    backlash.gap = 0.002;
    backlash.rotor_inertia = 0.01;
    backlash.tooth = contact_of(1e4);
    JpPinInHole pin = jp_pin_default();
    pin.hole_radius = 5e-3;
    pin.pin_radius = 4.99e-3;
    pin.width = 0.02;
    pin.axial_play = 1e-5;
    pin.pin[0] = -0.15;
    pin.hole[1] = 1.0;
    pin.friction = 0.1;
    pin.contact = contact_of(1e6);
    must(jp_stops_create(scene->play, hinges[0], &stops, &scene->joints[0], NULL));
    must(jp_backlash_create(scene->play, hinges[1], &backlash, &scene->joints[1], NULL));
    must(jp_backlash_drive(scene->joints[1], -1.0, NULL));
    must(jp_pin_create(scene->play, NULL, scene->bodies[2], &pin, &scene->joints[2], NULL));
    JpFriction friction = jp_friction_default();
    friction.coefficient = 0.1;
    friction.radius = 0.01;
    must(jp_friction_create(scene->play, hinges[1], &friction, &scene->joints[3], NULL));
}

static void save(Scene *scene)
{
    must(jp_world_save(scene->play, NULL, 0, &scene->size, NULL));
    scene->state = malloc(scene->size);
    assert_non_null(scene->state);
    must(jp_world_save(scene->play, scene->state, scene->size, &scene->size, NULL));
}

static void see(Seen *seen, const double *numbers, size_t count)
{
    assert_true(seen->count + count <= MOST_SEEN);
    memcpy(seen->numbers + seen->count, numbers, count * sizeof *numbers);
    seen->count += count;
}

static void see_side(Seen *seen, const JpSide *side)
{
    const double numbers[] = {
        side->gap,  side->force,  side->force_max,    side->depth_max,       side->impulse,
        side->work, side->stored, side->impact_speed, (double)side->impacts,
    };
    see(seen, numbers, sizeof numbers / sizeof *numbers);
}

static Seen look(const Scene *scene)
{
    Seen seen = {.count = 0};
    for (int i = 0; i < BODIES; i++) {
        const dBodyID body = scene->bodies[i];
        see(&seen, dBodyGetPosition(body), 3);
        see(&seen, dBodyGetQuaternion(body), 4);
        see(&seen, dBodyGetLinearVel(body), 3);
        see(&seen, dBodyGetAngularVel(body), 3);
        see(&seen, dBodyGetForce(body), 3);
    }
    for (int i = 0; i < 2; i++) {
        JpJointState state;
        must(jp_joint_state(scene->joints[i], &state, NULL));
        see(&seen, (double[]){state.rotor_position, state.rotor_speed, state.force}, 3);
        see_side(&seen, &state.low);
        see_side(&seen, &state.high);
    }
    JpPinState pin;
    must(jp_pin_state(scene->joints[2], &pin, NULL));
    see(&seen, pin.force, 3);
    see(&seen, &pin.slid, 1);
    JpFrictionState friction;
    must(jp_friction_state(scene->joints[3], &friction, NULL));
    see(&seen, (double[]){friction.force, friction.most, friction.slid}, 3);
    for (int i = 0; i < 2; i++) {
        see_side(&seen, &pin.ends[i]);
        see_side(&seen, &pin.collars[i]);
    }
    return seen;
}

static bool is_as_saved(const Scene *scene)
{
    const Seen now = look(scene);
    return memcmp(now.numbers, scene->seen.numbers, now.count * sizeof *now.numbers) == 0;
}

static Scene make(JpStepping stepping)
{
    Scene scene = {.world = dWorldCreate()};
    dWorldSetGravity(scene.world, 0, -9.81, 0);
    dWorldSetERP(scene.world, 1.0);
    scene.bodies[0] = make_rod(scene.world, 0.15, 0.0);
    scene.bodies[1] = make_rod(scene.world, 0.45, 0.0);
    scene.bodies[2] = make_rod(scene.world, 0.15, 1.0);
    JpWorldOptions options = jp_world_options_default();
    options.stepping = stepping;
    must(jp_world_create(scene.world, &options, &scene.play, NULL));
    make_joints(&scene);
    for (int i = 0; i < STEPS_BEFORE; i++) {
        assert_true(jp_world_step(scene.play, STEP_S, NULL) <= JP_OK);
    }
    save(&scene);
    scene.seen = look(&scene);
    return scene;
}

static void destroy(Scene *scene)
{
    jp_world_destroy(scene->play);
    dWorldDestroy(scene->world);
    free(scene->state);
}

// Whether all bodies are somewhere.
static bool is_sound(const Scene *scene)
{
    double sum = 0.0;
    for (int i = 0; i < BODIES; i++) {
        const dBodyID body = scene->bodies[i];
        const dReal *vectors[] = {dBodyGetPosition(body), dBodyGetLinearVel(body),
                                  dBodyGetAngularVel(body), dBodyGetRotation(body)};
        for (int v = 0; v < 4; v++) {
            sum += fabs(vectors[v][0]) + fabs(vectors[v][1]) + fabs(vectors[v][2]);
        }
    }
    return isfinite(sum);
}

static size_t draw_below(uint64_t *random, size_t most)
{
    return (size_t)(0.5 * (lcg_draw(random) + 1.0) * (double)most);
}

// A number that is none, or none that is expected.
static double draw_hostile(uint64_t *random)
{
    static const double HOSTILE[] = {0.0,   -1.0,   NAN,  INFINITY, -INFINITY, DBL_MAX, -DBL_MAX,
                                     1e300, 1e-310, 1e49, -1e30,    1e6,       -1e-6,   2.0};
    const size_t count = sizeof HOSTILE / sizeof *HOSTILE;
    const size_t number = draw_below(random, count + 2);
    if (number < count) {
        return HOSTILE[number];
    }
    if (number == count) {
        return lcg_draw(random);
    }
    double bits;
    memcpy(&bits, random, sizeof bits);
    return bits;
}

// Damages a state in one way, and may make it shorter.
static void damage(uint64_t *random, char *state, size_t *size)
{
    char *word = state + WORD * draw_below(random, *size / WORD);
    const size_t way = draw_below(random, 8);
    if (way < 4) {
        const double hostile = draw_hostile(random);
        memcpy(word, &hostile, WORD);
    } else if (way < 6) {
        word[draw_below(random, WORD)] ^= (char)(1 << draw_below(random, 8));
    } else if (way == 6) {
        const size_t left = (size_t)(state + *size - word);
        memset(word, (int)draw_below(random, 256), 1 + draw_below(random, left < 64 ? left : 64));
    } else if (draw_below(random, 4) == 0) {
        *size = draw_below(random, *size);
    }
}

// The checksum, the last word, as it is of what stands before it.
static void make_right(char *state, size_t size)
{
    uint64_t hash = HASH_START;
    for (size_t at = 0; at + WORD < size; at += WORD) {
        uint64_t word;
        memcpy(&word, state + at, WORD);
        hash = hash_word(hash, word);
    }
    if (size >= WORD && size % WORD == 0) {
        memcpy(state + size - WORD, &hash, WORD);
    }
}

typedef struct Counts {
    size_t whole;    // not damaged after all
    size_t refused;  // with JP_ERROR_ARGUMENT
    size_t accepted; // with sound bodies
    size_t steps;    // that were made from these
    size_t failed;   // steps that were refused
} Counts;

static void go_on(const Scene *scene, Counts *counts)
{
    counts->accepted++;
    assert_true(is_sound(scene));
    for (int i = 0; i < STEPS_AFTER; i++) {
        JpError error;
        const JpStatus status = jp_world_step(scene->play, STEP_S, &error);
        counts->steps++;
        counts->failed += status > JP_OK;
        assert_true(is_sound(scene));
    }
    must(jp_world_resume(scene->play, scene->state, scene->size, NULL));
    assert_true(is_as_saved(scene));
}

// One damaged state, with its checksum as it was or made right.
static void try_state(const Scene *scene, unsigned seed, bool is_right, Counts *counts)
{
    uint64_t random = lcg_stirred(seed);
    size_t size = scene->size;
    char *state = malloc(size);
    assert_non_null(state);
    memcpy(state, scene->state, size);
    for (size_t i = 1 + draw_below(&random, 3); i > 0 && size > 0; i--) {
        damage(&random, state, &size);
    }
    if (is_right) {
        make_right(state, size);
    }
    char *cut = realloc(state, size > 0 ? size : 1); // so that reading beyond it is seen
    assert_non_null(cut);
    const bool is_whole = size == scene->size && memcmp(cut, scene->state, size) == 0;
    JpError error;
    const JpStatus status = jp_world_resume(scene->play, cut, size, &error);
    free(cut);
    if (is_whole) {
        assert_int_equal(status, JP_OK);
        counts->whole++;
    } else if (status == JP_OK) {
        assert_true(is_right);
        go_on(scene, counts);
    } else {
        assert_int_equal(status, JP_ERROR_ARGUMENT);
        assert_true(strlen(error.text) > 10);
        assert_true(is_as_saved(scene));
        counts->refused++;
    }
}

static void damaged_states_are_refused_or_harmless(void **state)
{
    (void)state;
    Scene scenes[STEPPINGS];
    Counts counts[2] = {{0}};
    for (int i = 0; i < STEPPINGS; i++) {
        scenes[i] = make((JpStepping)i);
    }
    for (unsigned i = 0; i < state_count; i++) {
        const unsigned seed = first_seed + i;
        try_state(&scenes[seed % STEPPINGS], seed, i / STEPPINGS % 2 != 0,
                  &counts[i / STEPPINGS % 2]);
    }
    for (int i = 0; i < 2; i++) {
        print_message("# checksum %s: %zu refused, %zu harmless (%zu steps, %zu of them refused), "
                      "%zu whole\n",
                      i == 0 ? "stale" : "made right", counts[i].refused, counts[i].accepted,
                      counts[i].steps, counts[i].failed, counts[i].whole);
    }
    assert_int_equal(counts[0].accepted, 0);
    // both ways out are met
    assert_true(state_count < 100 || (counts[1].refused > 10 && counts[1].accepted > 10));
    for (int i = 0; i < STEPPINGS; i++) {
        destroy(&scenes[i]);
    }
}

// Of a state whose words from one on are replaced: what is said of it, with its checksum right.
static void assert_says(const Scene *scene, size_t first, size_t count, double value,
                        const char *says)
{
    char *state = malloc(scene->size);
    assert_non_null(state);
    memcpy(state, scene->state, scene->size);
    for (size_t i = first; i < first + count; i++) {
        memcpy(state + WORD * i, &value, WORD);
    }
    make_right(state, scene->size);
    JpError error;
    assert_int_equal(jp_world_resume(scene->play, state, scene->size, &error), JP_ERROR_ARGUMENT);
    if (strstr(error.text, says) == NULL) {
        fail_msg("\"%s\" is not in \"%s\"", says, error.text);
    }
    free(state);
}

static void what_is_wrong_is_named(void **state)
{
    (void)state;
    enum { FORMAT = 2, BODY_COUNT = 4, LAST_STEP = 7, POSITION = 19, TURN = 22, ENABLED = 38 };
    Scene scene = make(JP_STEPPING_IMPULSE);
    assert_says(&scene, FORMAT, 1, 2.0, "reads format 3");
    assert_says(&scene, BODY_COUNT, 1, 0.0, "made in another way than this one with 3 bodies");
    assert_says(&scene, LAST_STEP, 1, -1.0, "word 7 of the state, the step before, is -1");
    assert_says(&scene, POSITION, 1, NAN, "word 19 of the state, a body's position, is nan");
    assert_says(&scene, TURN, 4, 0.0, "the square of the length of a body's quaternion, is 0");
    assert_says(&scene, TURN, 4, 0.51, "a body's quaternion, is 1.0404");
    assert_says(&scene, ENABLED, 1, 1.0, "whether a body is enabled");
    assert_true(is_as_saved(&scene));
    destroy(&scene);
}

static void a_body_that_is_nowhere_is_seen(void **state)
{
    (void)state;
    Scene scene = make(JP_STEPPING_PLAIN);
    assert_true(is_sound(&scene));
    dBodySetPosition(scene.bodies[1], NAN, 0, 0);
    assert_false(is_sound(&scene));
    destroy(&scene);
}

int main(int argument_count, char **arguments)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(damaged_states_are_refused_or_harmless),
        cmocka_unit_test(what_is_wrong_is_named),
        cmocka_unit_test(a_body_that_is_nowhere_is_seen),
    };
    state_count = argument_count > 1 ? (unsigned)strtoul(arguments[1], NULL, 10) : state_count;
    first_seed = argument_count > 2 ? (unsigned)strtoul(arguments[2], NULL, 10) : first_seed;
    return cmocka_run_group_tests(tests, ode_group_setup, ode_group_teardown);
}
