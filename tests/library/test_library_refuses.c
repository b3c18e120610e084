// Is a wrong call an error with a sentence, and is what it was to fill in left alone?
#include "close.h"

#include "ode_group.h"

#include <jointplay/jointplay.h>

#include <string.h>

// A call that was refused: its status and sentence.
#define assert_refused(call)                                                                       \
    do {                                                                                           \
        JpError error = {JP_OK, ""};                                                               \
        const JpStatus status = (call);                                                            \
        assert_true(status != JP_OK && error.status == status);                                    \
        assert_true(strlen(error.text) > 10 && strlen(error.text) + 1 < JP_ERROR_SIZE);            \
    } while (0)

static JpContact good(void)
{
    JpContact contact = jp_contact_default();
    contact.stiffness = 1e6;
    return contact;
}

static void a_contact_that_is_none_is_refused(void **state)
{
    (void)state;
    const JpContact none = jp_contact_default();
    assert_refused(jp_contact_check(NULL, &error));
    assert_refused(jp_contact_check(&none, &error));
    static const struct {
        size_t offset;
        double value;
    } WRONG[] = {
        {offsetof(JpContact, stiffness), NAN},      {offsetof(JpContact, stiffness), -1.0},
        {offsetof(JpContact, stiffness), INFINITY}, {offsetof(JpContact, exponent), 0.0},
        {offsetof(JpContact, restitution), -0.1},   {offsetof(JpContact, restitution), 1.1},
        {offsetof(JpContact, restitution), NAN},    {offsetof(JpContact, restitution), 0.0},
        {offsetof(JpContact, speed_floor), 0.0},    {offsetof(JpContact, compliance), 1e-9},
        {offsetof(JpContact, compliance), NAN},
    };
    for (size_t i = 0; i < sizeof WRONG / sizeof *WRONG; i++) {
        JpContact contact = good();
        memcpy((char *)&contact + WRONG[i].offset, &WRONG[i].value, sizeof(double));
        assert_refused(jp_contact_check(&contact, &error));
    }
    JpContact contact = good();
    contact.damping = (JpDamping)99;
    assert_refused(jp_contact_check(&contact, &error));
    contact = good();
    contact.damping = JP_DAMPING_VISCOUS;
    contact.damper = -1.0;
    assert_refused(jp_contact_check(&contact, &error));
    contact = good();
    contact.damping = JP_DAMPING_DISSIPATION;
    contact.dissipation = -0.1;
    assert_refused(jp_contact_check(&contact, &error));
    // and a right one is none
    contact = good();
    assert_int_equal(jp_contact_check(&contact, NULL), JP_OK);
}

static void a_pin_that_is_none_is_refused(void **state)
{
    (void)state;
    const JpPin pin = {.hole_radius = 0.0105,
                       .pin_radius = 0.0100,
                       .width = 0.02,
                       .youngs_modulus = 2.07e11,
                       .poisson_ratio = 0.3};
    JpContact contact = good();
    assert_refused(jp_contact_of_pin(JP_PIN_HERTZ, NULL, &contact, &error));
    assert_refused(jp_contact_of_pin(JP_PIN_HERTZ, &pin, NULL, &error));
    assert_refused(jp_contact_of_pin((JpPinLaw)9, &pin, &contact, &error));
    JpPin larger = pin;
    larger.pin_radius = 0.011;
    assert_refused(jp_contact_of_pin(JP_PIN_HERTZ, &larger, &contact, &error));
    JpPin thin = pin;
    thin.width = 0.0;
    assert_refused(jp_contact_of_pin(JP_PIN_JOHNSON, &thin, &contact, &error));
    assert_close(contact.stiffness, 1e6, 0.0);
}

static void a_row_that_is_none_is_refused(void **state)
{
    (void)state;
    const JpContact contact = good();
    const JpInstant at = {.depth = 1e-6, .closing = 0.1, .impact_speed = 0.1, .step = 1e-5};
    JpInstant no_step = at;
    no_step.step = 0.0;
    JpInstant no_depth = at;
    no_depth.depth = NAN;
    JpRow row = {7.0, 7.0, 7.0};
    JpSpring spring;
    assert_refused(jp_row(JP_MAP_TEXTBOOK, &contact, &at, NULL, &error));
    assert_refused(jp_row(JP_MAP_TEXTBOOK, &contact, NULL, &row, &error));
    assert_refused(jp_row(JP_MAP_TEXTBOOK, &contact, &no_step, &row, &error));
    assert_refused(jp_row(JP_MAP_TEXTBOOK, &contact, &no_depth, &row, &error));
    assert_refused(jp_row(JP_MAP_EXACT, &contact, &at, &row, &error));
    assert_refused(jp_row((JpMap)-1, &contact, &at, &row, &error));
    assert_refused(jp_row_of_gazebo(0.0, 0.0, 1e-3, &row, &error));
    assert_refused(jp_row_of_gazebo(1e6, 1.0, -1e-3, &row, &error));
    assert_refused(jp_spring_of(JP_MAP_TEXTBOOK, jp_row_of(0.5, 0.0), &at, &spring, &error));
    assert_refused(jp_spring_of(JP_MAP_TEXTBOOK, jp_row_of(NAN, 1.0), &at, &spring, &error));
    assert_close(row.erp, 7.0, 0.0);
}

static void an_impact_that_is_none_is_refused(void **state)
{
    (void)state;
    const JpContact contact = good();
    JpImpact impact;
    JpDelivered delivered;
    double number = 7.0;
    bool answer = false;
    assert_refused(jp_impact_of_law(&contact, 0.0, 1.0, &impact, &error));
    assert_refused(jp_impact_of_law(&contact, 1.0, NAN, &impact, &error));
    assert_refused(
        jp_impact_of_rows(JP_MAP_TEXTBOOK, &contact, 1.0, 1.0, 1e-30, &delivered, &error));
    assert_refused(
        jp_step_is_right(JP_MAP_TEXTBOOK, &contact, 1.0, 1.0, 0.0, 0.05, &answer, &error));
    assert_refused(jp_step_longest(JP_MAP_CORRECTED, &contact, 1.0, 1.0, 1e-12, &number, &error));
    assert_refused(jp_damper_of(1e6, 0.0, 1.0, &number, &error));
    assert_refused(jp_damper_of(1e6, 1.5, 1.0, &number, &error));
    assert_refused(jp_restitution_of(-1.0, 1.0, 1.0, &number, &error));
    assert_refused(jp_bounce_of_row(0.5, 1e-3, 0.0, 1e-3, &number, &error));
    assert_close(number, 7.0, 0.0);
    // a sentence that nobody wants
    assert_int_equal(jp_damper_of(1e6, 1.5, 1.0, &number, NULL), JP_ERROR_ARGUMENT);
}

// A world with a hinge and a slider to the ground, and one joint of another kind.
typedef struct Scene {
    dWorldID world;
    dJointID hinge;
    dJointID ball;
    JpWorld *play;
} Scene;

static Scene scene_make(void)
{
    Scene scene = {.world = dWorldCreate()};
    const dBodyID body = dBodyCreate(scene.world);
    scene.hinge = dJointCreateHinge(scene.world, 0);
    dJointAttach(scene.hinge, body, 0);
    scene.ball = dJointCreateBall(scene.world, 0);
    dJointAttach(scene.ball, body, 0);
    assert_int_equal(jp_world_create(scene.world, NULL, &scene.play, NULL), JP_OK);
    return scene;
}

static void scene_finish(Scene *scene)
{
    jp_world_destroy(scene->play);
    dWorldDestroy(scene->world);
}

static void a_world_that_is_none_is_refused(void **state)
{
    (void)state;
    Scene scene = scene_make();
    JpWorld *play = NULL;
    JpWorldOptions options = jp_world_options_default();
    options.stepping = (JpStepping)17;
    assert_refused(jp_world_create(NULL, NULL, &play, &error));
    assert_refused(jp_world_create(scene.world, NULL, NULL, &error));
    assert_refused(jp_world_create(scene.world, &options, &play, &error));
    options.stepping = JP_STEPPING_IMPULSE;
    options.is_quick = true;
    assert_refused(jp_world_create(scene.world, &options, &play, &error));
    assert_null(play);
    assert_refused(jp_world_step(NULL, 1e-3, &error));
    assert_refused(jp_world_step(scene.play, 0.0, &error));
    assert_refused(jp_world_step(scene.play, -1e-3, &error));
    assert_refused(jp_world_step(scene.play, NAN, &error));
    assert_refused(jp_world_step(scene.play, INFINITY, &error));
    assert_refused(jp_world_stats(scene.play, NULL, &error));
    const dWorldID other = dWorldCreate();
    const dBodyID stranger = dBodyCreate(other);
    assert_refused(jp_world_add_all(NULL, &error));
    assert_refused(jp_world_add_body(scene.play, NULL, &error));
    assert_refused(jp_world_add_body(scene.play, stranger, &error));
    assert_refused(jp_world_remove_body(scene.play, dJointGetBody(scene.hinge, 0), &error));
    dWorldDestroy(other);
    jp_world_destroy(NULL);
    scene_finish(&scene);
}

static void a_joint_that_is_none_is_refused(void **state)
{
    (void)state;
    Scene scene = scene_make();
    JpBacklash backlash = jp_backlash_default();
    backlash.tooth = good();
    JpStops stops = jp_stops_default();
    stops.contact = good();
    JpJoint *joint = NULL;
    assert_refused(jp_backlash_create(NULL, scene.hinge, &backlash, &joint, &error));
    assert_refused(jp_backlash_create(scene.play, NULL, &backlash, &joint, &error));
    assert_refused(jp_backlash_create(scene.play, scene.hinge, NULL, &joint, &error));
    assert_refused(jp_backlash_create(scene.play, scene.hinge, &backlash, NULL, &error));
    assert_refused(jp_backlash_create(scene.play, scene.ball, &backlash, &joint, &error));
    const dJointID loose = dJointCreateHinge(scene.world, 0);
    assert_refused(jp_backlash_create(scene.play, loose, &backlash, &joint, &error));
    JpBacklash wrong = backlash;
    wrong.gap = -1e-3;
    assert_refused(jp_backlash_create(scene.play, scene.hinge, &wrong, &joint, &error));
    wrong = backlash;
    wrong.rotor_inertia = NAN;
    assert_refused(jp_backlash_create(scene.play, scene.hinge, &wrong, &joint, &error));
    wrong = backlash;
    wrong.tooth.stiffness = 0.0;
    assert_refused(jp_backlash_create(scene.play, scene.hinge, &wrong, &joint, &error));
    JpStops crossed = stops;
    crossed.low = 1.0;
    crossed.high = -1.0;
    assert_refused(jp_stops_create(scene.play, scene.hinge, &crossed, &joint, &error));
    crossed.low = NAN;
    assert_refused(jp_stops_create(scene.play, scene.hinge, &crossed, &joint, &error));
    const dWorldID other = dWorldCreate();
    JpWorld *elsewhere = NULL;
    assert_int_equal(jp_world_create(other, NULL, &elsewhere, NULL), JP_OK);
    assert_refused(jp_stops_create(elsewhere, scene.hinge, &stops, &joint, &error));
    jp_world_destroy(elsewhere);
    dWorldDestroy(other);
    assert_null(joint);
    scene_finish(&scene);
}

static void a_drive_that_is_none_is_refused(void **state)
{
    (void)state;
    Scene scene = scene_make();
    JpBacklash backlash = jp_backlash_default();
    backlash.tooth = good();
    JpStops stops = jp_stops_default();
    stops.contact = good();
    JpJoint *bare = NULL;
    JpJoint *stopped = NULL;
    JpJointState now;
    assert_int_equal(jp_backlash_create(scene.play, scene.hinge, &backlash, &bare, NULL), JP_OK);
    assert_int_equal(jp_stops_create(scene.play, scene.hinge, &stops, &stopped, NULL), JP_OK);
    assert_refused(jp_backlash_drive(bare, 1.0, &error)); // has no rotor
    assert_refused(jp_backlash_drive(stopped, 1.0, &error));
    assert_refused(jp_backlash_drive(NULL, 1.0, &error));
    assert_refused(jp_backlash_lead(bare, NAN, 0.0, &error));
    assert_refused(jp_backlash_hold(bare, 0.0, 1.0, 1.0, &error));
    assert_refused(jp_backlash_hold(NULL, 0.0, 1.0, 1.0, &error));
    assert_refused(jp_backlash_hold(bare, 0.0, -1.0, 1.0, &error));
    assert_refused(jp_backlash_hold(bare, NAN, 1.0, 1.0, &error));
    assert_refused(jp_backlash_lead(stopped, 0.0, 0.0, &error));
    assert_refused(jp_joint_state(NULL, &now, &error));
    assert_refused(jp_joint_state(bare, NULL, &error));
    jp_joint_destroy(NULL);
    jp_joint_destroy(bare);
    assert_int_equal(jp_joint_state(stopped, &now, NULL), JP_OK);
    scene_finish(&scene);
}

static void a_pin_in_no_hole_is_refused(void **state)
{
    (void)state;
    Scene scene = scene_make();
    const dBodyID body = dJointGetBody(scene.hinge, 0);
    JpPinInHole pin = jp_pin_default();
    pin.hole_radius = 0.01;
    pin.pin_radius = 0.0099;
    pin.contact = good();
    JpJoint *joint = NULL;
    assert_refused(jp_pin_create(NULL, NULL, body, &pin, &joint, &error));
    assert_refused(jp_pin_create(scene.play, NULL, body, NULL, &joint, &error));
    assert_refused(jp_pin_create(scene.play, NULL, body, &pin, NULL, &error));
    assert_refused(jp_pin_create(scene.play, body, body, &pin, &joint, &error));
    assert_refused(jp_pin_create(scene.play, NULL, NULL, &pin, &joint, &error));
    const dWorldID other = dWorldCreate();
    assert_refused(jp_pin_create(scene.play, dBodyCreate(other), body, &pin, &joint, &error));
    assert_refused(jp_pin_create(scene.play, NULL, dBodyCreate(other), &pin, &joint, &error));
    dWorldDestroy(other);
    double *const numbers[] = {&pin.hole_radius, &pin.pin_radius, &pin.width,
                               &pin.axial_play,  &pin.hole[1],    &pin.pin[2],
                               &pin.axis[0],     &pin.friction,   &pin.friction_speed};
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++) {
        const double before = *numbers[i];
        *numbers[i] = NAN;
        assert_refused(jp_pin_create(scene.play, NULL, body, &pin, &joint, &error));
        *numbers[i] = i < 4 || i > 6 ? -1.0 : -INFINITY;
        assert_refused(jp_pin_create(scene.play, NULL, body, &pin, &joint, &error));
        *numbers[i] = before;
    }
    pin.pin_radius = pin.hole_radius;
    assert_refused(jp_pin_create(scene.play, NULL, body, &pin, &joint, &error));
    pin.pin_radius = 0.0099;
    pin.axis[2] = 0.0;
    assert_refused(jp_pin_create(scene.play, NULL, body, &pin, &joint, &error));
    pin.axis[2] = 1.0;
    pin.contact.stiffness = 0.0;
    assert_refused(jp_pin_create(scene.play, NULL, body, &pin, &joint, &error));
    assert_null(joint);
    scene_finish(&scene);
}

// Only the direction of an axis counts, also of one whose square no double holds.
static void an_axis_of_any_length_is_taken(void **state)
{
    (void)state;
    static const double LENGTHS[] = {1e-310, 1e-200, 2.0, 1e200, 1e308};
    Scene scene = scene_make();
    JpPinInHole pin = jp_pin_default();
    pin.hole_radius = 5e-3;
    pin.pin_radius = 4.9e-3;
    pin.contact.stiffness = 1e6;
    for (size_t i = 0; i < sizeof LENGTHS / sizeof *LENGTHS; i++) {
        JpJoint *joint = NULL;
        JpPinState now;
        pin.axis[2] = LENGTHS[i];
        const dBodyID body = dBodyCreate(scene.world);
        assert_int_equal(jp_pin_create(scene.play, NULL, body, &pin, &joint, NULL), JP_OK);
        assert_int_equal(jp_pin_state(joint, &now, NULL), JP_OK);
        assert_near(now.tilt, 0.0, 1e-15);
        jp_joint_destroy(joint);
    }
    scene_finish(&scene);
}

static void a_state_of_another_kind_of_joint_is_refused(void **state)
{
    (void)state;
    Scene scene = scene_make();
    JpPinInHole pin = jp_pin_default();
    pin.hole_radius = 0.01;
    pin.pin_radius = 0.0099;
    pin.contact = good();
    JpStops stops = jp_stops_default();
    stops.contact = good();
    JpJoint *pinned = NULL;
    JpJoint *stopped = NULL;
    JpPinState of_pin;
    JpJointState now;
    assert_int_equal(
        jp_pin_create(scene.play, NULL, dJointGetBody(scene.hinge, 0), &pin, &pinned, NULL), JP_OK);
    assert_int_equal(jp_stops_create(scene.play, scene.hinge, &stops, &stopped, NULL), JP_OK);
    assert_refused(jp_pin_state(stopped, &of_pin, &error));
    assert_refused(jp_pin_state(NULL, &of_pin, &error));
    assert_refused(jp_pin_state(pinned, NULL, &error));
    assert_refused(jp_joint_state(pinned, &now, &error));
    assert_refused(jp_backlash_drive(pinned, 1.0, &error));
    assert_refused(jp_backlash_lead(pinned, 0.0, 1.0, &error));
    assert_int_equal(jp_pin_state(pinned, &of_pin, NULL), JP_OK);
    scene_finish(&scene);
}

static void a_world_that_has_left_all_numbers_is_refused(void **state)
{
    (void)state;
    Scene scene = scene_make();
    dJointDestroy(scene.ball);
    JpStops stops = jp_stops_default();
    stops.contact = good();
    JpJoint *joint = NULL;
    assert_int_equal(jp_stops_create(scene.play, scene.hinge, &stops, &joint, NULL), JP_OK);
    dBodySetAngularVel(dJointGetBody(scene.hinge, 0), NAN, NAN, NAN);
    assert_refused(jp_world_step(scene.play, 1e-3, &error));
    scene_finish(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_contact_that_is_none_is_refused),
        cmocka_unit_test(a_pin_that_is_none_is_refused),
        cmocka_unit_test(a_row_that_is_none_is_refused),
        cmocka_unit_test(an_impact_that_is_none_is_refused),
        cmocka_unit_test(a_world_that_is_none_is_refused),
        cmocka_unit_test(a_joint_that_is_none_is_refused),
        cmocka_unit_test(a_drive_that_is_none_is_refused),
        cmocka_unit_test(a_pin_in_no_hole_is_refused),
        cmocka_unit_test(an_axis_of_any_length_is_taken),
        cmocka_unit_test(a_state_of_another_kind_of_joint_is_refused),
        cmocka_unit_test(a_world_that_has_left_all_numbers_is_refused),
    };
    return cmocka_run_group_tests(tests, ode_group_setup, ode_group_teardown);
}
