#include "pressed_base.h"

#include <math.h>
#include <ode/ode.h>
#include <string.h>

static const double CENTRE[3] = {0.05, 0.02, 0.15}; // m, of the bearing, in the box
static const double AXIS[3] = {0.87758, 0.47943, 0};
static const double HEIGHT = 0.1; // m, of the box

typedef struct Scene {
    dWorldID world;
    dGeomID floor;
    dGeomID box;
    dBodyID bodies[2];
    dJointGroupID contacts;
    JpWorld *play;
    JpJoint *pin;
    size_t touched; // contacts so far
} Scene;

static void touch(dWorldID world, void *data)
{
    Scene *scene = data;
    dContact contacts[8];
    memset(contacts, 0, sizeof contacts);
    dJointGroupEmpty(scene->contacts);
    const int count =
        dCollide(scene->box, scene->floor, 8, &contacts[0].geom, (int)sizeof *contacts);
    for (int i = 0; i < count; i++) {
        contacts[i].surface.mode = dContactApprox1;
        contacts[i].surface.mu = 0.3;
        dJointAttach(dJointCreateContact(world, scene->contacts, &contacts[i]), scene->bodies[0],
                     0);
    }
    scene->touched += (size_t)count;
}

static void make_bodies(Scene *scene, double layer)
{
    dMass mass;
    dMassSetBoxTotal(&mass, 1.0, 0.6, 0.4, HEIGHT);
    scene->bodies[0] = dBodyCreate(scene->world);
    dBodySetMass(scene->bodies[0], &mass);
    dBodySetPosition(scene->bodies[0], 0, 0, 0.5 * (HEIGHT - layer));
    dGeomSetBody(scene->box, scene->bodies[0]);
    dMassSetBoxTotal(&mass, 0.2, 0.02, 0.02, 0.3);
    scene->bodies[1] = dBodyCreate(scene->world);
    dBodySetMass(scene->bodies[1], &mass);
    dMatrix3 turn;
    dRFromAxisAndAngle(turn, AXIS[0], AXIS[1], AXIS[2], 0.6);
    dBodySetRotation(scene->bodies[1], turn);
    // the pin is .1 m above the rod's centre
    dBodySetPosition(scene->bodies[1], CENTRE[0] - 0.1 * turn[2], CENTRE[1] - 0.1 * turn[6],
                     CENTRE[2] + 0.5 * (HEIGHT - layer) - 0.1 * turn[10]);
    for (int i = 0; i < 2; i++) {
        dBodySetLinearVel(scene->bodies[i], 0.3, 0.15, 0);
    }
}

static JpPinInHole bearing(void)
{
    JpPinInHole pin = jp_pin_default();
    pin.hole_radius = 5e-3;
    pin.pin_radius = 4.95e-3;
    pin.width = 0.04;
    pin.axial_play = 0.1e-3;
    memcpy(pin.hole, CENTRE, sizeof pin.hole);
    pin.pin[2] = 0.1;
    memcpy(pin.axis, AXIS, sizeof pin.axis);
    pin.contact.stiffness = 1e6;
    pin.contact.restitution = 0.6;
    return pin;
}

static bool make(Scene *scene, JpStepping stepping, double layer, JpError *error)
{
    *scene = (Scene){.world = dWorldCreate(), .contacts = dJointGroupCreate(0)};
    scene->floor = dCreatePlane(0, 0, 0, 1, 0);
    scene->box = dCreateBox(0, 0.6, 0.4, HEIGHT);
    dWorldSetGravity(scene->world, 0, 0, -9.81);
    dWorldSetERP(scene->world, 1.0);
    dWorldSetContactSurfaceLayer(scene->world, layer);
    make_bodies(scene, layer);
    JpWorldOptions options = jp_world_options_default();
    options.stepping = stepping;
    options.collide = touch;
    options.collide_data = scene;
    const JpPinInHole pin = bearing();
    return jp_world_create(scene->world, &options, &scene->play, error) == JP_OK &&
           jp_pin_create(scene->play, scene->bodies[0], scene->bodies[1], &pin, &scene->pin,
                         error) == JP_OK;
}

bool pressed_base_run(JpStepping stepping, double layer, double step, double duration,
                      PressedBase *end, JpError *error)
{
    Scene scene;
    bool is_done = make(&scene, stepping, layer, error);
    const long count = lround(duration / step);
    for (long i = 0; i < count && is_done; i++) {
        is_done = jp_world_step(scene.play, step, error) <= JP_OK; // coarse ones are counted
    }
    if (is_done) {
        for (int i = 0; i < 2; i++) {
            memcpy(end->position[i], dBodyGetPosition(scene.bodies[i]), sizeof end->position[i]);
            // so that layers can be compared
            end->position[i][2] += 0.5 * layer;
        }
        end->contacts = (double)scene.touched / (double)count;
        jp_world_stats(scene.play, &end->stats, NULL);
    }
    jp_world_destroy(scene.play);
    dJointGroupDestroy(scene.contacts);
    dGeomDestroy(scene.box);
    dGeomDestroy(scene.floor);
    dWorldDestroy(scene.world);
    return is_done;
}

double pressed_base_apart(const PressedBase *one, const PressedBase *other)
{
    double apart = 0.0;
    for (int i = 0; i < 2; i++) {
        for (int k = 0; k < 3; k++) {
            apart = fmax(apart, fabs(one->position[i][k] - other->position[i][k]));
        }
    }
    return apart;
}
