// What does one contact query cost: the pure geometry, the collider, the collider through ODE?
//
// Medians over repetitions of a million queries of a pin that moves about its hole; the last column
// is each against the geometry, from the same run.
#include "base/clock.h"
#include "base/sorted.h"
#include "kernel/pin_hole.h"
#include "ode/engine.h"
#include "ode/plane/collider.h"

#include <stdio.h>

enum { QUERIES = 1000000, REPETITIONS = 9, POSES = 1024, ROWS = 3 };

static const double CLEARANCE = 14.5e-6;

typedef struct Scene {
    Vec2 poses[POSES];
    dBodyID body;
    dGeomID hole;
    dGeomID pin;
} Scene;

static double time_geometry(const Scene *scene, double *sum)
{
    const double start = clock_now_s();
    for (int i = 0; i < QUERIES; i++) {
        const Vec2 still = {0.0, 0.0};
        *sum += pin_hole_pose(still, scene->poses[i % POSES], still, CLEARANCE).gap;
    }
    return clock_now_s() - start;
}

static double time_collider(const Scene *scene, double *sum)
{
    dContactGeom contact;
    const double start = clock_now_s();
    for (int i = 0; i < QUERIES; i++) {
        *sum += hole_geom_collide(scene->hole, scene->pin, 1, &contact, sizeof contact);
    }
    return clock_now_s() - start;
}

// With the body moved before each query, so that ODE recomputes the geom's pose.
static double time_engine(const Scene *scene, double *sum)
{
    dContactGeom contact;
    const double start = clock_now_s();
    for (int i = 0; i < QUERIES; i++) {
        const Vec2 pose = scene->poses[i % POSES];
        dBodySetPosition(scene->body, pose.x, pose.y, 0.0);
        *sum += dCollide(scene->hole, scene->pin, 1, &contact, sizeof contact);
    }
    return clock_now_s() - start;
}

static Scene make_scene(dWorldID world)
{
    Scene scene = {.body = dBodyCreate(world)};
    for (int i = 0; i < POSES; i++) {
        const double angle = 2.0 * M_PI * i / POSES;
        const double size = CLEARANCE * (0.8 + 0.4 * (i % 7) / 7.0);
        scene.poses[i] = (Vec2){size * cos(angle), size * sin(angle)};
    }
    scene.hole = hole_geom_create(5.0075e-3);
    scene.pin = dCreateCylinder(0, 4.993e-3, 13e-3);
    dGeomSetBody(scene.pin, scene.body);
    dGeomSetOffsetPosition(scene.pin, 0.0, 0.0, 0.0);
    dBodySetPosition(scene.body, scene.poses[3].x, scene.poses[3].y, 0.0);
    return scene;
}

int main(void)
{
    engine_start();
    const dWorldID world = dWorldCreate();
    const Scene scene = make_scene(world);
    double (*const timers[ROWS])(const Scene *, double *) = {time_geometry, time_collider,
                                                             time_engine};
    const char *const names[ROWS] = {"geometry alone", "collider", "body moved, dCollide"};
    double times[ROWS][REPETITIONS];
    double sum = 0.0;
    // interleaved, so that a drift of the machine meets all three alike
    for (int repetition = 0; repetition < REPETITIONS; repetition++) {
        for (int row = 0; row < ROWS; row++) {
            times[row][repetition] = timers[row](&scene, &sum);
        }
    }
    printf("%-24s %12s %10s\n", "", "ns/query", "ratio");
    double first = 0.0;
    for (int row = 0; row < ROWS; row++) {
        sorted_make(times[row], REPETITIONS);
        const double median = sorted_median(times[row], REPETITIONS);
        first = row == 0 ? median : first;
        printf("%-24s %12.1f %10.1f\n", names[row], 1e9 * median / QUERIES, median / first);
    }
    printf("(checksum %g)\n", sum);
    dWorldDestroy(world);
    return 0;
}
