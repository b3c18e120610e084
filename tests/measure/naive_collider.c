// What does libccd find if it is asked in the obvious way?
#include "naive_collider.h"

#include "ode/plane/collider.h"

#include <assert.h>
#include <ccd/ccd.h>
#include <ccd/vec3.h>
#include <math.h>
#include <stdlib.h>

// Half the thickness of a stave, of the hole's radius.
static const double HALF_THICKNESS = 0.5;

typedef struct Stave {
    double inner; // m, from its centre to its inner and outer face
    double reach; // m, from the hole's centre to its own
    double widening;
    double half_height;
} Stave;

typedef struct Naive {
    PolygonHole polygon;
} Naive;

static void stave_support(const void *object, const ccd_vec3_t *direction, ccd_vec3_t *point)
{
    const Stave *stave = object;
    double most = -INFINITY;
    for (int i = 0; i < 4; i++) {
        const double x = (i & 1) != 0 ? stave->inner : -stave->inner;
        const double y = (stave->reach + x) * stave->widening * ((i & 2) != 0 ? 1.0 : -1.0);
        const double along = x * ccdVec3X(direction) + y * ccdVec3Y(direction);
        if (along > most) {
            most = along;
            ccdVec3Set(point, x, y, copysign(stave->half_height, ccdVec3Z(direction)));
        }
    }
}

static void stave_centre(const void *object, ccd_vec3_t *centre)
{
    (void)object;
    ccdVec3Set(centre, 0.0, 0.0, 0.0);
}

typedef struct Pin {
    Vec2 centre; // m
    double radius;
    double half_length;
} Pin;

static void pin_support(const void *object, const ccd_vec3_t *direction, ccd_vec3_t *point)
{
    const Pin *pin = object;
    const double across = hypot(ccdVec3X(direction), ccdVec3Y(direction));
    const double share = across > 0.0 ? pin->radius / across : 0.0;
    ccdVec3Set(point, pin->centre.x + share * ccdVec3X(direction),
               pin->centre.y + share * ccdVec3Y(direction),
               copysign(pin->half_length, ccdVec3Z(direction)));
}

static void pin_centre(const void *object, ccd_vec3_t *centre)
{
    const Pin *pin = object;
    ccdVec3Set(centre, pin->centre.x, pin->centre.y, 0.0);
}

static void *naive_open(const Scenario *scenario, int joint)
{
    Naive *naive = calloc(1, sizeof *naive);
    assert(naive != NULL);
    naive->polygon = polygon_hole_of_joint(scenario, joint);
    return naive;
}

typedef int Query(const void *stave, const void *pin, const ccd_t *ccd, ccd_real_t *depth,
                  ccd_vec3_t *direction, ccd_vec3_t *position);

static bool find(const Naive *naive, dGeomID hole, dGeomID pin, Query *query, Collision *collision)
{
    const PolygonHole *polygon = &naive->polygon;
    PolygonSide side;
    if (!polygon_hole_side(polygon, hole, pin, &side)) {
        return false;
    }
    const double half = HALF_THICKNESS * polygon->hole_radius;
    const Stave stave = {
        .inner = half,
        .reach = polygon->facets.inradius + half,
        .widening = tan(0.5 * polygon->facets.pitch),
        .half_height = polygon->half_height,
    };
    const Pin body = {
        {side.pin.x - stave.reach, side.pin.y}, polygon->pin_radius, 0.9 * polygon->half_height};
    ccd_t ccd;
    CCD_INIT(&ccd);
    ccd.support1 = stave_support;
    ccd.support2 = pin_support;
    ccd.center1 = stave_centre;
    ccd.center2 = pin_centre;
    ccd.max_iterations = 200;
    ccd_real_t depth;
    ccd_vec3_t direction;
    ccd_vec3_t position;
    if (query(&stave, &body, &ccd, &depth, &direction, &position) != 0) {
        return false;
    }
    *collision = polygon_hole_collision(polygon, &side, depth,
                                        (Vec2){ccdVec3X(&direction), ccdVec3Y(&direction)});
    return true;
}

static bool naive_find_mpr(void *state, dGeomID hole, dGeomID pin, Collision *collision)
{
    return find(state, hole, pin, ccdMPRPenetration, collision);
}

static bool naive_find_gjk(void *state, dGeomID hole, dGeomID pin, Collision *collision)
{
    return find(state, hole, pin, ccdGJKPenetration, collision);
}

static void naive_close(void *state)
{
    free(state);
}

const Collider NAIVE_MPR = {.open = naive_open, .find = naive_find_mpr, .close = naive_close};
const Collider NAIVE_GJK = {.open = naive_open, .find = naive_find_gjk, .close = naive_close};
