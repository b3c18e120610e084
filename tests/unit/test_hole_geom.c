// Does ODE, asked for the contacts of a hole and a cylinder, get the exact answer?
#include "close.h"

#include "ode/engine.h"
#include "ode/plane/collider.h"

#include <stdbool.h>

enum { POSE_COUNT = 100000 };

static const double HOLE_RADIUS = 5.0075e-3;
static const double PIN_RADIUS = 4.993e-3;

// A fixed stream of numbers in [0, 1): Knuth's 64-bit linear congruential generator.
static double draw(uint64_t *seed)
{
    *seed = *seed * 6364136223846793005u + 1442695040888963407u;
    return (double)(*seed >> 11) * 0x1p-53;
}

typedef struct Scene {
    dWorldID world;
    dBodyID body;
    dGeomID hole;
    dGeomID pin;
} Scene;

// The hole on the ground at a centre; the pin on a body with an offset, as in a linkage.
static Scene scene_at(double x, double y)
{
    engine_start();
    Scene scene = {.world = dWorldCreate()};
    scene.body = dBodyCreate(scene.world);
    scene.hole = hole_geom_create(HOLE_RADIUS);
    scene.pin = dCreateCylinder(0, PIN_RADIUS, 13e-3);
    dGeomSetPosition(scene.hole, x, y, 0.0);
    dGeomSetBody(scene.pin, scene.body);
    dGeomSetOffsetPosition(scene.pin, 0.0, 0.1, 0.0);
    return scene;
}

static void finish(Scene *scene)
{
    dGeomDestroy(scene->hole);
    dGeomDestroy(scene->pin);
    dWorldDestroy(scene->world);
}

// Puts the pin's centre at a place whatever the body's angle.
static void place_pin(const Scene *scene, double x, double y, double angle)
{
    const dQuaternion turn = {cos(0.5 * angle), 0.0, 0.0, sin(0.5 * angle)};
    dBodySetQuaternion(scene->body, turn);
    dBodySetPosition(scene->body, x + 0.1 * sin(angle), y - 0.1 * cos(angle), 0.0);
}

// The truth in polar coordinates: the pose is drawn as a distance and a direction, so overlap and
// normal are known before any coordinate is.
static void contacts_of_random_poses_are_exact(void **state)
{
    (void)state;
    const double x = 0.03;
    const double y = -0.02;
    Scene scene = scene_at(x, y);
    uint64_t seed = 7;
    int touching = 0;
    for (int i = 0; i < POSE_COUNT; i++) {
        const double distance = 30e-6 * draw(&seed);
        const double direction = 2.0 * M_PI * draw(&seed);
        place_pin(&scene, x + distance * cos(direction), y + distance * sin(direction),
                  6.0 * draw(&seed));
        dContactGeom contact;
        const int found = dCollide(scene.hole, scene.pin, 1, &contact, sizeof contact);
        const double overlap = distance - (HOLE_RADIUS - PIN_RADIUS);
        // rounding of coordinates of a tenth of a metre
        if (fabs(overlap) < 1e-16) {
            continue;
        }
        assert_int_equal(found, overlap > 0.0);
        if (found == 0) {
            continue;
        }
        touching++;
        assert_near(contact.depth, overlap, 1e-16);
        assert_near(contact.normal[0], cos(direction), 1e-11);
        assert_near(contact.normal[1], sin(direction), 1e-11);
        assert_near(contact.normal[2], 0.0, 0.0);
        assert_near(contact.pos[0], x + HOLE_RADIUS * cos(direction), 1e-13);
        assert_near(contact.pos[1], y + HOLE_RADIUS * sin(direction), 1e-13);
    }
    // half of the draws lie beyond 14.5 of 30 micron
    assert_true(touching > POSE_COUNT / 3 && touching < 2 * POSE_COUNT / 3);
    finish(&scene);
}

static void a_concentric_pin_touches_nothing(void **state)
{
    (void)state;
    Scene scene = scene_at(0.0, 0.0);
    place_pin(&scene, 0.0, 0.0, 0.0);
    dContactGeom contact;
    assert_int_equal(dCollide(scene.hole, scene.pin, 1, &contact, sizeof contact), 0);
    finish(&scene);
}

// ODE may ask in the other order; the contact must then name the geoms the other way round.
static void the_order_of_the_geoms_does_not_matter(void **state)
{
    (void)state;
    Scene scene = scene_at(0.0, 0.0);
    place_pin(&scene, 20e-6, 0.0, 0.0);
    dContactGeom contact;
    assert_int_equal(dCollide(scene.pin, scene.hole, 1, &contact, sizeof contact), 1);
    assert_true(contact.g1 == scene.pin);
    assert_near(contact.normal[0], -1.0, 1e-15);
    assert_near(contact.depth, 5.5e-6, 1e-16);
    finish(&scene);
}

static void a_hole_has_a_bounding_box_and_works_in_a_space(void **state)
{
    (void)state;
    Scene scene = scene_at(0.01, 0.02);
    const dSpaceID space = dSimpleSpaceCreate(0);
    dSpaceAdd(space, scene.hole);
    dReal box[6];
    dGeomGetAABB(scene.hole, box);
    assert_near(box[0], 0.01 - HOLE_RADIUS, 1e-15);
    assert_near(box[3], 0.02 + HOLE_RADIUS, 1e-15);
    dSpaceRemove(space, scene.hole);
    dSpaceDestroy(space);
    finish(&scene);
}

static void other_shapes_do_not_collide_with_a_hole(void **state)
{
    (void)state;
    Scene scene = scene_at(0.0, 0.0);
    const dGeomID ball = dCreateSphere(0, 1.0);
    dContactGeom contact;
    assert_int_equal(dCollide(scene.hole, ball, 1, &contact, sizeof contact), 0);
    dGeomDestroy(ball);
    finish(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(contacts_of_random_poses_are_exact),
        cmocka_unit_test(a_concentric_pin_touches_nothing),
        cmocka_unit_test(the_order_of_the_geoms_does_not_matter),
        cmocka_unit_test(a_hole_has_a_bounding_box_and_works_in_a_space),
        cmocka_unit_test(other_shapes_do_not_collide_with_a_hole),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
