// Are the largest forces of contacts within a step those of the contacts' laws, at any step?
//
// Truths are integrated here by the classical scheme of order 4, at steps a hundred times shorter
// than a contact: bodies in a plane, pins in holes by F = K d^1.5 (1 + chi d'/v), torques between
// two bodies by T = K d (1 + chi d'/v), chi = 3 (1 - e^2) / 4 (Lankarani and Nikravesh), v the
// closing speed with which the contact under way began. Each check is also given forces that are
// 30 % too large, and must refuse them: the control.
#include "close.h"

#include "ode_group.h"

#include <jointplay/jointplay.h>

#include <string.h>

#define must(call) assert_int_equal((call), JP_OK)

enum { BODIES = 3, PINS = 3, FLANKS = 4, NUMBERS = 6 * BODIES };

static const double GRAVITY = 9.81;     // m/s^2
static const double RESTITUTION = 0.5;  // of all contacts
static const double CLEARANCE = 15e-6;  // m
static const double HERTZ = 2e9;        // N/m^1.5
static const double ROD = 0.3;          // m
static const double TRUTH_STEP = 1e-7;  // s
static const double TOO_LARGE = 1.3;    // of the control
static const double SPEED_FLOOR = 1e-6; // m/s or rad/s, of the default contact

static double hysteresis(void)
{
    return 0.75 * (1.0 - RESTITUTION * RESTITUTION);
}

// A pin of one body in a hole of another, or of the world (-1), at places along the bodies' x axes.
typedef struct PlanePin {
    int hole_body;
    int pin_body;
    double hole_x; // m
    double pin_x;  // m
} PlanePin;

// One side that presses on the angle of the second body against the first.
typedef struct Flank {
    double sign;      // 1: pushes the angle up
    double limit;     // rad
    double stiffness; // N m/rad
} Flank;

// A contact under way.
typedef struct Since {
    bool is_touching;
    double speed;   // of its onset
    double most;    // its largest force of all
    double deepest; // its largest depth
} Since;

typedef struct Plane {
    int body_count;
    double masses[BODIES];   // kg; 0: where the body is, is another's
    double inertias[BODIES]; // kg m^2
    int pin_count;
    PlanePin pins[PINS];
    int flank_count;
    Flank flanks[FLANKS];
    double state[NUMBERS]; // x, y, angle and their rates, of each body
    Since since[PINS + FLANKS];
} Plane;

static void point_of(const double *state, int body, double x, double out[4])
{
    memset(out, 0, 4 * sizeof *out);
    out[0] = x;
    if (body >= 0) {
        const double *at = &state[6 * body];
        const double c = x * cos(at[2]);
        const double s = x * sin(at[2]);
        const double found[4] = {at[0] + c, at[1] + s, at[3] - at[5] * s, at[4] + at[5] * c};
        memcpy(out, found, sizeof found);
    }
}

static double law(Since *since, double stiffness, double exponent, double depth, double closing)
{
    if (!(depth > 0.0)) {
        return 0.0;
    }
    const double onset = since->is_touching ? since->speed : closing;
    const double speed = fmax(onset, SPEED_FLOOR);
    return fmax(0.0, stiffness * pow(depth, exponent) * (1.0 + hysteresis() * closing / speed));
}

// Begins and ends a contact after a step, and keeps its largest force.
static void note(Since *since, double depth, double closing, double force)
{
    if (depth > 0.0 && !since->is_touching) {
        since->speed = closing;
    }
    since->is_touching = depth > 0.0;
    since->most = fmax(since->most, force);
    since->deepest = fmax(since->deepest, depth);
}

static void add_force(const double *state, int body, double x, const double force[2], double sign,
                      double loads[NUMBERS / 2])
{
    if (body >= 0) {
        const double arm[2] = {x * cos(state[6 * body + 2]), x * sin(state[6 * body + 2])};
        loads[3 * body] += sign * force[0];
        loads[3 * body + 1] += sign * force[1];
        loads[3 * body + 2] += sign * (arm[0] * force[1] - arm[1] * force[0]);
    }
}

static void push_pin(Plane *plane, const double *state, int number, bool is_noted,
                     double loads[NUMBERS / 2])
{
    const PlanePin *pin = &plane->pins[number];
    double hole[4];
    double at[4];
    point_of(state, pin->hole_body, pin->hole_x, hole);
    point_of(state, pin->pin_body, pin->pin_x, at);
    const double out[2] = {at[0] - hole[0], at[1] - hole[1]};
    const double far = hypot(out[0], out[1]);
    const double depth = far - CLEARANCE;
    const double closing =
        far > 0.0 ? ((at[2] - hole[2]) * out[0] + (at[3] - hole[3]) * out[1]) / far : 0.0;
    const double force = law(&plane->since[number], HERTZ, 1.5, depth, closing);
    if (is_noted) {
        note(&plane->since[number], depth, closing, force);
    }
    if (force > 0.0) {
        const double on_pin[2] = {-force * out[0] / far, -force * out[1] / far};
        add_force(state, pin->pin_body, pin->pin_x, on_pin, 1.0, loads);
        add_force(state, pin->hole_body, pin->hole_x, on_pin, -1.0, loads);
    }
}

static void push_flank(Plane *plane, const double *state, int number, bool is_noted,
                       double loads[NUMBERS / 2])
{
    const Flank *flank = &plane->flanks[number];
    Since *since = &plane->since[PINS + number];
    const double depth = -flank->sign * (state[8] - state[2] - flank->limit);
    const double closing = -flank->sign * (state[11] - state[5]);
    const double torque = law(since, flank->stiffness, 1.0, depth, closing);
    if (is_noted) {
        note(since, depth, closing, torque);
    }
    loads[5] += flank->sign * torque;
    loads[2] -= flank->sign * torque;
}

static void rates_of(Plane *plane, const double *state, bool is_noted, double rates[NUMBERS])
{
    double loads[NUMBERS / 2] = {0.0};
    for (int i = 0; i < plane->pin_count; i++) {
        push_pin(plane, state, i, is_noted, loads);
    }
    for (int i = 0; i < plane->flank_count; i++) {
        push_flank(plane, state, i, is_noted, loads);
    }
    for (int i = 0; i < plane->body_count; i++) {
        const bool is_placed = plane->masses[i] > 0.0;
        memcpy(&rates[6 * i], &state[6 * i + 3], 3 * sizeof(double));
        rates[6 * i + 3] = is_placed ? loads[3 * i] / plane->masses[i] : 0.0;
        rates[6 * i + 4] = is_placed ? loads[3 * i + 1] / plane->masses[i] - GRAVITY : 0.0;
        rates[6 * i + 5] = loads[3 * i + 2] / plane->inertias[i];
    }
}

static void ahead(const double *state, const double *rates, double step, double *out)
{
    for (int i = 0; i < NUMBERS; i++) {
        out[i] = state[i] + step * rates[i];
    }
}

static void integrate(Plane *plane, double until)
{
    const long steps = lround(until / TRUTH_STEP);
    for (long i = 0; i < steps; i++) {
        double k[4][NUMBERS] = {{0.0}};
        double at[NUMBERS];
        rates_of(plane, plane->state, true, k[0]);
        ahead(plane->state, k[0], 0.5 * TRUTH_STEP, at);
        rates_of(plane, at, false, k[1]);
        ahead(plane->state, k[1], 0.5 * TRUTH_STEP, at);
        rates_of(plane, at, false, k[2]);
        ahead(plane->state, k[2], TRUTH_STEP, at);
        rates_of(plane, at, false, k[3]);
        for (int n = 0; n < NUMBERS; n++) {
            plane->state[n] +=
                TRUTH_STEP / 6.0 * (k[0][n] + 2.0 * k[1][n] + 2.0 * k[2][n] + k[3][n]);
        }
    }
}

// The same as a world of ODE.
typedef struct Scene {
    dWorldID world;
    JpWorld *play;
    dBodyID bodies[BODIES];
    JpJoint *pins[PINS];
    JpJoint *backlash;
    JpJoint *stops;
} Scene;

static JpContact contact_of(double stiffness, double exponent)
{
    JpContact contact = jp_contact_default();
    contact.stiffness = stiffness;
    contact.exponent = exponent;
    contact.damping = JP_DAMPING_LANKARANI_NIKRAVESH;
    contact.restitution = RESTITUTION;
    return contact;
}

static dBodyID make_body(const Scene *scene, const double *state, double mass, double inertia)
{
    dMass data;
    dQuaternion turned;
    const dBodyID body = dBodyCreate(scene->world);
    dMassSetParameters(&data, mass, 0, 0, 0, inertia, inertia, inertia, 0, 0, 0);
    dBodySetMass(body, &data);
    dBodySetPosition(body, state[0], state[1], 0);
    dQFromAxisAndAngle(turned, 0, 0, 1, state[2]);
    dBodySetQuaternion(body, turned);
    dBodySetLinearVel(body, state[3], state[4], 0);
    dBodySetAngularVel(body, 0, 0, state[5]);
    return body;
}

static void make_pin(Scene *scene, const PlanePin *from, JpJoint **created)
{
    JpPinInHole pin = jp_pin_default();
    pin.hole_radius = 5e-3;
    pin.pin_radius = pin.hole_radius - CLEARANCE;
    pin.axial_play = INFINITY;
    pin.hole[0] = from->hole_x;
    pin.pin[0] = from->pin_x;
    pin.contact = contact_of(HERTZ, 1.5);
    must(jp_pin_create(scene->play, from->hole_body < 0 ? NULL : scene->bodies[from->hole_body],
                       scene->bodies[from->pin_body], &pin, created, NULL));
}

static Scene make_scene(const Plane *plane)
{
    Scene scene = {.world = dWorldCreate()};
    JpWorldOptions options = jp_world_options_default();
    options.stepping = JP_STEPPING_IMPULSE;
    dWorldSetGravity(scene.world, 0, -GRAVITY, 0);
    must(jp_world_create(scene.world, &options, &scene.play, NULL));
    for (int i = 0; i < plane->body_count; i++) {
        // a body that is placed by the first shares its mass
        const double mass = plane->masses[i] > 0.0 ? plane->masses[i] : plane->masses[0];
        const bool is_shared = plane->flank_count > 0;
        scene.bodies[i] = make_body(&scene, &plane->state[6 * i], is_shared ? 0.5 * mass : mass,
                                    plane->inertias[i]);
        if (i == 0 || !is_shared) {
            dJointAttach(dJointCreatePlane2D(scene.world, 0), scene.bodies[i], 0);
        }
    }
    for (int i = 0; i < plane->pin_count; i++) {
        make_pin(&scene, &plane->pins[i], &scene.pins[i]);
    }
    return scene;
}

static void finish_scene(Scene *scene)
{
    jp_world_destroy(scene->play);
    dWorldDestroy(scene->world);
}

// Steps on, and says whether a step was too long for its contacts.
static bool run_scene(Scene *scene, double until, double step)
{
    bool is_coarse = false;
    for (long i = 0; i < lround(until / step); i++) {
        JpError error;
        const JpStatus status = jp_world_step(scene->play, step, &error);
        assert_true(status == JP_OK || status == JP_COARSE);
        is_coarse = is_coarse || status != JP_OK;
    }
    return is_coarse;
}

static bool is_near(double found, double truth, double share)
{
    return fabs(found - truth) <= share * truth;
}

// A largest force may be above the elastic one at the largest depth, as damping presses on the way
// there: by what it is in the truth, and a share more.
static bool is_within_law(double force, double depth, double stiffness, double exponent,
                          const Since *truth)
{
    static const double SHARE = 0.02;
    const double over = truth->most / (stiffness * pow(truth->deepest, exponent));
    return force >= 0.0 && force <= (1.0 + SHARE) * over * stiffness * pow(depth, exponent);
}

static void assert_within_law(const JpSide *side, double stiffness, double exponent,
                              const Since *truth)
{
    const double depth = side->depth_max;
    assert_true(is_within_law(side->force_max, depth, stiffness, exponent, truth));
    // the control
    assert_false(is_within_law(TOO_LARGE * side->force_max, depth, stiffness, exponent, truth));
}

// Two bodies on one hinge through both centres; the first is pinned to the world.
static Plane pinned_hinge(void)
{
    const double high[2] = {0.004, 0.010}; // rad
    Plane plane = {
        .body_count = 2,
        .masses = {1.0, 0.0},
        .inertias = {0.01, 0.004},
        .pin_count = 1,
        .pins = {{-1, 0, 0.0, -0.5 * ROD}},
        .flank_count = 4,
        .flanks = {{1.0, -high[0], 800.0},
                   {-1.0, high[0], 800.0},
                   {1.0, -high[1], 2000.0},
                   {-1.0, high[1], 2000.0}},
    };
    plane.state[0] = plane.state[6] = 0.5 * ROD;
    plane.state[11] = 30.0; // rad/s, of the second body
    return plane;
}

static Scene pinned_hinge_scene(const Plane *plane)
{
    Scene scene = make_scene(plane);
    const dJointID hinge = dJointCreateHinge(scene.world, 0);
    dJointAttach(hinge, scene.bodies[1], scene.bodies[0]);
    dJointSetHingeAnchor(hinge, plane->state[0], plane->state[1], 0);
    dJointSetHingeAxis(hinge, 0, 0, 1);
    JpBacklash backlash = jp_backlash_default();
    backlash.gap = plane->flanks[1].limit - plane->flanks[0].limit;
    backlash.tooth = contact_of(plane->flanks[0].stiffness, 1.0);
    JpStops stops = jp_stops_default();
    stops.low = plane->flanks[2].limit;
    stops.high = plane->flanks[3].limit;
    stops.contact = contact_of(plane->flanks[2].stiffness, 1.0);
    must(jp_backlash_create(scene.play, hinge, &backlash, &scene.backlash, NULL));
    must(jp_stops_create(scene.play, hinge, &stops, &scene.stops, NULL));
    return scene;
}

static double largest_torque(const JpJoint *joint, double stiffness, const Since truth[2])
{
    JpJointState now;
    must(jp_joint_state(joint, &now, NULL));
    assert_within_law(&now.low, stiffness, 1.0, &truth[0]);
    assert_within_law(&now.high, stiffness, 1.0, &truth[1]);
    return fmax(now.low.force_max, now.high.force_max);
}

static void pin_backlash_and_stops_on_one_hinge_press_as_their_laws(void **state)
{
    (void)state;
    static const double STEPS[] = {5e-5, 1e-4, 2e-4, 2.5e-4, 4e-4, 5e-4};
    static const double UNTIL = 0.02; // s
    const Plane start = pinned_hinge();
    Plane truth = start;
    integrate(&truth, UNTIL);
    const Since *since = &truth.since[PINS];
    const double teeth = fmax(since[0].most, since[1].most);
    const double ends = fmax(since[2].most, since[3].most);
    for (size_t i = 0; i < sizeof STEPS / sizeof *STEPS; i++) {
        Scene scene = pinned_hinge_scene(&start);
        const bool is_coarse = run_scene(&scene, UNTIL, STEPS[i]);
        const double found[2] = {largest_torque(scene.backlash, 800.0, &since[0]),
                                 largest_torque(scene.stops, 2000.0, &since[2])};
        assert_true(is_coarse || is_near(found[0], teeth, 0.01));
        assert_true(is_coarse || is_near(found[1], ends, 0.01));
        // the control
        assert_false(is_near(TOO_LARGE * found[0], teeth, 0.01));
        assert_false(is_near(TOO_LARGE * found[1], ends, 0.01));
        finish_scene(&scene);
    }
}

// Three rods that hang on each other by pins, zigzag.
static Plane chain(void)
{
    Plane plane = {.body_count = 3, .pin_count = 3};
    for (int i = 0; i < 3; i++) {
        plane.masses[i] = 0.5;
        plane.inertias[i] = 0.5 * ROD * ROD / 12.0;
        plane.pins[i] = (PlanePin){i - 1, i, i == 0 ? 0.0 : 0.5 * ROD, -0.5 * ROD};
        plane.state[6 * i] = (0.5 + i) * ROD;
        plane.state[6 * i + 5] = i == 1 ? -4.0 : 4.0;
        plane.state[6 * i + 4] = 2.0 * ROD;
    }
    return plane;
}

static void three_pins_in_a_chain_press_as_their_law(void **state)
{
    (void)state;
    static const double STEPS[] = {2e-5, 5e-5, 1e-4, 2e-4, 5e-4, 1e-3};
    static const double UNTIL = 0.02; // s
    const Plane start = chain();
    Plane truth = start;
    integrate(&truth, UNTIL);
    for (size_t i = 0; i < sizeof STEPS / sizeof *STEPS; i++) {
        Scene scene = make_scene(&start);
        const bool is_coarse = run_scene(&scene, UNTIL, STEPS[i]);
        double most[2] = {0.0, 0.0};
        for (int k = 0; k < PINS; k++) {
            JpPinState pin;
            must(jp_pin_state(scene.pins[k], &pin, NULL));
            assert_within_law(&pin.ends[0], HERTZ, 1.5, &truth.since[k]);
            most[0] = fmax(most[0], pin.ends[0].force_max);
            most[1] = fmax(most[1], truth.since[k].most);
        }
        assert_true(is_coarse || is_near(most[0], most[1], 0.2));
        // the control
        assert_false(is_near(TOO_LARGE * most[0], most[1], 0.2));
        finish_scene(&scene);
    }
}

// A pin of two ends and collars that runs along the wall of its hole, and wobbles: its ends
// touch again and again at a small angle, and in some steps all at once. Undamped, so that its
// law knows no speed.
static JpJoint *make_grazing(Scene *scene, double step)
{
    const double state[6] = {CLEARANCE - 1e-8, 0.0, 0.0, 1e-4, 0.05, 0.0};
    *scene = (Scene){.world = dWorldCreate()};
    JpWorldOptions options = jp_world_options_default();
    options.stepping = JP_STEPPING_IMPULSE;
    must(jp_world_create(scene->world, &options, &scene->play, NULL));
    scene->bodies[0] = make_body(scene, state, 1.0, 0.002);
    dBodySetLinearVel(scene->bodies[0], state[3], state[4], 0.01);
    dBodySetAngularVel(scene->bodies[0], 0.1, 0.05, 0.0);
    JpPinInHole pin = jp_pin_default();
    pin.hole_radius = 5e-3;
    pin.pin_radius = pin.hole_radius - CLEARANCE;
    pin.width = 0.02;
    pin.axial_play = CLEARANCE;
    pin.contact = contact_of(HERTZ, 1.5);
    pin.contact.damping = JP_DAMPING_NONE;
    must(jp_pin_create(scene->play, NULL, scene->bodies[0], &pin, &scene->pins[0], NULL));
    run_scene(scene, 0.02, step);
    return scene->pins[0];
}

static bool is_elastic(const JpSide *side, double share, double times)
{
    static const double ROUNDING = 1e-9; // of a depth from a position of millimetres
    const double elastic = share * HERTZ * pow(side->depth_max, 1.5);
    return times * side->force_max >= 0.0 && times * side->force_max <= elastic * (1.0 + ROUNDING);
}

static void sides_that_graze_press_as_their_law(void **state)
{
    (void)state;
    static const double STEPS[] = {2e-5, 5e-5, 1e-4, 2e-4, 5e-4};
    for (size_t i = 0; i < sizeof STEPS / sizeof *STEPS; i++) {
        Scene scene;
        JpPinState pin;
        must(jp_pin_state(make_grazing(&scene, STEPS[i]), &pin, NULL));
        for (int k = 0; k < 2; k++) {
            assert_true(pin.ends[k].impacts > 2 && pin.collars[k].impacts > 1);
            assert_true(is_elastic(&pin.ends[k], 0.5, 1.0));
            assert_true(is_elastic(&pin.collars[k], 1.0, 1.0));
            // the control
            assert_false(is_elastic(&pin.ends[k], 0.5, TOO_LARGE));
            assert_false(is_elastic(&pin.collars[k], 1.0, TOO_LARGE));
        }
        finish_scene(&scene);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(pin_backlash_and_stops_on_one_hinge_press_as_their_laws),
        cmocka_unit_test(sides_that_graze_press_as_their_law),
        cmocka_unit_test(three_pins_in_a_chain_press_as_their_law),
    };
    return cmocka_run_group_tests(tests, ode_group_setup, ode_group_teardown);
}
