#include "collider_poses.h"

#include "base/clock.h"
#include "base/sorted.h"
#include "contact/facets.h"
#include "ode/engine.h"
#include "ode/plane/collider.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>

enum { BATCH = 100, BATCH_MOST = 20 };

static const double LEAST_DEPTH = 1e-10; // m
static const double WORLD = 0.3;         // m

// A fixed stream of numbers in [0, 1): Knuth's 64-bit linear congruential generator.
static double draw_share(uint64_t *seed)
{
    *seed = *seed * 6364136223846793005u + 1442695040888963407u;
    return (double)(*seed >> 11) * 0x1p-53;
}

typedef struct Corner {
    long double x;
    long double y;
} Corner;

// The overlap of a disc about (x, y) with the side from one corner to the next, the hole to its
// left: by the distance of its centre from the line.
static long double side_depth(Corner from, Corner to, long double x, long double y,
                              long double radius)
{
    const long double along_x = to.x - from.x;
    const long double along_y = to.y - from.y;
    const long double area = along_x * (y - from.y) - along_y * (x - from.x);
    return radius - area / sqrtl(along_x * along_x + along_y * along_y);
}

static long double polygon_depth(const Corner *corners, size_t count, long double x, long double y,
                                 long double radius)
{
    long double most = -INFINITY;
    for (size_t i = 0; i < count; i++) {
        const long double depth = side_depth(corners[i], corners[(i + 1) % count], x, y, radius);
        most = depth > most ? depth : most;
    }
    return most;
}

Poses collider_poses_make(const Scenario *scenario, int joint, size_t count, uint64_t seed)
{
    const Clearance *clearance = &scenario->linkage.joints[joint].clearance;
    const double play = clearance->hole_radius - clearance->pin_radius;
    const size_t sides = facets_of_joint(scenario, joint).count;
    Poses poses = {scenario, joint, count, calloc(count, sizeof *poses.poses)};
    Corner *corners = calloc(sides, sizeof *corners);
    assert(poses.poses != NULL && corners != NULL);
    const long double pitch = 2.0L * acosl(-1.0L) / (long double)sides;
    // corners on the circle, or so far out that the middles of the sides are on it
    const long double out = scenario->ode.polygon == ODE_INSCRIBED ? 1.0L : cosl(0.5L * pitch);
    for (size_t i = 0; i < sides; i++) {
        const long double angle = ((long double)i + 0.5L) * pitch;
        corners[i].x = clearance->hole_radius / out * cosl(angle);
        corners[i].y = clearance->hole_radius / out * sinl(angle);
    }
    for (size_t i = 0; i < count; i++) {
        Pose *pose = &poses.poses[i];
        const double depth = LEAST_DEPTH * pow(play / LEAST_DEPTH, draw_share(&seed));
        const double distance = play + (i % 2 == 0 ? depth : -depth);
        const double direction = 2.0 * M_PI * draw_share(&seed);
        const long double x = (long double)distance * cosl(direction);
        const long double y = (long double)distance * sinl(direction);
        pose->hole = (Vec2){WORLD * (2.0 * draw_share(&seed) - 1.0),
                            WORLD * (2.0 * draw_share(&seed) - 1.0)};
        pose->turn = 2.0 * M_PI * draw_share(&seed);
        pose->outward = (Vec2){cos(direction + pose->turn), sin(direction + pose->turn)};
        pose->pin = vec2_add(pose->hole, vec2_scale(distance, pose->outward));
        pose->circle_depth = distance - play;
        pose->polygon_depth = (double)polygon_depth(corners, sides, x, y, clearance->pin_radius);
    }
    free(corners);
    return poses;
}

void collider_poses_finish(Poses *poses)
{
    free(poses->poses);
    *poses = (Poses){.count = 0};
}

// Errors of all contacts that were found, one array each.
typedef struct Errors {
    double *polygon;
    double *circle;
    double *normal;
} Errors;

static void judge(const Pose *pose, bool is_found, const Collision *collision, double limit,
                  const Errors *errors, PoseFigures *figures)
{
    const double decade = floor(log10(pose->circle_depth / LEAST_DEPTH));
    if (pose->circle_depth > 0.0 && decade >= 0.0 && decade < POSE_DECADES) {
        PoseDecade *of = &figures->decades[(int)decade];
        const double error = fabs(collision->depth - pose->polygon_depth);
        of->asked++;
        of->found += is_found ? 1 : 0;
        of->error += is_found ? error / fabs(pose->polygon_depth) : 0.0;
    }
    if (!is_found) {
        figures->missed += pose->polygon_depth > limit ? 1 : 0;
        figures->missed_depth = fmax(figures->missed_depth, pose->polygon_depth);
        return;
    }
    figures->invented += pose->polygon_depth < -limit ? 1 : 0;
    figures->outward += !(vec2_dot(collision->normal, pose->outward) < 0.0) ? 1 : 0;
    const Vec2 inward = vec2_scale(-1.0, pose->outward);
    errors->polygon[figures->contacts] = fabs(collision->depth - pose->polygon_depth);
    errors->circle[figures->contacts] = fabs(collision->depth - pose->circle_depth);
    errors->normal[figures->contacts] =
        fabs(atan2(vec2_cross(inward, collision->normal), vec2_dot(inward, collision->normal)));
    figures->contacts++;
}

static void place(const Pose *pose, dGeomID hole, dGeomID pin)
{
    const dQuaternion turn = {cos(0.5 * pose->turn), 0.0, 0.0, sin(0.5 * pose->turn)};
    dGeomSetPosition(hole, pose->hole.x, pose->hole.y, 0.0);
    dGeomSetQuaternion(hole, turn);
    dGeomSetPosition(pin, pose->pin.x, pose->pin.y, 0.0);
}

static void conclude(const Errors *errors, PoseFigures *figures)
{
    const size_t count = figures->contacts;
    for (size_t i = 0; i < POSE_DECADES; i++) {
        figures->decades[i].error /= (double)figures->decades[i].found;
    }
    if (count > 0) {
        sorted_make(errors->polygon, count);
        sorted_make(errors->circle, count);
        sorted_make(errors->normal, count);
        figures->polygon_median = sorted_median(errors->polygon, count);
        figures->polygon_max = errors->polygon[count - 1];
        figures->circle_median = sorted_median(errors->circle, count);
        figures->circle_max = errors->circle[count - 1];
        figures->normal_median = sorted_median(errors->normal, count);
        figures->normal_max = errors->normal[count - 1];
    }
}

// The time of a query: poses asked again by the batch, less what it takes to place the geoms.
static double time_query(const Poses *poses, const Collider *collider, void *own, dGeomID hole,
                         dGeomID pin)
{
    double times[BATCH_MOST];
    size_t batches = 0;
    for (; batches < BATCH_MOST && (batches + 1) * BATCH <= poses->count; batches++) {
        const Pose *first = &poses->poses[batches * BATCH];
        Collision collision;
        const double start_s = clock_processor_s();
        for (size_t i = 0; i < BATCH; i++) {
            place(&first[i], hole, pin);
            collider->find(own, hole, pin, &collision);
        }
        const double asked_s = clock_processor_s();
        for (size_t i = 0; i < BATCH; i++) {
            place(&first[i], hole, pin);
        }
        times[batches] = (asked_s - start_s) - (clock_processor_s() - asked_s);
    }
    if (batches == 0) {
        return NAN;
    }
    sorted_make(times, batches);
    return sorted_median(times, batches) / BATCH;
}

PoseFigures collider_poses_ask(const Poses *poses, const Collider *collider, double limit)
{
    const Clearance *clearance = &poses->scenario->linkage.joints[poses->joint].clearance;
    engine_start();
    const dGeomID hole = hole_geom_create(clearance->hole_radius);
    const dGeomID pin = dCreateCylinder(0, clearance->pin_radius, hole_geom_width(clearance));
    void *own = collider->open(poses->scenario, poses->joint);
    double *room = calloc(3 * poses->count, sizeof *room);
    assert(room != NULL);
    const Errors errors = {room, room + poses->count, room + 2 * poses->count};
    PoseFigures figures = {0};
    for (size_t i = 0; i < poses->count; i++) {
        place(&poses->poses[i], hole, pin);
        Collision collision = {0};
        const bool is_found = collider->find(own, hole, pin, &collision);
        judge(&poses->poses[i], is_found, &collision, limit, &errors, &figures);
    }
    conclude(&errors, &figures);
    figures.query_s = time_query(poses, collider, own, hole, pin);
    free(room);
    collider->close(own);
    dGeomDestroy(hole);
    dGeomDestroy(pin);
    return figures;
}
