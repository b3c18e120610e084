// What does a step of the library cost in a world of many bodies of which few meet a pin?
//
// 250 chains of two bodies that swing on hinges; in two of them the upper hinge is a pin in its
// hole that knocks. A step of ODE, of the same world with hinges instead, and of the library with
// each stepping: the smallest of interleaved repetitions, and its ratio to that of ODE.
#include "base/clock.h"

#include <jointplay/jointplay.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { CHAINS = 250, LINKS = 2, PINS = 2, STEPS = 400, REPETITIONS = 7, ROWS = 4 };

static const double STEP = 1e-3; // s

static const char *const NAMES[ROWS] = {"dWorldStep, hinges only", "plain", "staggered", "impulse"};

typedef struct Scene {
    dWorldID world;
    JpWorld *play; // NULL: ODE's own step
    double us;     // of a step, smallest
} Scene;

static void stop_if_wrong(JpStatus status, const JpError *error)
{
    if (status > JP_OK) { // a coarse step takes its time as any other
        fprintf(stderr, "%s\n", error->text);
        exit(1);
    }
}

static void add_pin(JpWorld *play, dBodyID body, double z)
{
    JpError error;
    JpJoint *joint;
    JpPinInHole pin = jp_pin_default();
    pin.hole_radius = 5e-3;
    pin.pin_radius = 4.95e-3;
    pin.hole[2] = z;
    pin.pin[0] = -0.15;
    pin.contact.stiffness = 1e8;
    pin.contact.exponent = 1.5;
    stop_if_wrong(jp_pin_create(play, NULL, body, &pin, &joint, &error), &error);
}

// A chain; its first link on a pin of the library, or on a hinge.
static void add_chain(Scene *scene, int number, bool is_pinned)
{
    const double z = 0.1 * number;
    dBodyID before = NULL;
    dMass mass;
    dMassSetBoxTotal(&mass, 0.5, 0.3, 0.02, 0.02);
    for (int i = 0; i < LINKS; i++) {
        const dBodyID body = dBodyCreate(scene->world);
        dBodySetMass(body, &mass);
        dBodySetPosition(body, 0.15 + 0.3 * i, 0, z);
        if (i == 0 && is_pinned) {
            add_pin(scene->play, body, z);
        } else {
            const dJointID hinge = dJointCreateHinge(scene->world, 0);
            dJointAttach(hinge, body, before);
            dJointSetHingeAnchor(hinge, 0.3 * i, 0, z);
            dJointSetHingeAxis(hinge, 0, 0, 1);
        }
        before = body;
    }
}

static Scene make_scene(int row)
{
    Scene scene = {.world = dWorldCreate(), .us = INFINITY};
    JpError error;
    dWorldSetGravity(scene.world, 0, -9.81, 0);
    if (row > 0) {
        JpWorldOptions options = jp_world_options_default();
        options.stepping = (JpStepping)(row - 1);
        stop_if_wrong(jp_world_create(scene.world, &options, &scene.play, &error), &error);
    }
    for (int i = 0; i < CHAINS; i++) {
        add_chain(&scene, i, row > 0 && i < PINS);
    }
    if (row > 0) {
        stop_if_wrong(jp_world_add_all(scene.play, &error), &error);
    }
    return scene;
}

static void run(Scene *scene)
{
    JpError error;
    const double start = clock_now_s();
    for (int i = 0; i < STEPS; i++) {
        if (scene->play != NULL) {
            stop_if_wrong(jp_world_step(scene->play, STEP, &error), &error);
        } else {
            dWorldStep(scene->world, STEP);
        }
    }
    scene->us = fmin(scene->us, 1e6 * (clock_now_s() - start) / STEPS);
}

int main(void)
{
    Scene scenes[ROWS];
    dInitODE2(0);
    for (int row = 0; row < ROWS; row++) {
        scenes[row] = make_scene(row);
    }
    for (int repetition = 0; repetition < REPETITIONS; repetition++) {
        for (int row = 0; row < ROWS; row++) {
            run(&scenes[row]);
        }
    }
    printf("%d bodies, %d pins\n%-26s %12s %10s %12s %12s\n", CHAINS * LINKS, PINS, "", "us/step",
           "ratio", "world steps", "rows a step");
    for (int row = 0; row < ROWS; row++) {
        JpWorldStats stats = {.steps = 1, .world_steps = 1};
        if (scenes[row].play != NULL) {
            jp_world_stats(scenes[row].play, &stats, NULL);
        }
        printf("%-26s %12.1f %10.2f %12.2f %12.2f\n", NAMES[row], scenes[row].us,
               scenes[row].us / scenes[0].us, (double)stats.world_steps / (double)stats.steps,
               (double)stats.rows / (double)stats.steps);
        jp_world_destroy(scenes[row].play);
        dWorldDestroy(scenes[row].world);
    }
    dCloseODE();
    return 0;
}
